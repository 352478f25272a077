// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Geometry>
#include <clearway/odometry_t.hpp>

#include "common/messages/rigid_pose.hpp"

namespace clearway::messages {

/// The pose of an ODOMETRY message; see RigidPose() for what is no pose.
[[nodiscard]] inline Eigen::Isometry3d T_odom_vehicle(const odometry_t& message) {
  return RigidPose(message.pos, message.orientation);
}

}  // namespace clearway::messages
