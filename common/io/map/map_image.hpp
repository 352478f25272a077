// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "common/io/read_error.hpp"

namespace clearway::io {

/// The image of a map, as bright and as opaque as its pixels are: all that the rules of Nav2's maps
/// ask for. Lines run from the top, as in the file; a line's pixels from the left.
struct MapImage {
  static constexpr std::uint16_t kOpaque = 65535;

  int width = 0;   ///< Pixels.
  int height = 0;  ///< Lines.

  /// The brightness of white, 1..65535: a gray image's own largest value, 765 for colours of 8 bits
  /// (brightness is then the sum of red, green and blue), 65535 for deeper ones.
  std::uint16_t full_scale = 255;

  /// The mean of red, green and blue in units of 1 / full_scale. Exact, but for colours of 16 bits,
  /// whose mean is rounded.
  std::vector<std::uint16_t> brightness;

  /// 0 transparent .. kOpaque, exact for 8 and 16 bits. Empty when the file has no such channel:
  /// for Nav2 that is something else than a channel that says opaque everywhere.
  std::vector<std::uint16_t> opacity;

  [[nodiscard]] std::size_t num_pixels() const { return brightness.size(); }
};

/// Reads a PGM image, plain (P2) or raw (P5), with maxval 1..65535 and comments anywhere before the
/// pixels (and between those of P2). What follows the pixels may only be white space, and for P2
/// comments: netpbm allows further images there, which no writer of maps makes, so that anything
/// else is a damaged file. At most core::GridGeometry::kMaxCells pixels, and nothing is allocated
/// that the file's size does not warrant. `name` is the file for messages.
/// Throws ReadError with the line or byte, the value and what is allowed.
[[nodiscard]] MapImage ParsePgm(std::string_view bytes, const std::string& name);

/// Reads a PNG image of any kind: gray, palette or colour, 1 to 16 bits, with or without
/// transparency (an alpha channel or a tRNS chunk), interlaced or not. Gamma and colour profiles
/// are ignored, as in Nav2. Damage in any chunk is refused; what follows the last chunk is ignored.
/// Limits and errors as for ParsePgm().
[[nodiscard]] MapImage ParsePng(std::string_view bytes, const std::string& name);

/// The reader that fits the first bytes; the name's ending does not matter. Throws ReadError that
/// says what the file is and what is allowed when it is neither PGM nor PNG.
[[nodiscard]] MapImage ParseMapImage(std::string_view bytes, const std::string& name);

}  // namespace clearway::io
