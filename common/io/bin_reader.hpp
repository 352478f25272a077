// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "common/core/cloud.hpp"
#include "common/io/read_error.hpp"

namespace clearway::io {

/// What cannot be told from a .bin file itself.
struct BinLayout {
  int floats_per_point = 4;      ///< 3: x y z; 4: x y z intensity.
  double intensity_scale = 1.0;  ///< The file's intensity times this is 0..255.
};

/// Reads bare little-endian 32-bit floats, point after point [m]. Points with NaN are points.
/// Intensity: times the scale, rounded, clamped into 0..255; 0 when there are 3 floats.
/// Throws ReadError when the file cannot be read, is empty, or does not hold whole points, and
/// std::invalid_argument when floats_per_point is neither 3 nor 4.
[[nodiscard]] core::PointCloud ReadBin(const std::filesystem::path& path, const BinLayout& layout);

/// The same from memory; `file` is the name for messages.
[[nodiscard]] core::PointCloud ParseBin(std::string_view bytes,
                                        const std::string& file,
                                        const BinLayout& layout);

}  // namespace clearway::io
