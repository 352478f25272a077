// SPDX-License-Identifier: BSD-3-Clause
#include "common/core/perception/detection/detection.hpp"

#include <algorithm>
#include <limits>
#include <stdexcept>

#include "common/core/geometry/convex_hull.hpp"

namespace clearway::core {
namespace {

Rectangle EnclosingRectangle(Backend backend, std::span<const Eigen::Vector2f> points) {
  switch (backend) {
    case Backend::kTextbook:
      return SweepLeastRectangle(points);
  }
  throw std::invalid_argument("DescribeCluster: unknown backend");
}

}  // namespace

Detection DescribeCluster(Backend backend,
                          const PointCloud& cloud,
                          std::span<const std::uint32_t> indices) {
  Detection detection;
  if (indices.empty()) return detection;

  detection.num_points = static_cast<std::uint32_t>(indices.size());
  detection.z_min_m = std::numeric_limits<float>::infinity();
  detection.z_max_m = -std::numeric_limits<float>::infinity();
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  std::vector<Eigen::Vector2f> footprint;
  footprint.reserve(indices.size());
  for (const std::uint32_t i : indices) {
    const Eigen::Vector3f point = cloud.Point(i);
    sum += point.cast<double>();
    detection.z_min_m = std::min(detection.z_min_m, point.z());
    detection.z_max_m = std::max(detection.z_max_m, point.z());
    footprint.emplace_back(point.head<2>());
  }
  detection.centroid = (sum / static_cast<double>(indices.size())).cast<float>();
  detection.rectangle = EnclosingRectangle(backend, footprint);
  detection.hull = ConvexHull(footprint);
  detection.nearest = NearestToOrigin(detection.hull);
  return detection;
}

}  // namespace clearway::core
