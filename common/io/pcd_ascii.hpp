// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <string_view>

#include "common/core/cloud.hpp"
#include "common/io/pcd_fields.hpp"
#include "common/io/pcd_header.hpp"

namespace clearway::io {

/// What a PCD body is read by.
struct PcdBody {
  std::string_view bytes;  ///< Of the whole file; messages count from its start.
  const std::string& file;
  const PcdHeader& header;
  const PcdSelection& selection;
  double intensity_scale;
};

/// Reads the rows of an ascii file. There must be exactly POINTS of them, with one value for each
/// column; empty lines and comments (#) between them are skipped, and zero bytes after the last.
/// A row that is glued to the DATA line is the first point when POINTS needs it, and else ignored,
/// as PCL does with all that stands there. Only the selected columns must be numbers. Throws
/// ReadError with the line. A file that was cut inside its very last number cannot be told from a
/// whole one.
[[nodiscard]] core::PointCloud ReadPcdAscii(const PcdBody& body);

}  // namespace clearway::io
