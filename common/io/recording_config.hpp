// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <utility>

namespace clearway::io {

/// Where the stamps of a recording's scans come from.
enum class StampSource {
  kName,  ///< From the names of the files; see ParseScanStamp().
  kRate,  ///< Scan after scan at rate_hz.
};

/// What a recording's files do not say themselves. XML element: <recording>.
struct RecordingConfig {
  /// Floats a point of .bin files: 3 (x y z) or 4 (x y z intensity).
  int floats_per_point = 4;
  /// A file's intensity times this is 0..255.
  double intensity_scale = 1.0;
  /// 0: a file is a scan; else each file is cut into scans of this many points.
  int points_per_scan = 0;
  StampSource stamp = StampSource::kRate;
  /// Scans per second [Hz].
  double rate_hz = 10.0;

  template <typename Self, typename Visitor>
  static void Visit(Self& self, Visitor& visitor) {
    visitor.Integer("floats_per_point",
                    self.floats_per_point,
                    3,
                    4,
                    "Floats a point in .bin files: 3 (x y z) or 4 (x y z intensity). It cannot be "
                    "told from the files; a wrong value gives nonsense.");
    visitor.Number("intensity_scale",
                   self.intensity_scale,
                   0.0,
                   100000.0,
                   "A file's intensity times this is 0..255. Recordings that hold 0..1 (KITTI) "
                   "need 255.");
    visitor.Integer("points_per_scan",
                    self.points_per_scan,
                    0,
                    10000000,
                    "0: a file is a scan. Else a file is one long cloud in time order and is cut "
                    "into scans of this many points; the last one may have fewer.");
    visitor.Choice("stamp",
                   self.stamp,
                   std::array{std::pair<const char*, StampSource>{"name", StampSource::kName},
                              std::pair<const char*, StampSource>{"rate", StampSource::kRate}},
                   "name: file names are stamps (seconds with a decimal point, or 14 to 16 digits "
                   "of microseconds, or 17 to 19 of nanoseconds). rate: one scan after the other "
                   "at rate_hz.");
    visitor.Number("rate_hz",
                   self.rate_hz,
                   0.1,
                   100.0,
                   "Scans per second of the sensor [Hz]; a scan's points are spread evenly over "
                   "its period.");
  }
};

}  // namespace clearway::io
