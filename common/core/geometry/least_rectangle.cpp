// SPDX-License-Identifier: BSD-3-Clause
#include "common/core/geometry/least_rectangle.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <vector>

namespace clearway::core {
namespace {

constexpr int kNumAngles = 90;

struct Direction {
  float cosine;
  float sine;
};

// Bounds of the points along a direction (u) and across it (v).
struct Extent {
  float u_min;
  float u_max;
  float v_min;
  float v_max;

  double Area() const {
    return (static_cast<double>(u_max) - u_min) * (static_cast<double>(v_max) - v_min);
  }
};

const std::array<Direction, kNumAngles>& Directions() {
  static const std::array<Direction, kNumAngles> directions = [] {
    std::array<Direction, kNumAngles> table{};
    for (std::size_t degree = 0; degree < kNumAngles; ++degree) {
      const double angle_rad = static_cast<double>(degree) * std::numbers::pi / 180.0;
      table[degree] = {static_cast<float>(std::cos(angle_rad)),
                       static_cast<float>(std::sin(angle_rad))};
    }
    return table;
  }();
  return directions;
}

Extent Project(std::span<const Eigen::Vector2f> points, const Direction& d) {
  Extent extent{0.0F, 0.0F, 0.0F, 0.0F};  // the first point is the local origin
  for (const Eigen::Vector2f& p : points) {
    const float u = d.cosine * p.x() + d.sine * p.y();
    const float v = d.cosine * p.y() - d.sine * p.x();
    extent.u_min = std::min(extent.u_min, u);
    extent.u_max = std::max(extent.u_max, u);
    extent.v_min = std::min(extent.v_min, v);
    extent.v_max = std::max(extent.v_max, v);
  }
  return extent;
}

Rectangle ToRectangle(const Extent& extent, int degree, const Eigen::Vector2f& origin) {
  const Direction& d = Directions()[static_cast<std::size_t>(degree)];
  const float u = 0.5F * extent.u_min + 0.5F * extent.u_max;
  const float v = 0.5F * extent.v_min + 0.5F * extent.v_max;
  const float along_m = extent.u_max - extent.u_min;
  const float across_m = extent.v_max - extent.v_min;
  int yaw_deg = across_m > along_m ? degree + 90 : degree;
  if (yaw_deg > 90) yaw_deg -= 180;
  return {.center = origin + Eigen::Vector2f(d.cosine * u - d.sine * v, d.sine * u + d.cosine * v),
          .length_m = std::max(along_m, across_m),
          .width_m = std::min(along_m, across_m),
          .yaw_rad = static_cast<float>(yaw_deg * std::numbers::pi / 180.0)};
}

}  // namespace

Rectangle SweepLeastRectangle(std::span<const Eigen::Vector2f> points) {
  if (points.empty()) return {};
  // Relative to the first point: far from the origin, float products would lose the extents.
  std::vector<Eigen::Vector2f> local(points.size());
  std::transform(points.begin(), points.end(), local.begin(), [&](const Eigen::Vector2f& p) {
    return Eigen::Vector2f(p - points.front());
  });

  int best_degree = 0;
  Extent best = Project(local, Directions()[0]);
  for (int degree = 1; degree < kNumAngles; ++degree) {
    const Extent extent = Project(local, Directions()[static_cast<std::size_t>(degree)]);
    if (extent.Area() < best.Area()) {
      best = extent;
      best_degree = degree;
    }
  }
  return ToRectangle(best, best_degree, points.front());
}

}  // namespace clearway::core
