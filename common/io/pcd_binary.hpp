// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "common/core/cloud.hpp"
#include "common/io/pcd_ascii.hpp"

namespace clearway::io {

/// Reads a binary body, point after point. It must hold exactly POINTS points; after them only
/// padding may stand: zero bytes, and at most one line end at the very end (writers that map files
/// into memory leave up to a page of it). Where WIDTH * HEIGHT is more than POINTS and the body
/// could hold that many, it is ambiguous and refused. Throws ReadError with the byte.
[[nodiscard]] core::PointCloud ReadPcdBinary(const PcdBody& body);

/// Reads a compressed body: two little-endian 32-bit sizes (packed, unpacked) and LZF data, which
/// hold the fields one after the other, each for all points. The unpacked size must be exactly
/// that of POINTS points; padding as in ReadPcdBinary(). Data that do not unpack and whose two
/// sizes are equal are taken as stored unpacked, as pypcd does when packing does not pay.
[[nodiscard]] core::PointCloud ReadPcdCompressed(const PcdBody& body);

}  // namespace clearway::io
