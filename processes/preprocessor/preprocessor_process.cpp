// SPDX-License-Identifier: BSD-3-Clause
#include "processes/preprocessor/preprocessor_process.hpp"

#include <algorithm>

#include "common/messages/lidar_points.hpp"
#include "common/messages/obstacle_points.hpp"
#include "common/messages/odometry.hpp"
#include "common/process/log.hpp"

namespace clearway {
namespace {

using messages::channels::kFloor;
using messages::channels::kLidarPoints;
using messages::channels::kObstaclePoints;
using messages::channels::kOdometry;

// Unknown names come from outside: remember a few, so that each is told once.
constexpr std::size_t kMaxUnknownNames = 16;

std::string Quoted(const std::string& name) {
  std::string text = name.substr(0, core::SensorConfig::kMaxNameLength);
  std::replace_if(
      text.begin(), text.end(), [](unsigned char c) { return c < 32; }, '?');
  return '"' + text + (text.size() < name.size() ? "...\"" : "\"");
}

}  // namespace

PreprocessorProcess::PreprocessorProcess(const core::PreprocessorConfig& config,
                                         const core::VehicleConfig& vehicle,
                                         process::Node& node)
    : vehicle_(vehicle),
      node_(node),
      input_(node,
             config.assembler,
             static_cast<int>(vehicle.sensors.size()),
             [this](const core::AssembledScan& scan) { ProcessScan(scan); }),
      preprocessor_(config, vehicle),
      odometry_(config.odometry) {
  node_.Subscribe<lidar_points_t>(kLidarPoints, [this](const auto& m) { OnLidarPoints(m); });
  if (!vehicle_.stationary) {
    node_.Subscribe<odometry_t>(kOdometry, [this](const auto& m) { OnOdometry(m); });
  }
  node_.BeforeStatus([this] { Refresh(); });
  Refresh();
}

void PreprocessorProcess::OnLidarPoints(const lidar_points_t& message) {
  const std::optional<int> sensor = vehicle_.FindSensor(message.sensor);
  if (!sensor && unknown_sensors_.size() < kMaxUnknownNames &&
      unknown_sensors_.insert(Quoted(message.sensor)).second) {
    process::LogWarning("LIDAR_POINTS of a sensor that is not in the configuration: " +
                        Quoted(message.sensor));
  }
  input_.Add(messages::FromLcm(message, sensor.value_or(-1)));
  input_.Emit();
}

void PreprocessorProcess::OnOdometry(const odometry_t& message) {
  const core::PoseBuffer::Outcome outcome =
      odometry_.Add(message.utime, messages::T_odom_vehicle(message));
  if (outcome == core::PoseBuffer::Outcome::kInvalid) node_.CountInvalid();
}

void PreprocessorProcess::ProcessScan(const core::AssembledScan& scan) {
  const std::int64_t begin_us = node_.runtime().MonotonicUs();
  core::PreprocessedScan result = preprocessor_.Process(scan, &odometry_);
  const std::int64_t duration_us = node_.runtime().MonotonicUs() - begin_us;

  node_.Publish(kFloor, messages::ToFloor(result));
  node_.PublishBurst(
      kObstaclePoints,
      messages::ToObstaclePoints(
          result, duration_us, node_.runtime().MaxMessageBytes(kObstaclePoints.bus)));

  node_.AddProcessingTime(duration_us);
  result.obstacles_vehicle.Clear();
  last_ = std::move(result);
  Refresh();
}

void PreprocessorProcess::Refresh() {
  input_.SetCounters();
  node_.SetState(CurrentState());
}

process::State PreprocessorProcess::CurrentState() const {
  if (const auto trouble = input_.Trouble("LIDAR_POINTS")) return *trouble;
  if (!last_->missing_sensors.empty()) {
    const auto sensor = static_cast<std::size_t>(last_->missing_sensors.front());
    return {status_t::STATE_DEGRADED,
            true,
            "nothing from sensor \"" + vehicle_.sensors[sensor].name + "\""};
  }
  if (!last_->complete) {
    return {status_t::STATE_DEGRADED,
            true,
            "slices of LIDAR_POINTS are missing from the last scan: " +
                std::to_string(last_->missing_slices)};
  }
  if (last_->deskew == core::DeskewState::kNoOdometry) {
    return {status_t::STATE_DEGRADED,
            true,
            "no ODOMETRY: points are where they were measured; set vehicle.stationary if the "
            "vehicle stands still"};
  }
  if (last_->floor.state != core::FloorState::kFound) {
    return {status_t::STATE_DEGRADED,
            true,
            last_->floor.state == core::FloorState::kHeld
                ? "no floor found in the last scan: using the last good one"
                : "no floor found: using z = 0 of the vehicle"};
  }
  return {status_t::STATE_OK, true, "working"};
}

}  // namespace clearway
