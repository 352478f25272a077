// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace clearway::io {

enum class PcdEncoding { kAscii, kBinary, kBinaryCompressed };

/// One dimension of a PCD file's points: `count` values of `size` bytes.
struct PcdField {
  std::string name;        ///< `_` is padding; several fields may be called so.
  char type = 'F';         ///< I (signed), U (unsigned) or F (IEEE float).
  std::size_t size = 4;    ///< Of one value: 1, 2, 4 or 8 [bytes].
  std::size_t count = 1;   ///< Values a point; 0 is possible for padding only.
  std::size_t offset = 0;  ///< Of its first value inside a point [bytes].
  std::size_t column = 0;  ///< Of its first value in a row of an ascii file, from 0.
};

/// Where the sensor was in the frame of the points, as the file says; identity when it does not.
struct PcdViewpoint {
  std::array<double, 3> translation_m = {0.0, 0.0, 0.0};
  std::array<double, 4> rotation_wxyz = {1.0, 0.0, 0.0, 0.0};

  bool operator==(const PcdViewpoint&) const = default;
};

struct PcdHeader {
  std::vector<PcdField> fields;
  std::uint64_t width = 0;
  std::uint64_t height = 0;
  std::uint64_t points = 0;
  PcdViewpoint viewpoint;
  PcdEncoding encoding = PcdEncoding::kAscii;
  std::size_t point_bytes = 0;  ///< Of one point with all fields and padding.
  std::size_t columns = 0;      ///< Values in a row of an ascii file.
  std::size_t body_offset = 0;  ///< Where the points start in the file [bytes].
  std::size_t body_line = 0;    ///< The line that this is; used for ascii.
  std::string glued_row;        ///< What follows `ascii` in the DATA line itself.
};

/// Reads the header of a PCD file of version .5, .6 or .7; VERSION may be missing. Entries may
/// come in any order, once each; DATA ends the header. Line ends may be LF or CR LF, comments (#)
/// and empty lines may stand anywhere. COUNT may be missing (1 each), VIEWPOINT too (identity),
/// SIZE and TYPE in ascii files only, WIDTH and HEIGHT when POINTS is there, and POINTS when both
/// of them are. After `DATA ascii` a row may follow without a line end.
/// POINTS counts: WIDTH * HEIGHT may differ from it (real Livox recordings say 0 x 0).
/// Throws ReadError with file and line.
/// Source: The PCD (Point Cloud Data) file format, pointclouds.org.
[[nodiscard]] PcdHeader ParsePcdHeader(std::string_view bytes, const std::string& file);

}  // namespace clearway::io
