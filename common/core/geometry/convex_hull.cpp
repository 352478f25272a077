// SPDX-License-Identifier: BSD-3-Clause
#include "common/core/geometry/convex_hull.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>

namespace clearway::core {
namespace {

// Twice the signed area of the triangle a, b, c; positive when it turns left.
double Orientation(const Eigen::Vector2f& a, const Eigen::Vector2f& b, const Eigen::Vector2f& c) {
  const Eigen::Vector2d ab = b.cast<double>() - a.cast<double>();
  const Eigen::Vector2d ac = c.cast<double>() - a.cast<double>();
  return ab.x() * ac.y() - ab.y() * ac.x();
}

std::vector<Eigen::Vector2f> SortedUnique(std::span<const Eigen::Vector2f> points) {
  std::vector<Eigen::Vector2f> sorted;
  sorted.reserve(points.size());
  std::copy_if(points.begin(), points.end(), std::back_inserter(sorted), [](const auto& p) {
    return std::isfinite(p.x()) && std::isfinite(p.y());
  });
  std::sort(sorted.begin(), sorted.end(), [](const auto& a, const auto& b) {
    return a.x() < b.x() || (a.x() == b.x() && a.y() < b.y());
  });
  sorted.erase(std::unique(sorted.begin(), sorted.end()), sorted.end());
  return sorted;
}

// Appends the chain over [first, last) to the hull, which keeps at least `keep` corners.
template <typename Iterator>
void AppendChain(std::vector<Eigen::Vector2f>& hull,
                 Iterator first,
                 Iterator last,
                 std::size_t keep) {
  for (; first != last; ++first) {
    while (hull.size() > keep && Orientation(hull[hull.size() - 2], hull.back(), *first) <= 0.0) {
      hull.pop_back();
    }
    hull.push_back(*first);
  }
}

// The point of the segment a-b nearest to the origin.
Eigen::Vector2d NearestOnSegment(const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
  const Eigen::Vector2d along = b - a;
  const double length2 = along.squaredNorm();
  if (length2 <= 0.0) return a;
  return a + std::clamp(-a.dot(along) / length2, 0.0, 1.0) * along;
}

}  // namespace

std::vector<Eigen::Vector2f> ConvexHull(std::span<const Eigen::Vector2f> points) {
  const std::vector<Eigen::Vector2f> sorted = SortedUnique(points);
  if (sorted.size() < 3) return sorted;

  std::vector<Eigen::Vector2f> hull;
  hull.reserve(sorted.size() + 1);
  AppendChain(hull, sorted.begin(), sorted.end(), 1);  // lower, left to right
  AppendChain(hull, std::next(sorted.rbegin()), sorted.rend(), hull.size());  // upper, back
  hull.pop_back();  // the first corner again
  return hull;
}

Eigen::Vector2f NearestToOrigin(std::span<const Eigen::Vector2f> hull) {
  if (hull.empty()) return Eigen::Vector2f::Zero();
  bool is_inside = hull.size() >= 3;
  double best_distance2 = std::numeric_limits<double>::infinity();
  Eigen::Vector2d best = hull.front().cast<double>();
  for (std::size_t i = 0; i < hull.size(); ++i) {
    const Eigen::Vector2f& a = hull[i];
    const Eigen::Vector2f& b = hull[(i + 1) % hull.size()];
    is_inside = is_inside && Orientation(a, b, Eigen::Vector2f::Zero()) >= 0.0;
    const Eigen::Vector2d candidate = NearestOnSegment(a.cast<double>(), b.cast<double>());
    if (candidate.squaredNorm() < best_distance2) {
      best_distance2 = candidate.squaredNorm();
      best = candidate;
    }
  }
  return is_inside ? Eigen::Vector2f::Zero() : Eigen::Vector2f(best.cast<float>());
}

}  // namespace clearway::core
