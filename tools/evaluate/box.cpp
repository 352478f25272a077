// SPDX-License-Identifier: BSD-3-Clause
#include "tools/evaluate/box.hpp"

#include <cmath>
#include <numbers>
#include <utility>

#include "common/core/geometry/convex_hull.hpp"

namespace clearway::evaluate {

Box Moved(const Eigen::Isometry3d& T_G_F, Box box) {
  box.T_F_box = T_G_F * box.T_F_box;
  return box;
}

bool Contains(const Box& box, const Eigen::Vector3d& point, double margin_m) {
  const Eigen::Vector3d point_box = box.T_F_box.inverse() * point;
  const Eigen::Array3d half_m = 0.5 * box.size_m.array() + margin_m;
  return (point_box.array().abs() <= half_m).all();
}

std::vector<Eigen::Vector2f> Footprint(const Box& box) {
  std::vector<Eigen::Vector2f> corners;
  for (const double x : {-0.5, 0.5}) {
    for (const double y : {-0.5, 0.5}) {
      for (const double z : {-0.5, 0.5}) {
        const Eigen::Vector3d corner_box = Eigen::Vector3d(x, y, z).cwiseProduct(box.size_m);
        const Eigen::Vector3d corner = box.T_F_box * corner_box;
        corners.emplace_back(corner.head<2>().cast<float>());
      }
    }
  }
  return core::ConvexHull(corners);
}

double NearestDistance(const Box& box) {
  return static_cast<double>(core::NearestToOrigin(Footprint(box)).norm());
}

double Yaw(const Box& box) {
  const Eigen::Vector3d x_axis = box.T_F_box.linear().col(0);
  return std::atan2(x_axis.y(), x_axis.x());
}

double QuarterTurnDifference(double a_rad, double b_rad) {
  constexpr double kQuarterTurn_rad = 0.5 * std::numbers::pi;
  return std::abs(std::remainder(a_rad - b_rad, kQuarterTurn_rad));
}

}  // namespace clearway::evaluate
