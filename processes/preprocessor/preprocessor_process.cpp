// SPDX-License-Identifier: BSD-3-Clause
#include "processes/preprocessor/preprocessor_process.hpp"

#include <algorithm>
#include <utility>
#include <vector>

#include "common/messages/lidar_points.hpp"
#include "common/messages/map_tiles.hpp"
#include "common/messages/obstacle_points.hpp"
#include "common/messages/odometry.hpp"
#include "common/messages/pose.hpp"
#include "common/process/log.hpp"

namespace clearway {
namespace {

using messages::channels::kFloor;
using messages::channels::kLidarPoints;
using messages::channels::kLocalMap;
using messages::channels::kObstaclePoints;
using messages::channels::kOdometry;
using messages::channels::kPose;
using messages::channels::kPoseStatus;
using messages::channels::kRemovedPoints;

// Unknown names come from outside: remember a few, so that each is told once.
constexpr std::size_t kMaxUnknownNames = 16;

// Obstacle points that need longer than this to get onto the bus are late [us].
constexpr std::int64_t kSlowBusUs = 200'000;

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
    : config_(config),
      vehicle_(vehicle),
      node_(node),
      input_(node,
             config.assembler,
             static_cast<int>(vehicle.sensors.size()),
             [this](const core::AssembledScan& scan) { ProcessScan(scan); }),
      preprocessor_(config, vehicle),
      odometry_(config.odometry),
      pose_(config.pose),
      companions_(node) {
  node_.Subscribe<lidar_points_t>(kLidarPoints, [this](const auto& m) { OnLidarPoints(m); });
  if (!vehicle_.stationary) {
    node_.Subscribe<odometry_t>(kOdometry, [this](const auto& m) { OnOdometry(m); });
  }
  if (config_.map_filter.enabled || config_.local_map.enabled) {
    node_.Subscribe<pose_t>(kPose, [this](const auto& m) { OnPose(m); });
    node_.Subscribe<pose_status_t>(kPoseStatus, [this](const auto& m) { OnPoseStatus(m); });
  }
  if (config_.map_filter.enabled) map_client_.emplace(node_, "preprocessor");
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
  using core::SequenceVerdict;
  const std::int64_t session_before = odometry_senders_.session();
  const SequenceVerdict verdict =
      odometry_senders_.Observe(message.session, message.sequence, node_.runtime().MonotonicUs());
  if (verdict == SequenceVerdict::kForeign) return;
  // A base that started anew has another odom: nothing may be interpolated across.
  if (verdict == SequenceVerdict::kRestart && message.session != session_before) odometry_.Clear();
  const core::PoseBuffer::Outcome outcome =
      odometry_.Add(message.utime, messages::T_odom_vehicle(message));
  if (outcome == core::PoseBuffer::Outcome::kInvalid) node_.CountInvalid();
}

void PreprocessorProcess::OnPose(const pose_t& message) {
  const Eigen::Isometry3d T_map_vehicle = messages::T_map_vehicle(message);
  core::PoseBuffer::Outcome outcome = pose_.Add(message.utime, T_map_vehicle);
  if (outcome == core::PoseBuffer::Outcome::kInvalid) node_.CountInvalid();
  // One stamp with two poses has two sources.
  if (outcome == core::PoseBuffer::Outcome::kDuplicate &&
      pose_.Lookup(message.utime)->matrix() != T_map_vehicle.matrix()) {
    outcome = core::PoseBuffer::Outcome::kOutOfOrder;
  }
  pose_trust_.OnPose(message.utime, outcome, node_.runtime().MonotonicUs());
}

// A state that the type does not know is no word of trust.
void PreprocessorProcess::OnPoseStatus(const pose_status_t& message) {
  const bool is_good =
      message.state == pose_status_t::STATE_UNCERTAIN || message.state == pose_status_t::STATE_GOOD;
  if (!is_good && message.state != pose_status_t::STATE_LOST) node_.CountInvalid();
  pose_trust_.OnStatus(!is_good, message.session, message.sequence, node_.runtime().MonotonicUs());
}

core::PoseTrust::Doubt PreprocessorProcess::PoseDoubt() const {
  return pose_trust_.Query(node_.runtime().MonotonicUs());
}

core::Surroundings PreprocessorProcess::CurrentSurroundings() const {
  return {.odometry = &odometry_,
          .pose = &pose_,
          .is_pose_lost = PoseDoubt() != core::PoseTrust::Doubt::kNone,
          .map = map_client_ ? map_client_->map() : nullptr};
}

void PreprocessorProcess::ProcessScan(const core::AssembledScan& scan) {
  const std::int64_t begin_us = node_.runtime().MonotonicUs();
  core::PreprocessedScan result = preprocessor_.Process(scan, CurrentSurroundings());
  const std::int64_t duration_us = node_.runtime().MonotonicUs() - begin_us;

  node_.Publish(kFloor, messages::ToFloor(result));
  process::Runtime& runtime = node_.runtime();
  std::vector<obstacle_points_t> obstacles =
      messages::ToObstaclePoints(result, duration_us, runtime.MaxMessageBytes(kObstaclePoints.bus));
  companions_.NoteObstacles(obstacles.size(), runtime.BurstIntervalUs(kObstaclePoints.bus));
  node_.PublishBurst(kObstaclePoints, std::move(obstacles));
  PublishCompanions(result);

  node_.AddProcessingTime(duration_us);
  result.obstacles_vehicle.Clear();
  result.removed_vehicle.Clear();
  result.local_map.reset();
  last_ = std::move(result);
  Refresh();
}

void PreprocessorProcess::PublishCompanions(const core::PreprocessedScan& scan) {
  const process::Runtime& runtime = node_.runtime();
  if (scan.local_map) {
    companions_.Send(kLocalMap,
                     messages::ToLocalMap(*scan.local_map,
                                          {.utime = scan.utime, .scan_id = scan.scan_id},
                                          runtime.MaxMessageBytes(kLocalMap.bus)));
  }
  if (config_.removed_points) {
    companions_.Send(kRemovedPoints,
                     messages::ToRemovedPoints(scan, runtime.MaxMessageBytes(kRemovedPoints.bus)));
  }
}

void PreprocessorProcess::SetCounters() {
  input_.SetCounters();
  if (!map_client_) return;
  map_client_->SetCounters();
  node_.SetCounter("poses_out_of_order", pose_trust_.out_of_order());
  if (!last_) return;
  using core::MapVerdict;
  for (const auto& [name, verdict] : {std::pair("points_explained", MapVerdict::kExplained),
                                      std::pair("points_unexplained", MapVerdict::kUnexplained),
                                      std::pair("points_unknown_cell", MapVerdict::kUnknown),
                                      std::pair("points_off_map", MapVerdict::kOffMap),
                                      std::pair("points_out_of_band", MapVerdict::kOutOfBand),
                                      std::pair("points_near", MapVerdict::kNear)}) {
    node_.SetCounter(name, static_cast<std::int64_t>(last_->counts.OfMap(verdict)));
  }
}

void PreprocessorProcess::Refresh() {
  SetCounters();
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
  if (companions_.BacklogUs() > kSlowBusUs) {
    return {status_t::STATE_DEGRADED,
            true,
            "OBSTACLE_POINTS are late by " + std::to_string(companions_.BacklogUs() / 1000) +
                " ms: too many points for the shared bus's max_message_bytes and "
                "burst_interval_ms"};
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
  const std::string map_trouble = MapTrouble();
  if (!map_trouble.empty()) return {status_t::STATE_DEGRADED, true, map_trouble};
  return {status_t::STATE_OK, true, "working"};
}

std::string PreprocessorProcess::MapTrouble() const {
  const std::string nothing_removed = "the map filter removes nothing: ";
  switch (last_->map_state) {
    case core::MapState::kOff:
    case core::MapState::kFiltered:
      return {};
    case core::MapState::kNoMap: {
      const std::string trouble = map_client_->Trouble();
      return nothing_removed + (trouble.empty() ? "the map has only just come" : trouble);
    }
    case core::MapState::kNoPose:
      return nothing_removed + "no POSE for the time of the scan";
    case core::MapState::kPoseOld:
      return nothing_removed + "the newest POSE is older than pose.max_extrapolation_ms";
    case core::MapState::kPoseLost:
      return nothing_removed + (PoseDoubt() == core::PoseTrust::Doubt::kTwoSources
                                    ? "POSE has two publishers"
                                    : "POSE_STATUS says that the pose is lost");
    case core::MapState::kOutsideMap:
      break;
  }
  return "most points lie off the map or in unknown cells, and are kept: is the pose right, and "
         "the map that of this place?";
}

}  // namespace clearway
