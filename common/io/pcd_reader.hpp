// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>

#include "common/core/cloud.hpp"
#include "common/io/pcd_header.hpp"
#include "common/io/read_error.hpp"

namespace clearway::io {

/// A cloud as a PCD file holds it.
struct PcdFile {
  core::PointCloud cloud;    ///< In the file's own frame; `viewpoint` is not applied to it.
  PcdViewpoint viewpoint;    ///< Where the sensor was in that frame.
  std::uint64_t width = 0;   ///< Points in a row of an organised cloud, else all of them.
  std::uint64_t height = 1;  ///< Rows of an organised cloud, else 1.
};

/// Reads a PCD file: versions .5 to .7; ascii, binary and binary_compressed; fields of any SIZE,
/// TYPE and COUNT, with padding (`_`), as long as x, y and z are among them. Points with NaN are
/// points. A coordinate beyond a float's range becomes infinite. The intensity is that of the
/// field `intensity`, else of `reflectivity`, times intensity_scale, rounded and clamped into
/// 0..255 (recordings whose values are 0..1 need a scale of 255). A time for each point is not
/// read. A file is read as a whole or refused, never in part; POINTS 0 gives an empty cloud.
/// Memory is bounded by a multiple of the file's size. Throws ReadError.
[[nodiscard]] PcdFile ReadPcd(const std::filesystem::path& path, double intensity_scale = 1.0);

/// The same from memory; `file` is the name for messages.
[[nodiscard]] PcdFile ParsePcd(std::string_view bytes,
                               const std::string& file,
                               double intensity_scale = 1.0);

}  // namespace clearway::io
