// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <optional>

#include "common/core/geometry/pose_buffer.hpp"
#include "common/core/geometry/pose_source.hpp"
#include "common/core/scan/sequence_tracker.hpp"
#include "common/process/node.hpp"

namespace clearway {

/// LIDAR_POINTS or ODOMETRY -> POSE, POSE_STATUS. See README.md beside this file.
class PoseSourceProcess {
 public:
  /// @pre config.mode is not kOff.
  PoseSourceProcess(const core::PoseSourceConfig& config, process::Node& node);

 private:
  void OnLidarPoints(const lidar_points_t& message);
  void OnOdometry(const odometry_t& message);
  void Publish(std::int64_t utime, const Eigen::Isometry3d& T_map_vehicle);
  void Refresh();

  core::PoseSourceConfig config_;
  process::Node& node_;
  core::DeadReckoning dead_reckoning_;
  core::PoseBuffer odometry_;
  core::SequenceTracker odometry_senders_;
  std::optional<std::int64_t> last_utime_;
  std::int64_t poses_ = 0;
};

}  // namespace clearway
