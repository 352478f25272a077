// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <string>

#include "common/core/guard/stop_guard.hpp"
#include "common/core/vehicle.hpp"
#include "common/process/node.hpp"

namespace clearway {

/// LIDAR_POINTS, DETECTIONS, ODOMETRY -> DRIVE_PERMIT. See README.md beside this file.
class StopGuardProcess {
 public:
  StopGuardProcess(const core::StopGuardConfig& config,
                   const core::VehicleConfig& vehicle,
                   process::Node& node);

 private:
  void OnLidarPoints(const lidar_points_t& message);
  void PublishPermit(const core::Permit& permit);
  void Refresh();

  core::VehicleConfig vehicle_;
  process::Node& node_;
  core::StopGuard guard_;
  drive_permit_t last_{};     // As published.
  std::string slice_sensor_;  // Of the newest slice; so are the following.
  std::int64_t slice_scan_id_ = -1;
  std::int32_t slice_index_ = -1;
  std::int32_t slice_processing_us_ = 0;
  std::int64_t slice_arrival_us_ = -1;
};

}  // namespace clearway
