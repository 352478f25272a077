// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "common/core/cloud.hpp"
#include "common/core/geometry/plane.hpp"
#include "common/core/perception/floor/floor_finder.hpp"

namespace clearway::core {

/// The points of a scan by their place relative to the floor: indices, ascending, disjoint. With
/// the signed distance d of a point from the plane, distance_threshold_m t, below_margin_m b:
struct FloorSplit {
  std::vector<std::uint32_t> floor;  ///< -b <= d <= t: the floor, its noise and shallow dents.
  std::vector<std::uint32_t> above;  ///< d > t: obstacles, and all that stands or hangs.
  std::vector<std::uint32_t> below;  ///< d < -b: a hole, a step down; an obstacle too.
  std::size_t num_invalid = 0;       ///< Not finite or beyond kMaxCoordinate_m; in none of them.
};

/// Classifies each point by the plane. Cloud and plane are in the same frame. O(n). Stateless.
[[nodiscard]] FloorSplit SplitByFloor(const PointCloud& cloud,
                                      const Plane& plane,
                                      const FloorConfig& config);

}  // namespace clearway::core
