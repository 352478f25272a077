// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>

#include <Eigen/Geometry>
#include <clearway/pose_status_t.hpp>
#include <clearway/pose_t.hpp>

#include "common/core/geometry/pose_source.hpp"
#include "common/messages/rigid_pose.hpp"

namespace clearway::messages {

/// The pose of a POSE message; see RigidPose() for what is no pose.
[[nodiscard]] inline Eigen::Isometry3d T_map_vehicle(const pose_t& message) {
  return RigidPose(message.pos, message.orientation);
}

/// A POSE message; velocities and accelerations are 0: not known.
[[nodiscard]] inline pose_t ToPose(std::int64_t utime, const Eigen::Isometry3d& T_map_vehicle) {
  pose_t message{};
  message.utime = utime;
  const Eigen::Quaterniond orientation(T_map_vehicle.linear());
  for (int i = 0; i < 3; ++i) message.pos[i] = T_map_vehicle.translation()[i];
  message.orientation[0] = orientation.w();
  message.orientation[1] = orientation.x();
  message.orientation[2] = orientation.y();
  message.orientation[3] = orientation.z();
  return message;
}

/// A POSE_STATUS message of a pose in the plane; `source` and session are left to the caller.
[[nodiscard]] inline pose_status_t ToPoseStatus(std::int64_t utime,
                                                const core::PoseUncertainty& uncertainty) {
  pose_status_t message{};
  message.utime = utime;
  message.state = pose_status_t::STATE_GOOD;
  const double position2 = uncertainty.position_sigma_m * uncertainty.position_sigma_m;
  message.covariance[0] = position2;
  message.covariance[7] = position2;
  message.covariance[35] = uncertainty.yaw_sigma_rad * uncertainty.yaw_sigma_rad;
  return message;
}

}  // namespace clearway::messages
