// SPDX-License-Identifier: BSD-3-Clause
#include "common/core/simulation/flat_shape.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace clearway::core {
namespace {

using Eigen::Vector2d;

double Cross(const Vector2d& a, const Vector2d& b) {
  return a.x() * b.y() - a.y() * b.x();
}

double DistanceToSegment(const Vector2d& point, const Vector2d& a, const Vector2d& b) {
  const Vector2d way = b - a;
  const double length2 = way.squaredNorm();
  const double share = length2 > 0.0 ? std::clamp((point - a).dot(way) / length2, 0.0, 1.0) : 0.0;
  return (a + share * way - point).norm();
}

// Whether an edge of `a` has all of `b` strictly on its outer side.
bool HasSeparatingEdge(const FlatShape& a, const FlatShape& b) {
  for (std::size_t i = 0; i < a.corners.size(); ++i) {
    const Vector2d& from = a.corners[i];
    const Vector2d edge = a.corners[(i + 1) % a.corners.size()] - from;
    if (std::all_of(b.corners.begin(), b.corners.end(), [&](const Vector2d& corner) {
          return Cross(edge, corner - from) < 0.0;
        })) {
      return true;
    }
  }
  return false;
}

// From the corners of `a` to the outline of `b`.
double CornersToOutline(const FlatShape& a, const FlatShape& b) {
  double least_m = std::numeric_limits<double>::infinity();
  for (const Vector2d& corner : a.corners) {
    for (std::size_t i = 0; i < b.corners.size(); ++i) {
      least_m = std::min(
          least_m, DistanceToSegment(corner, b.corners[i], b.corners[(i + 1) % b.corners.size()]));
    }
  }
  return least_m;
}

bool IsDisc(const FlatShape& shape) {
  return shape.corners.size() == 1;
}

double ToDisc(const FlatShape& shape, const FlatShape& disc) {
  if (IsDisc(shape)) {
    return std::max(0.0, (shape.center - disc.center).norm() - shape.radius_m - disc.radius_m);
  }
  if (!HasSeparatingEdge(shape, disc)) return 0.0;  // Its centre lies within.
  return std::max(0.0, CornersToOutline(disc, shape) - disc.radius_m);
}

}  // namespace

FlatShape MakePolygon(const std::vector<Vector2d>& points) {
  std::vector<Vector2d> sorted = points;
  std::sort(sorted.begin(), sorted.end(), [](const Vector2d& a, const Vector2d& b) {
    return a.x() != b.x() ? a.x() < b.x() : a.y() < b.y();
  });
  FlatShape shape;
  // Lower, then upper half. Source: A. M. Andrew, 1979 (monotone chain).
  for (int half = 0; half < 2; ++half) {
    const std::size_t first = shape.corners.size();
    for (const Vector2d& p : sorted) {
      while (shape.corners.size() >= first + 2 &&
             Cross(shape.corners.back() - shape.corners[shape.corners.size() - 2],
                   p - shape.corners.back()) <= 0.0) {
        shape.corners.pop_back();
      }
      shape.corners.push_back(p);
    }
    shape.corners.pop_back();
    std::reverse(sorted.begin(), sorted.end());
  }
  for (const Vector2d& corner : shape.corners) shape.center += corner;
  shape.center /= static_cast<double>(shape.corners.size());
  for (const Vector2d& corner : shape.corners) {
    shape.reach_m = std::max(shape.reach_m, (corner - shape.center).norm());
  }
  return shape;
}

FlatShape MakeDisc(const Vector2d& center, double radius_m) {
  FlatShape disc;
  disc.corners = {center};
  disc.center = center;
  disc.radius_m = disc.reach_m = radius_m;
  return disc;
}

double Distance(const FlatShape& a, const FlatShape& b) {
  if (IsDisc(b)) return ToDisc(a, b);
  if (IsDisc(a)) return ToDisc(b, a);
  if (!HasSeparatingEdge(a, b) && !HasSeparatingEdge(b, a)) return 0.0;
  return std::min(CornersToOutline(a, b), CornersToOutline(b, a));
}

}  // namespace clearway::core
