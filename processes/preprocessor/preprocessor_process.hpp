// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <set>
#include <string>

#include "common/core/geometry/pose_buffer.hpp"
#include "common/core/preprocessing/preprocessor.hpp"
#include "common/core/vehicle.hpp"
#include "common/process/node.hpp"
#include "common/process/scan_input.hpp"

namespace clearway {

/// LIDAR_POINTS, ODOMETRY -> OBSTACLE_POINTS, FLOOR. See README.md beside this file.
class PreprocessorProcess {
 public:
  PreprocessorProcess(const core::PreprocessorConfig& config,
                      const core::VehicleConfig& vehicle,
                      process::Node& node);

 private:
  void OnLidarPoints(const lidar_points_t& message);
  void OnOdometry(const odometry_t& message);
  void ProcessScan(const core::AssembledScan& scan);
  void Refresh();
  [[nodiscard]] process::State CurrentState() const;

  core::VehicleConfig vehicle_;
  process::Node& node_;
  process::ScanInput input_;
  core::Preprocessor preprocessor_;
  core::PoseBuffer odometry_;
  std::set<std::string> unknown_sensors_;
  std::optional<core::PreprocessedScan> last_;  // Without its points.
};

}  // namespace clearway
