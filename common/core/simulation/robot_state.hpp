// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>

#include <Eigen/Geometry>

namespace clearway::core {

/// A pose in the plane, of the vehicle in map or odom.
struct PlanarPose {
  double x_m = 0.0;
  double y_m = 0.0;
  double yaw_rad = 0.0;  ///< Not wrapped: it counts whole turns.

  [[nodiscard]] Eigen::Isometry3d Transform() const {
    return Eigen::Translation3d(x_m, y_m, 0.0) *
           Eigen::AngleAxisd(yaw_rad, Eigen::Vector3d::UnitZ());
  }

  /// Where it is after `way_m` along x while turning by `turn_rad`, both at constant rates: exact,
  /// on an arc of a circle.
  [[nodiscard]] PlanarPose Moved(double way_m, double turn_rad) const {
    // The chord of the arc: way * sin(turn / 2) / (turn / 2), along the middle heading.
    const double half = 0.5 * turn_rad;
    const double sinc = std::abs(half) < 1e-4 ? 1.0 - half * half / 6.0 : std::sin(half) / half;
    return {x_m + way_m * sinc * std::cos(yaw_rad + half),
            y_m + way_m * sinc * std::sin(yaw_rad + half),
            yaw_rad + turn_rad};
  }

  friend bool operator==(const PlanarPose&, const PlanarPose&) = default;
};

/// How the robot is at one moment.
struct RobotState {
  PlanarPose in_map;         ///< What is true.
  double v_mps = 0.0;        ///< Over the floor, along x of vehicle.
  double w_radps = 0.0;      ///< Over the floor.
  double a_mps2 = 0.0;       ///< Change of v_mps.
  PlanarPose in_odom;        ///< What the wheels have turned: the same where they do not slip.
  double wheel_v_mps = 0.0;  ///< As the wheels turn.
  double wheel_w_radps = 0.0;
  double pitch_rad = 0.0;  ///< Of the body against the vehicle frame; positive looks down.
  double driven_m = 0.0;   ///< Way over the floor, ahead and back.

  [[nodiscard]] bool IsMoving() const { return v_mps != 0.0 || w_radps != 0.0; }

  /// Of what is mounted on the body. The vehicle frame itself stays level on the floor.
  [[nodiscard]] Eigen::Isometry3d T_map_body() const {
    return in_map.Transform() * Eigen::AngleAxisd(pitch_rad, Eigen::Vector3d::UnitY());
  }

  friend bool operator==(const RobotState&, const RobotState&) = default;
};

}  // namespace clearway::core
