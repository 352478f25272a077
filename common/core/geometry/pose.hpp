// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>
#include <cstdint>

#include <Eigen/Geometry>

namespace clearway::core {

/// A pose of the vehicle in a fixed frame (odom or map) with the time it was measured at.
struct StampedPose {
  std::int64_t utime = 0;  ///< [us since the epoch]
  Eigen::Isometry3d T_fixed_vehicle = Eigen::Isometry3d::Identity();
};

/// R = Rz(yaw) Ry(pitch) Rx(roll): first roll about x, then pitch about y, then yaw about z, all
/// about the fixed axes of the target frame. Positive pitch turns x downwards.
[[nodiscard]] inline Eigen::Isometry3d FromRpy(const Eigen::Vector3d& translation_m,
                                               const Eigen::Vector3d& roll_pitch_yaw_rad) {
  Eigen::Isometry3d transform = Eigen::Isometry3d::Identity();
  transform.linear() = (Eigen::AngleAxisd(roll_pitch_yaw_rad.z(), Eigen::Vector3d::UnitZ()) *
                        Eigen::AngleAxisd(roll_pitch_yaw_rad.y(), Eigen::Vector3d::UnitY()) *
                        Eigen::AngleAxisd(roll_pitch_yaw_rad.x(), Eigen::Vector3d::UnitX()))
                           .toRotationMatrix();
  transform.translation() = translation_m;
  return transform;
}

/// The pose at fraction `alpha` of the way from a (0) to b (1): the translation runs on a straight
/// line, the rotation about one fixed axis the shorter way round. Beyond [0, 1] it extrapolates.
[[nodiscard]] inline Eigen::Isometry3d Interpolate(const Eigen::Isometry3d& a,
                                                   const Eigen::Isometry3d& b,
                                                   double alpha) {
  Eigen::AngleAxisd turn(Eigen::Quaterniond(a.linear().transpose() * b.linear()).normalized());
  if (turn.angle() > M_PI) turn.angle() -= 2.0 * M_PI;
  Eigen::Isometry3d result = Eigen::Isometry3d::Identity();
  turn.angle() *= alpha;
  result.linear() = a.linear() * turn.toRotationMatrix();
  result.translation() = a.translation() + alpha * (b.translation() - a.translation());
  return result;
}

/// False when an entry is NaN or infinite.
[[nodiscard]] inline bool IsFinite(const Eigen::Isometry3d& pose) {
  return pose.matrix().allFinite();
}

}  // namespace clearway::core
