// SPDX-License-Identifier: BSD-3-Clause
#include "processes/livox_driver/lidar_output.hpp"

#include <cmath>

#include "common/messages/lidar_points.hpp"

namespace clearway {
namespace {

using core::livox::PacketDefect;
using core::livox::ReturnMode;
using core::livox::TimeSource;
using messages::channels::kLidarPoints;

core::livox::StreamConfig StreamConfigOf(const core::livox::DriverConfig& driver,
                                         process::Runtime& runtime) {
  const std::size_t bytes = runtime.MaxMessageBytes(kLidarPoints.bus);
  return {.scan_period_us = driver.scan_period_us,
          .slice_us = driver.slice_us,
          .slice_grace_us = driver.slice_grace_us,
          .max_points = static_cast<int>((bytes - messages::kLidarHeaderBytes) /
                                         messages::kLidarBytesPerPoint),
          .clock = {.max_error_us = driver.max_clock_error_us}};
}

std::int8_t ReturnModeOnWire(bool is_dual, ReturnMode asked_for) {
  if (is_dual) return lidar_points_t::RETURN_DUAL;
  if (asked_for == ReturnMode::kFirst) return lidar_points_t::RETURN_SINGLE_FIRST;
  if (asked_for == ReturnMode::kStrongest) return lidar_points_t::RETURN_SINGLE_STRONGEST;
  return lidar_points_t::RETURN_UNKNOWN;
}

}  // namespace

LidarOutput::LidarOutput(const core::livox::DriverConfig& driver,
                         const core::livox::LidarConfig& lidar,
                         process::Node& node)
    : lidar_(lidar), node_(node), stream_(StreamConfigOf(driver, node.runtime())) {}

std::optional<std::uint32_t> LidarOutput::OnPacket(core::livox::ByteView datagram,
                                                   std::int64_t arrival_utime) {
  const core::livox::ParsedPacket parsed = core::livox::ParsePacket(datagram);
  ++defects_[static_cast<std::size_t>(parsed.defect)];
  if (!parsed.packet) return std::nullopt;
  stream_.Add(*parsed.packet, arrival_utime);
  return parsed.packet->header.status_code;
}

void LidarOutput::PublishDue(std::int64_t now_utime) {
  for (const core::livox::StreamSlice& out : stream_.Take(now_utime)) {
    lidar_points_t message = messages::ToLcm(out.slice, lidar_.sensor);
    message.lost_packets = static_cast<std::int32_t>(out.lost_packets);
    message.time_source = static_cast<std::int8_t>(out.time_source);
    message.return_mode = ReturnModeOnWire(out.is_dual, lidar_.return_mode);
    node_.Publish(kLidarPoints, std::move(message));
  }
}

std::string LidarOutput::TimeText() const {
  const core::livox::DeviceClock& clock = stream_.clock();
  if (!clock.is_settled()) return "time not known yet";
  switch (clock.source()) {
    case TimeSource::kPtp:
      return "time by PTP";
    case TimeSource::kGps:
      return "time by GPS";
    case TimeSource::kHost:
      return "time by arrival";
    case TimeSource::kDevice:
    case TimeSource::kUnknown:
      break;
  }
  std::string text = "time by its own clock";
  if (const std::optional<double> drift = clock.drift_ppm()) {
    text += ", " + std::to_string(std::lround(*drift)) + " ppm";
  }
  return text;
}

void LidarOutput::SetCounters() const {
  const auto set = [this](const char* name, std::int64_t value) {
    node_.SetCounter(lidar_.sensor + '_' + name, value);
  };
  const core::livox::StreamCounts& counts = stream_.counts();
  set("packets", counts.packets);
  set("lost_packets", counts.lost_packets);
  set("duplicates", counts.duplicates);
  set("reordered", counts.reordered);
  set("late_packets", counts.late_packets);
  set("unfit_packets", counts.unfit_packets);
  set("pauses", counts.pauses);
  set("shots", counts.shots);
  set("zero_returns", counts.zero_returns);
  set("overflow_points", counts.overflow_points);
  set("slices", counts.slices);
  set("foreign_type", defects_[static_cast<std::size_t>(PacketDefect::kForeignType)]);
  std::int64_t broken = 0;
  for (std::size_t i = 1; i < defects_.size(); ++i) {
    if (i != static_cast<std::size_t>(PacketDefect::kForeignType)) broken += defects_[i];
  }
  set("broken_packets", broken);
  const core::livox::DeviceClock& clock = stream_.clock();
  set("time_source", static_cast<std::int64_t>(clock.source()));
  set("clock_residual_us", clock.residual_us());
  set("clock_resets", clock.resets());
  set("clock_steps", clock.steps());
  set("clock_implausible", clock.implausible());
  if (const std::optional<double> drift = clock.drift_ppm()) {
    set("clock_drift_ppb", std::llround(*drift * 1000.0));
  }
}

}  // namespace clearway
