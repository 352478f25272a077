// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Geometry>
#include <clearway/odometry_t.hpp>

namespace clearway::messages {

/// The pose of an ODOMETRY message. A quaternion of length zero gives NaN, which PoseBuffer
/// refuses.
[[nodiscard]] inline Eigen::Isometry3d T_odom_vehicle(const odometry_t& message) {
  const Eigen::Quaterniond orientation(message.orientation[0],
                                       message.orientation[1],
                                       message.orientation[2],
                                       message.orientation[3]);
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.linear() = Eigen::Matrix3d(
      Eigen::Quaterniond(orientation.coeffs() / orientation.norm()).toRotationMatrix());
  pose.translation() = Eigen::Vector3d(message.pos[0], message.pos[1], message.pos[2]);
  return pose;
}

}  // namespace clearway::messages
