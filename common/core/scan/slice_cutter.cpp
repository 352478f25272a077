// SPDX-License-Identifier: BSD-3-Clause
#include "common/core/scan/slice_cutter.hpp"

#include <algorithm>
#include <cstddef>

namespace clearway::core {
namespace {

bool IsZeroReturn(const PointCloud& cloud, std::size_t i) {
  return cloud.x[i] == 0.0F && cloud.y[i] == 0.0F && cloud.z[i] == 0.0F;
}

bool HasTimes(const PointCloud& cloud) {
  return std::any_of(cloud.time_offset_us.begin(), cloud.time_offset_us.end(), [](std::int32_t t) {
    return t != 0;
  });
}

// Shots first .. last - 1 of the scan.
Slice CutOne(const ScanToCut& scan, std::size_t first, std::size_t last, bool has_times) {
  const PointCloud& cloud = scan.cloud_sensor;
  const std::int64_t period_us = scan.utime_end - scan.utime_start;
  Slice slice;
  slice.scan_id = scan.scan_id;
  slice.scan_utime = scan.utime_start;
  slice.scan_end_utime = scan.utime_end;
  slice.shots = static_cast<std::int64_t>(last - first);
  slice.cloud_sensor.Reserve(last - first);
  for (std::size_t i = first; i < last; ++i) {
    if (IsZeroReturn(cloud, i)) {
      ++slice.zero_returns;
      continue;
    }
    slice.cloud_sensor.AddFrom(cloud, i);
    if (!has_times) {
      slice.cloud_sensor.time_offset_us.back() = static_cast<std::int32_t>(
          period_us * static_cast<std::int64_t>(i) / static_cast<std::int64_t>(cloud.size()));
    }
  }
  return slice;
}

}  // namespace

std::vector<Slice> CutIntoSlices(const ScanToCut& scan, const SliceCut& cut) {
  const std::size_t n = scan.cloud_sensor.size();
  const auto max_points = static_cast<std::size_t>(cut.max_points);
  const std::size_t count =
      std::max(static_cast<std::size_t>(cut.min_slices), (n + max_points - 1) / max_points);
  const bool has_times = HasTimes(scan.cloud_sensor);
  std::vector<Slice> slices;
  slices.reserve(count);
  for (std::size_t k = 0; k < count; ++k) {
    slices.push_back(CutOne(scan, n * k / count, n * (k + 1) / count, has_times));
    slices.back().slice_index = static_cast<int>(k);
    slices.back().slice_count = static_cast<int>(count);
  }
  return slices;
}

}  // namespace clearway::core
