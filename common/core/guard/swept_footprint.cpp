// SPDX-License-Identifier: BSD-3-Clause
#include "common/core/guard/swept_footprint.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>

namespace clearway::core {

namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr auto kForward = static_cast<std::size_t>(Direction::kForward);
constexpr auto kBackward = static_cast<std::size_t>(Direction::kBackward);
constexpr auto kTurnLeft = static_cast<std::size_t>(Direction::kTurnLeft);
constexpr auto kTurnRight = static_cast<std::size_t>(Direction::kTurnRight);

double Cross(const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
  return a.x() * b.y() - a.y() * b.x();
}

// The x at which the line y = const enters and leaves a convex polygon.
struct Span {
  double back;
  double front;
};

std::optional<Span> CutAt(const std::vector<Eigen::Vector2d>& polygon, double y) {
  Span span{kInfinity, -kInfinity};
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const Eigen::Vector2d& a = polygon[i];
    const Eigen::Vector2d& b = polygon[(i + 1) % polygon.size()];
    if (y < std::min(a.y(), b.y()) || y > std::max(a.y(), b.y())) continue;
    if (a.y() == b.y()) {
      span.back = std::min({span.back, a.x(), b.x()});
      span.front = std::max({span.front, a.x(), b.x()});
    } else {
      const double x = a.x() + (b.x() - a.x()) * (y - a.y()) / (b.y() - a.y());
      span.back = std::min(span.back, x);
      span.front = std::max(span.front, x);
    }
  }
  if (span.back > span.front) return std::nullopt;
  return span;
}

// Convex hull, counter-clockwise. Source: A. M. Andrew, Another efficient algorithm for convex
// hulls in two dimensions, Information Processing Letters 9, 1979.
std::vector<Eigen::Vector2d> Hull(std::vector<Eigen::Vector2d> points) {
  std::sort(points.begin(), points.end(), [](const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
    return a.x() != b.x() ? a.x() < b.x() : a.y() < b.y();
  });
  std::vector<Eigen::Vector2d> hull;
  for (int side = 0; side < 2; ++side) {
    const std::size_t first = hull.size();
    for (const Eigen::Vector2d& p : points) {
      while (hull.size() >= first + 2 &&
             Cross(hull.back() - hull[hull.size() - 2], p - hull.back()) <= 0.0) {
        hull.pop_back();
      }
      hull.push_back(p);
    }
    hull.pop_back();
    std::reverse(points.begin(), points.end());
  }
  return hull;
}

std::vector<Eigen::Vector2d> Widen(const std::vector<Eigen::Vector2d>& polygon, double margin_m) {
  std::vector<Eigen::Vector2d> points;
  for (const Eigen::Vector2d& p : polygon) {
    points.emplace_back(p.x(), p.y() - margin_m);
    points.emplace_back(p.x(), p.y() + margin_m);
  }
  return Hull(std::move(points));
}

// Every edge moved outwards; each corner where its two moved edges meet.
std::vector<Eigen::Vector2d> Grow(const std::vector<Eigen::Vector2d>& polygon, double margin_m) {
  const std::size_t n = polygon.size();
  std::vector<Eigen::Vector2d> grown;
  for (std::size_t i = 0; i < n; ++i) {
    const Eigen::Vector2d before = (polygon[i] - polygon[(i + n - 1) % n]).normalized();
    const Eigen::Vector2d after = (polygon[(i + 1) % n] - polygon[i]).normalized();
    // Outward normals are (d.y, -d.x); their sum points along the corner's bisector.
    const Eigen::Vector2d sum(before.y() + after.y(), -before.x() - after.x());
    grown.emplace_back(polygon[i] + sum * (margin_m / (1.0 + before.dot(after))));
  }
  return grown;
}

double PositiveAngle(double angle_rad) {
  const double wrapped = std::fmod(angle_rad, 2.0 * std::numbers::pi);
  return wrapped < 0.0 ? wrapped + 2.0 * std::numbers::pi : wrapped;
}

}  // namespace

bool IsInside(const std::vector<Eigen::Vector2d>& polygon, const Eigen::Vector2d& point) {
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const Eigen::Vector2d edge = polygon[(i + 1) % polygon.size()] - polygon[i];
    if (Cross(edge, point - polygon[i]) < 0.0) return false;
  }
  return true;
}

SweptFootprint::SweptFootprint(const std::vector<Eigen::Vector2d>& footprint, double margin_m)
    : footprint_(footprint),
      widened_(Widen(footprint, margin_m)),
      grown_(Grow(footprint, margin_m)) {
  for (const Eigen::Vector2d& corner : grown_) {
    turn_radius_m_ = std::max(turn_radius_m_, corner.norm());
  }
  for (const Eigen::Vector2d& corner : footprint_) {
    half_length_m_ = std::max(half_length_m_, std::abs(corner.x()));
  }
}

FreeWay SweptFootprint::WayTo(const Eigen::Vector2d& point_vehicle) const {
  FreeWay way;
  way.fill(kInfinity);
  if (IsInside(footprint_, point_vehicle)) {
    way.fill(0.0);
    return way;
  }
  StraightWay(point_vehicle, way);
  TurningWay(point_vehicle, way);
  return way;
}

void SweptFootprint::StraightWay(const Eigen::Vector2d& point, FreeWay& way) const {
  const std::optional<Span> wide = CutAt(widened_, point.y());
  if (!wide) return;
  if (point.x() > wide->front) {
    way[kForward] = point.x() - wide->front;
  } else if (point.x() < wide->back) {
    way[kBackward] = wide->back - point.x();
  } else if (const std::optional<Span> narrow = CutAt(footprint_, point.y())) {
    // In the margin, but before or behind the footprint itself.
    way[point.x() > narrow->front ? kForward : kBackward] = 0.0;
  }
}

void SweptFootprint::TurningWay(const Eigen::Vector2d& point, FreeWay& way) const {
  const double radius2 = point.squaredNorm();
  if (radius2 > turn_radius_m_ * turn_radius_m_) return;
  if (IsInside(grown_, point)) {
    way[kTurnLeft] = way[kTurnRight] = 0.0;
    return;
  }
  const double bearing = std::atan2(point.y(), point.x());
  for (std::size_t i = 0; i < grown_.size(); ++i) {
    const Eigen::Vector2d& a = grown_[i];
    const Eigen::Vector2d d = grown_[(i + 1) % grown_.size()] - a;
    // |a + s d|^2 = radius^2
    const double half_b = a.dot(d);
    const double root2 = half_b * half_b - d.squaredNorm() * (a.squaredNorm() - radius2);
    if (root2 < 0.0) continue;
    for (const double sign : {-1.0, 1.0}) {
      const double s = (-half_b + sign * std::sqrt(root2)) / d.squaredNorm();
      if (s < 0.0 || s > 1.0) continue;
      const Eigen::Vector2d q = a + s * d;
      const double left = PositiveAngle(bearing - std::atan2(q.y(), q.x()));
      way[kTurnLeft] = std::min(way[kTurnLeft], left);
      way[kTurnRight] = std::min(way[kTurnRight], 2.0 * std::numbers::pi - left);
    }
  }
}

}  // namespace clearway::core
