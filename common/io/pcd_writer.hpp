// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>

#include "common/core/cloud.hpp"

namespace clearway::io {

/// Writes a PCD file, version .7, binary, fields x y z (float) and intensity (one byte). ReadPcd()
/// gives back exactly these, bit by bit; tags and times are not written. Throws std::runtime_error
/// with the file and the system's reason; the file may then be there in part.
void WritePcdBinary(const std::filesystem::path& path, const core::PointCloud& cloud);

}  // namespace clearway::io
