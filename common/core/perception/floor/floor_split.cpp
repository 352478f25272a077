// SPDX-License-Identifier: BSD-3-Clause
#include "common/core/perception/floor/floor_split.hpp"

#include "common/core/perception/limits.hpp"

namespace clearway::core {

FloorSplit SplitByFloor(const PointCloud& cloud, const Plane& plane, const FloorConfig& config) {
  const auto threshold_m = static_cast<float>(config.distance_threshold_m);
  const auto below_margin_m = static_cast<float>(config.below_margin_m);
  FloorSplit split;
  split.floor.reserve(cloud.size());
  split.above.reserve(cloud.size());
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    if (!IsMeasurement(cloud, i)) {
      ++split.num_invalid;
      continue;
    }
    const float distance_m = plane.SignedDistance(cloud.Point(i));
    const auto index = static_cast<std::uint32_t>(i);
    if (distance_m > threshold_m) {
      split.above.push_back(index);
    } else if (distance_m < -below_margin_m) {
      split.below.push_back(index);
    } else {
      split.floor.push_back(index);
    }
  }
  return split;
}

}  // namespace clearway::core
