// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <numeric>
#include <string>
#include <vector>

#include "common/core/geometry/pose.hpp"
#include "tools/evaluate/score.hpp"

namespace clearway::test {

/// A box that stands on the floor, with more than enough points.
inline evaluate::Box MakeBox(const Eigen::Vector2d& centre,
                             const Eigen::Vector3d& size_m,
                             double yaw_rad = 0.0,
                             const std::string& kind = "Pedestrian") {
  evaluate::Box box;
  box.T_F_box = core::FromRpy({centre.x(), centre.y(), 0.5 * size_m.z()}, {0.0, 0.0, yaw_rad});
  box.size_m = size_m;
  box.kind = kind;
  box.points = 1000;
  return box;
}

/// n x n points over a square with its sides along x and y, all 0.5 m above the floor.
inline std::vector<Eigen::Vector3f> MakePatch(const Eigen::Vector2f& centre, float side_m, int n) {
  std::vector<Eigen::Vector3f> points;
  for (int i = 0; i < n; ++i) {
    for (int k = 0; k < n; ++k) {
      const Eigen::Vector2f cell(static_cast<float>(i), static_cast<float>(k));
      const Eigen::Vector2f offset =
          side_m * (cell / static_cast<float>(n - 1) - Eigen::Vector2f(0.5F, 0.5F));
      points.emplace_back(centre.x() + offset.x(), centre.y() + offset.y(), 0.5F);
    }
  }
  return points;
}

/// Adds the points, and one detection of all of them, as the clusterer describes it.
inline void AddDetection(evaluate::Scene& scene, const std::vector<Eigen::Vector3f>& points) {
  std::vector<std::uint32_t> indices(points.size());
  std::iota(indices.begin(), indices.end(), static_cast<std::uint32_t>(scene.points.size()));
  for (const Eigen::Vector3f& point : points) scene.points.Add(point);
  scene.detections.push_back(
      core::DescribeCluster(core::Backend::kTextbook, scene.points, indices));
}

}  // namespace clearway::test
