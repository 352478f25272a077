// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <vector>

#include "common/core/cloud.hpp"
#include "common/core/scan/scan_assembler.hpp"

namespace clearway::core {

/// How a scan is cut into slices.
struct SliceCut {
  int max_points = 3000;  ///< Most points in one slice; at least 1.
  int min_slices = 10;    ///< Least number of slices; at least 1, at most kMaxSlices.
};

/// What CutIntoSlices() has to know about a scan.
struct ScanToCut {
  std::int64_t scan_id = 0;
  std::int64_t utime_start = 0;
  std::int64_t utime_end = 0;
  PointCloud
      cloud_sensor;  ///< One point a shot, in order of time; (0, 0, 0) where nothing returned.
};

/// Cuts a scan into slices of equal numbers of shots. Zero returns are taken out and counted;
/// points that are not finite stay. Where all time offsets are 0, the cloud has one stamp only, and
/// its points are spread evenly over the scan. Sensor, session and sequence are left to the caller.
/// Every point is in exactly one slice; an empty scan gives min_slices empty ones. O(n).
[[nodiscard]] std::vector<Slice> CutIntoSlices(const ScanToCut& scan, const SliceCut& cut);

}  // namespace clearway::core
