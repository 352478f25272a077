// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <deque>
#include <memory>

#include "common/core/perception/clustering/clusterer.hpp"
#include "common/process/node.hpp"
#include "common/process/scan_input.hpp"

namespace clearway {

/// OBSTACLE_POINTS -> DETECTIONS. See README.md beside this file.
class ClustererProcess {
 public:
  ClustererProcess(core::Backend backend,
                   const core::ClusteringConfig& config,
                   process::Node& node);

 private:
  void OnObstaclePoints(const obstacle_points_t& message);
  void KeepHeader(const obstacle_points_t& message);
  [[nodiscard]] obstacle_points_t TakeHeader(std::int64_t scan_id);
  void ProcessScan(const core::AssembledScan& scan);
  void Refresh();
  [[nodiscard]] process::State CurrentState() const;

  core::Backend backend_;
  process::Node& node_;
  process::ScanInput input_;
  std::unique_ptr<core::Clusterer> clusterer_;
  std::deque<obstacle_points_t> headers_;  // Without points; one for each scan in flight.
  bool last_complete_ = true;
};

}  // namespace clearway
