// SPDX-License-Identifier: BSD-3-Clause
#include "processes/clusterer/clusterer_process.hpp"

#include <algorithm>
#include <stdexcept>
#include <vector>

#include "common/core/perception/detection/detection.hpp"
#include "common/messages/detections.hpp"
#include "common/messages/obstacle_points.hpp"

namespace clearway {
namespace {

using messages::channels::kDetections;
using messages::channels::kObstaclePoints;

obstacle_points_t WithoutPoints(obstacle_points_t message) {
  message.n = 0;
  for (auto* values : {&message.x, &message.y, &message.z}) values->clear();
  message.intensity.clear();
  message.flags.clear();
  return message;
}

std::int32_t CountBelowFloor(const core::PointCloud& cloud,
                             std::span<const std::uint32_t> indices) {
  return static_cast<std::int32_t>(
      std::count_if(indices.begin(), indices.end(), [&cloud](std::uint32_t i) {
        return (cloud.tag[i] & core::kFlagBelowFloor) != 0;
      }));
}

}  // namespace

ClustererProcess::ClustererProcess(core::Backend backend,
                                   const core::ClusteringConfig& config,
                                   process::Node& node)
    : backend_(backend),
      node_(node),
      input_(node,
             core::ScanAssemblerConfig{},
             1,
             [this](const core::AssembledScan& scan) { ProcessScan(scan); }),
      clusterer_(core::MakeClusterer(backend, config)) {
  node_.Subscribe<obstacle_points_t>(kObstaclePoints,
                                     [this](const auto& m) { OnObstaclePoints(m); });
  node_.BeforeStatus([this] { Refresh(); });
  Refresh();
}

void ClustererProcess::OnObstaclePoints(const obstacle_points_t& message) {
  const core::SliceOutcome outcome = input_.Add(messages::FromLcm(message));
  if (outcome == core::SliceOutcome::kAccepted) KeepHeader(message);
  input_.Emit();
}

// Scans leave the assembler in the order in which their first slices were accepted when a sender
// starts anew with an id that is in flight: so the first header of an id is that of the first scan.
void ClustererProcess::KeepHeader(const obstacle_points_t& message) {
  const auto known =
      std::find_if(headers_.begin(), headers_.end(), [&message](const obstacle_points_t& header) {
        return header.scan_id == message.scan_id && header.session == message.session;
      });
  if (known == headers_.end()) headers_.push_back(WithoutPoints(message));
}

obstacle_points_t ClustererProcess::TakeHeader(std::int64_t scan_id) {
  const auto found =
      std::find_if(headers_.begin(), headers_.end(), [scan_id](const obstacle_points_t& header) {
        return header.scan_id == scan_id;
      });
  if (found == headers_.end()) throw std::logic_error("a scan was assembled from no slice");
  obstacle_points_t header = std::move(*found);
  headers_.erase(found);
  return header;
}

void ClustererProcess::ProcessScan(const core::AssembledScan& scan) {
  const std::int64_t begin_us = node_.runtime().MonotonicUs();
  const core::PointCloud& cloud = scan.sensors.front().cloud_sensor;
  const core::Partition partition = clusterer_->Cluster(cloud);
  std::vector<detection_t> detections;
  for (std::size_t c = 0; c < partition.size(); ++c) {
    detections.push_back(
        messages::ToLcm(core::DescribeCluster(backend_, cloud, partition.Cluster(c)),
                        static_cast<std::int32_t>(c),
                        CountBelowFloor(cloud, partition.Cluster(c))));
  }
  const std::int64_t duration_us = node_.runtime().MonotonicUs() - begin_us;

  obstacle_points_t header = TakeHeader(scan.scan_id);
  if (!scan.complete) header.scan_state = obstacle_points_t::SCAN_INCOMPLETE;
  std::vector<detections_t> slices =
      messages::ToDetections(header, detections, node_.runtime().MaxMessageBytes(kDetections.bus));
  for (detections_t& slice : slices) {
    slice.points_in = static_cast<std::int32_t>(cloud.size());
    slice.processing_us = static_cast<std::int32_t>(duration_us);
  }
  node_.PublishBurst(kDetections, std::move(slices));

  node_.AddProcessingTime(duration_us);
  last_complete_ = scan.complete;
  Refresh();
}

void ClustererProcess::Refresh() {
  input_.SetCounters();
  node_.SetState(CurrentState());
}

process::State ClustererProcess::CurrentState() const {
  if (const auto trouble = input_.Trouble("OBSTACLE_POINTS")) return *trouble;
  if (!last_complete_) {
    return {status_t::STATE_DEGRADED, true, "slices of OBSTACLE_POINTS are missing"};
  }
  return {status_t::STATE_OK, true, "working"};
}

}  // namespace clearway
