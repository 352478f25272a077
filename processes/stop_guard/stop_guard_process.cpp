// SPDX-License-Identifier: BSD-3-Clause
#include "processes/stop_guard/stop_guard_process.hpp"

#include <cmath>
#include <string>

#include "common/messages/drive_permit.hpp"
#include "common/messages/lidar_points.hpp"

namespace clearway {
namespace {

using messages::channels::kDetections;
using messages::channels::kDrivePermit;
using messages::channels::kLidarPoints;
using messages::channels::kOdometry;

constexpr std::int64_t kPermitValidUs = 100'000;

bool IsStricter(const core::Permit& now, const drive_permit_t& published) {
  return now.forward_mps() < published.forward_mps || now.backward_mps() < published.backward_mps ||
         now.turn_left_radps() < published.turn_left_radps ||
         now.turn_right_radps() < published.turn_right_radps;
}

}  // namespace

StopGuardProcess::StopGuardProcess(const core::StopGuardConfig& config,
                                   const core::VehicleConfig& vehicle,
                                   process::Node& node)
    : vehicle_(vehicle), node_(node), guard_(config, vehicle) {
  process::Runtime& runtime = node_.runtime();
  node_.Subscribe<lidar_points_t>(kLidarPoints, [this](const auto& m) { OnLidarPoints(m); });
  node_.Subscribe<detections_t>(kDetections, [this, &runtime](const detections_t& m) {
    guard_.OnDetections(m.utime, runtime.MonotonicUs());
  });
  if (!vehicle_.stationary) {
    node_.Subscribe<odometry_t>(kOdometry, [this, &runtime](const odometry_t& m) {
      guard_.OnOdometry(m.v_mps, m.w_radps, runtime.MonotonicUs());
    });
  }
  node_.BeforeStatus([this] { Refresh(); });
  runtime.Every(static_cast<std::int64_t>(std::llround(1e6 / config.permit_rate_hz)),
                [this, &runtime] { PublishPermit(guard_.PermitAt(runtime.MonotonicUs())); });
  Refresh();
}

void StopGuardProcess::OnLidarPoints(const lidar_points_t& message) {
  const std::int64_t begin_us = node_.runtime().MonotonicUs();
  const core::Slice slice =
      messages::FromLcm(message, vehicle_.FindSensor(message.sensor).value_or(-1));
  guard_.OnSlice(slice, begin_us);
  if (slice.sensor < 0 || !core::IsValid(slice)) return;
  const core::Permit permit = guard_.PermitAt(begin_us);
  const std::int64_t duration_us = node_.runtime().MonotonicUs() - begin_us;
  node_.AddProcessingTime(duration_us);
  slice_sensor_ = message.sensor;
  slice_scan_id_ = message.scan_id;
  slice_index_ = message.slice_index;
  slice_processing_us_ = static_cast<std::int32_t>(duration_us);
  slice_arrival_us_ = begin_us;
  // What forbids is not kept waiting for the timer.
  if (IsStricter(permit, last_)) PublishPermit(permit);
}

void StopGuardProcess::PublishPermit(const core::Permit& permit) {
  const std::int64_t now_us = node_.runtime().MonotonicUs();
  drive_permit_t message = messages::ToLcm(permit);
  message.utime = node_.runtime().UtimeNow();
  message.valid_us = kPermitValidUs;
  message.text = messages::ReasonText(permit.reason);
  if (permit.sensor >= 0) {
    message.text += ": " + vehicle_.sensors[static_cast<std::size_t>(permit.sensor)].name;
  }
  message.slice_sensor = slice_sensor_;
  message.slice_scan_id = slice_scan_id_;
  message.slice_index = slice_index_;
  message.input_age_us = slice_arrival_us_ < 0 ? -1 : now_us - slice_arrival_us_;
  message.input_lateness_us =
      slice_arrival_us_ < 0 ? -1 : guard_.sensor_watch(0).Freshness(now_us).lateness_us;
  message.processing_us = slice_processing_us_;
  const bool reason_changed = message.reason != last_.reason;
  last_ = message;
  node_.Publish(kDrivePermit, std::move(message));
  if (reason_changed) Refresh();
}

void StopGuardProcess::Refresh() {
  const core::StopGuardCounts& counts = guard_.counts();
  node_.SetCounter("slices", counts.slices);
  node_.SetCounter("slices_unknown_sensor", counts.unknown_sensor);
  node_.SetCounter("slices_invalid", counts.invalid_slices);
  node_.SetCounter("returns", counts.returns);
  node_.SetCounter("obstacle_points", counts.obstacle_points);
  node_.SetCounter("hole_points", counts.hole_points);
  node_.SetCounter("odometry_invalid", counts.invalid_odometry);
  const core::Permit permit = guard_.PermitAt(node_.runtime().MonotonicUs());
  std::int8_t state = status_t::STATE_OK;
  if (permit.is_closed()) {
    state = status_t::STATE_WAITING;
  } else if (permit.detections_missing) {
    state = status_t::STATE_DEGRADED;
  }
  const char* const text = permit.detections_missing && !permit.is_closed()
                               ? "DETECTIONS are missing: speed is limited"
                               : messages::ReasonText(permit.reason);
  node_.SetState({state, true, text});
}

}  // namespace clearway
