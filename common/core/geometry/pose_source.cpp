// SPDX-License-Identifier: BSD-3-Clause
#include "common/core/geometry/pose_source.hpp"

namespace clearway::core {

Eigen::Isometry3d DeadReckoning::Update(const Eigen::Isometry3d& T_odom_vehicle) {
  if (!T_map_odom_) {
    T_map_odom_ = T_map_vehicle_.value_or(config_.Start()) * T_odom_vehicle.inverse();
  }
  const Eigen::Isometry3d T_map_vehicle = *T_map_odom_ * T_odom_vehicle;
  if (T_map_vehicle_) {
    driven_m_ += (T_map_vehicle.translation() - T_map_vehicle_->translation()).norm();
  }
  T_map_vehicle_ = T_map_vehicle;
  return T_map_vehicle;
}

PoseUncertainty DeadReckoning::uncertainty() const {
  return {config_.position_sigma_m + config_.position_drift * driven_m_,
          config_.yaw_sigma_rad + config_.yaw_drift_rad_per_m * driven_m_};
}

}  // namespace clearway::core
