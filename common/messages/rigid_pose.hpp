// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>
#include <limits>

#include <Eigen/Geometry>

namespace clearway::messages {

/// A pose from its position [m] and quaternion w x y z, as messages hold them. A quaternion whose
/// length is zero, not finite or beyond a double gives NaN, which PoseBuffer refuses.
[[nodiscard]] inline Eigen::Isometry3d RigidPose(const double (&position)[3],
                                                 const double (&orientation)[4]) {
  const Eigen::Quaterniond quaternion(
      orientation[0], orientation[1], orientation[2], orientation[3]);
  // Divided by an infinite length, all four would be 0, and that a rotation by nothing.
  const double length = std::isfinite(quaternion.norm()) ? quaternion.norm()
                                                         : std::numeric_limits<double>::quiet_NaN();
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.linear() =
      Eigen::Matrix3d(Eigen::Quaterniond(quaternion.coeffs() / length).toRotationMatrix());
  pose.translation() = Eigen::Vector3d(position[0], position[1], position[2]);
  return pose;
}

}  // namespace clearway::messages
