// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <vector>

#include <Eigen/Core>

namespace clearway::core {

/// What a solid covers of the floor: a convex polygon, or a disc.
struct FlatShape {
  std::vector<Eigen::Vector2d> corners;  ///< Counter-clockwise; a disc has one: its centre.
  double radius_m = 0.0;                 ///< Of a disc; 0 for polygons.
  Eigen::Vector2d center = Eigen::Vector2d::Zero();
  double reach_m = 0.0;  ///< No point of it is further from `center`.
  std::int32_t object = -1;
};

/// A polygon of the convex hull of points. @pre three points or more, not all on one line.
[[nodiscard]] FlatShape MakePolygon(const std::vector<Eigen::Vector2d>& points);
[[nodiscard]] FlatShape MakeDisc(const Eigen::Vector2d& center, double radius_m);

/// Distance between two shapes; 0 when they have a point in common. Exact. O(corners^2).
[[nodiscard]] double Distance(const FlatShape& a, const FlatShape& b);

}  // namespace clearway::core
