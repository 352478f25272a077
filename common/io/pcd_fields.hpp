// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>

#include "common/io/pcd_header.hpp"

namespace clearway::io {

/// Which fields of a PCD file become what of a core::PointCloud, as indices into its fields.
struct PcdSelection {
  std::array<std::size_t, 3> xyz = {0, 0, 0};
  std::optional<std::size_t> intensity;  ///< `intensity`, else `reflectivity`, else nothing.
};

/// x, y and z must be there once each, with one value, as floats of 4 or 8 bytes or as integers;
/// the intensity likewise, save that of several values the first is taken. All other fields may be
/// anything. Throws ReadError that names what the file has instead.
[[nodiscard]] PcdSelection SelectPcdFields(const PcdHeader& header, const std::string& file);

/// The value of a selected field, whatever its type; `bytes` is where it lies.
/// @pre field.size bytes can be read; the field passed SelectPcdFields().
[[nodiscard]] double LoadPcdValue(const PcdField& field, const char* bytes);

/// As a float; infinite with its sign when a float cannot hold it. NaN stays NaN.
[[nodiscard]] float ToCoordinate(double value);

/// round(value * scale), clamped into 0..255; 0 for NaN.
[[nodiscard]] std::uint8_t ToIntensity(double value, double scale);

}  // namespace clearway::io
