// SPDX-License-Identifier: BSD-3-Clause
#include "tools/evaluate/membership.hpp"

#include <algorithm>
#include <limits>
#include <numeric>

#include <Eigen/Geometry>

namespace clearway::evaluate {
namespace {

using Hull = std::vector<Eigen::Vector2d>;

double Cross(const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
  return a.x() * b.y() - a.y() * b.x();
}

double DistanceToSegment(const Eigen::Vector2d& p,
                         const Eigen::Vector2d& a,
                         const Eigen::Vector2d& b) {
  const Eigen::Vector2d ab = b - a;
  const double length2 = ab.squaredNorm();
  const double along = length2 > 0.0 ? std::clamp((p - a).dot(ab) / length2, 0.0, 1.0) : 0.0;
  return (p - a - along * ab).norm();
}

// 0 inside; an empty hull is infinitely far away.
double DistanceToHull(const Eigen::Vector2d& p, const Hull& hull) {
  const std::size_t n = hull.size();
  bool is_inside = n >= 3;
  double distance = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < n; ++i) {
    const Eigen::Vector2d& a = hull[i];
    const Eigen::Vector2d& b = hull[(i + 1) % n];
    is_inside = is_inside && Cross(b - a, p - a) >= 0.0;
    distance = std::min(distance, DistanceToSegment(p, a, b));
  }
  return is_inside ? 0.0 : distance;
}

double Area(const Hull& hull) {
  double twice = 0.0;
  for (std::size_t i = 0; i < hull.size(); ++i) {
    twice += Cross(hull[i] - hull[0], hull[(i + 1) % hull.size()] - hull[0]);
  }
  return 0.5 * twice;
}

// A detection, prepared for many questions.
class Region {
 public:
  Region(const core::Detection& detection)
      : z_min_m_(detection.z_min_m), z_max_m_(detection.z_max_m) {
    for (const Eigen::Vector2f& vertex : detection.hull) {
      hull_.emplace_back(vertex.cast<double>());
      bounds_.extend(hull_.back());
    }
  }

  [[nodiscard]] double area_m2() const { return Area(hull_); }

  [[nodiscard]] bool Contains(const Eigen::Vector3f& p) const {
    if (!(p.z() >= z_min_m_ && p.z() <= z_max_m_)) return false;
    const Eigen::Vector2d xy = p.head<2>().cast<double>();
    return !bounds_.isEmpty() &&
           bounds_.squaredExteriorDistance(xy) <= kHullMargin_m * kHullMargin_m &&
           DistanceToHull(xy, hull_) <= kHullMargin_m;
  }

 private:
  float z_min_m_;
  float z_max_m_;
  Hull hull_;
  Eigen::AlignedBox2d bounds_;
};

// Indices of the regions, the smallest hull first.
std::vector<std::size_t> SmallestFirst(const std::vector<Region>& regions) {
  std::vector<double> areas_m2;
  for (const Region& region : regions) areas_m2.push_back(region.area_m2());
  std::vector<std::size_t> order(regions.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    return areas_m2[a] < areas_m2[b];
  });
  return order;
}

}  // namespace

std::vector<std::optional<std::size_t>> DetectionsOfPoints(
    const core::PointCloud& points,
    std::span<const core::Detection> detections) {
  const std::vector<Region> regions(detections.begin(), detections.end());
  const std::vector<std::size_t> order = SmallestFirst(regions);
  std::vector<std::optional<std::size_t>> owners(points.size());
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (!core::IsFinite(points, i)) continue;
    const Eigen::Vector3f point = points.Point(i);
    const auto owner = std::find_if(
        order.begin(), order.end(), [&](std::size_t k) { return regions[k].Contains(point); });
    if (owner != order.end()) owners[i] = *owner;
  }
  return owners;
}

std::vector<std::vector<std::size_t>> PointsOfDetections(
    const core::PointCloud& points,
    std::span<const core::Detection> detections) {
  const auto owners = DetectionsOfPoints(points, detections);
  std::vector<std::vector<std::size_t>> members(detections.size());
  for (std::size_t i = 0; i < owners.size(); ++i) {
    if (owners[i]) members[*owners[i]].push_back(i);
  }
  return members;
}

}  // namespace clearway::evaluate
