// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace clearway::test {

/// A PNG image to be written. `samples` are as they stand in the file: channel by channel, pixel by
/// pixel, line by line, each 0..2^bit_depth - 1.
struct PngContent {
  std::uint32_t width = 0;
  std::uint32_t height = 0;
  int bit_depth = 8;
  int color_type = 0;  ///< 0 gray, 2 colour, 3 palette, 4 gray + alpha, 6 colour + alpha.
  bool is_interlaced = false;
  std::vector<std::uint16_t> samples = {};
  std::vector<std::array<std::uint8_t, 3>> palette = {};
  std::vector<std::uint8_t> palette_opacity = {};                       ///< tRNS of a palette.
  std::optional<std::array<std::uint16_t, 3>> transparent_colour = {};  ///< tRNS; gray: the first.
};

/// Samples per pixel.
[[nodiscard]] int ChannelsOf(int color_type);

/// The file, written by libpng. Throws std::runtime_error when libpng refuses.
[[nodiscard]] std::string MakePng(const PngContent& content);

}  // namespace clearway::test
