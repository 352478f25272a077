// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <optional>
#include <set>
#include <string>

#include "common/core/geometry/pose_buffer.hpp"
#include "common/core/preprocessing/pose_trust.hpp"
#include "common/core/preprocessing/preprocessor.hpp"
#include "common/core/scan/sequence_tracker.hpp"
#include "common/core/vehicle.hpp"
#include "common/process/map_client.hpp"
#include "common/process/node.hpp"
#include "common/process/scan_input.hpp"
#include "processes/preprocessor/companion_sender.hpp"

namespace clearway {

/// LIDAR_POINTS, ODOMETRY, POSE, MAP -> OBSTACLE_POINTS, FLOOR, LOCAL_MAP. See README.md beside
/// this file.
class PreprocessorProcess {
 public:
  PreprocessorProcess(const core::PreprocessorConfig& config,
                      const core::VehicleConfig& vehicle,
                      process::Node& node);

 private:
  void OnLidarPoints(const lidar_points_t& message);
  void OnOdometry(const odometry_t& message);
  void OnPose(const pose_t& message);
  void OnPoseStatus(const pose_status_t& message);
  void ProcessScan(const core::AssembledScan& scan);
  void PublishCompanions(const core::PreprocessedScan& scan);
  void Refresh();
  void SetCounters();
  [[nodiscard]] core::Surroundings CurrentSurroundings() const;
  [[nodiscard]] process::State CurrentState() const;
  [[nodiscard]] std::string MapTrouble() const;
  [[nodiscard]] core::PoseTrust::Doubt PoseDoubt() const;

  core::PreprocessorConfig config_;
  core::VehicleConfig vehicle_;
  process::Node& node_;
  process::ScanInput input_;
  core::Preprocessor preprocessor_;
  core::PoseBuffer odometry_;
  core::PoseBuffer pose_;
  core::PoseTrust pose_trust_;
  core::SequenceTracker odometry_senders_;
  std::optional<process::MapClient> map_client_;
  CompanionSender companions_;
  std::set<std::string> unknown_sensors_;
  std::optional<core::PreprocessedScan> last_;  // Without its points.
};

}  // namespace clearway
