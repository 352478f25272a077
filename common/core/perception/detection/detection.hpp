// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "common/core/cloud.hpp"
#include "common/core/geometry/least_rectangle.hpp"
#include "common/core/perception/backend.hpp"

namespace clearway::core {

/// An obstacle as the geometry of one cluster, in the frame of the cloud it came from.
struct Detection {
  std::uint32_t num_points = 0;
  Eigen::Vector3f centroid = Eigen::Vector3f::Zero();  ///< Mean of the points [m].
  Rectangle rectangle;                                 ///< Encloses all points.
  float z_min_m = 0.0F;
  float z_max_m = 0.0F;
  std::vector<Eigen::Vector2f> hull;  ///< Convex hull in xy, counter-clockwise, not closed;
                                      ///< 1 point or 2 for degenerate clusters.
  Eigen::Vector2f nearest = Eigen::Vector2f::Zero();  ///< Point of the hull nearest to the frame's
                                                      ///< origin; the origin when inside.
};

/// Describes one cluster. Empty `indices` give a default Detection. Stateless.
/// @pre The indices are below cloud.size(), their points finite.
/// The textbook backend takes the least rectangle of a sweep in 1-degree steps over all points;
/// O(90 n + n log n).
[[nodiscard]] Detection DescribeCluster(Backend backend,
                                        const PointCloud& cloud,
                                        std::span<const std::uint32_t> indices);

}  // namespace clearway::core
