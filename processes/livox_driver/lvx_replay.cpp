// SPDX-License-Identifier: BSD-3-Clause
#include "processes/livox_driver/lvx_replay.hpp"

#include <algorithm>

#include "common/process/log.hpp"
#include "processes/livox_driver/livox_driver_process.hpp"

namespace clearway {
namespace {

using core::livox::DataPacket;
using core::livox::TimestampType;

constexpr std::int64_t kStep_us = 5'000;
// Packets in a row when as fast as it goes, so that the bus and signals get their turn.
constexpr int kPacketsInARow = 64;
// Stamps that jump by more than this began anew: the recording goes on at once.
constexpr std::int64_t kLongestGap_ns = 2'000'000'000;

std::int64_t StampNs(const DataPacket& packet) {
  if (packet.header.timestamp_type == TimestampType::kGps) {
    if (const auto utc_ns = core::livox::GpsUtcNs(packet.header.timestamp)) return *utc_ns;
  }
  return static_cast<std::int64_t>(packet.header.timestamp);
}

std::int64_t DurationUs(const DataPacket& packet) {
  return static_cast<std::int64_t>(packet.shots) * core::livox::kShotPeriod_us;
}

}  // namespace

LvxReplay::LvxReplay(const core::livox::DriverConfig& config,
                     const core::VehicleConfig& vehicle,
                     const LvxReplaySettings& settings,
                     process::Node& node,
                     std::function<void()> on_done)
    : config_(config),
      settings_(settings),
      node_(node),
      on_done_(std::move(on_done)),
      reader_(std::make_unique<io::LvxReader>(settings.file)) {
  CheckSensors(config, vehicle);
  for (const core::livox::LidarConfig& lidar : config_.lidars) {
    outputs_.push_back(std::make_unique<LidarOutput>(config_, lidar, node_));
  }
  AssignDevices();
  process::Runtime& runtime = node_.runtime();
  start_utime_ = played_utime_ = runtime.UtimeNow();
  start_us_ = runtime.MonotonicUs();
  for (auto& [index, track] : tracks_) track.utime = start_utime_;
  node_.BeforeStatus([this] { Refresh(); });
  Refresh();
  runtime.After(0, [this] { Step(); });
}

void LvxReplay::AssignDevices() {
  const std::vector<io::LvxDevice>& devices = reader_->header().devices;
  std::vector<bool> is_taken(outputs_.size(), false);
  const auto assign = [&](const io::LvxDevice& device, const auto& fits) {
    for (std::size_t i = 0; i < outputs_.size(); ++i) {
      if (is_taken[i] || !fits(config_.lidars[i])) continue;
      is_taken[i] = true;
      tracks_[device.index].output = outputs_[i].get();
      return;
    }
  };
  for (const io::LvxDevice& device : devices) {
    tracks_[device.index] = {};
    assign(device, [&](const auto& lidar) { return lidar.broadcast_code == device.lidar_code; });
  }
  for (const io::LvxDevice& device : devices) {
    Track& track = tracks_[device.index];
    if (track.output == nullptr) assign(device, [](const auto&) { return true; });
    if (track.output != nullptr) continue;
    unused_ += (unused_.empty() ? "" : ", ") + device.lidar_code;
  }
  if (!unused_.empty()) {
    process::LogWarning(settings_.file.string() + ": no livox_driver.lidar left for " + unused_);
  }
}

// When the packet is full, on the time that is played.
std::int64_t LvxReplay::DueUtime(const DataPacket& packet, Track& track) const {
  const std::int64_t stamp_ns = StampNs(packet);
  const std::int64_t step_ns = track.last_stamp_ns ? stamp_ns - *track.last_stamp_ns : 0;
  if (step_ns > 0 && step_ns <= kLongestGap_ns) {
    track.utime += step_ns / 1000;
  } else if (track.last_stamp_ns) {
    track.utime = std::max(track.utime, played_utime_);
  }
  track.last_stamp_ns = stamp_ns;
  return track.utime + DurationUs(packet);
}

void LvxReplay::Step() {
  process::Runtime& runtime = node_.runtime();
  const bool is_fast = settings_.speed <= 0.0;
  const auto elapsed_us = static_cast<double>(runtime.MonotonicUs() - start_us_);
  const std::int64_t until_utime =
      start_utime_ + static_cast<std::int64_t>(elapsed_us * settings_.speed);
  for (int n = 0; !is_done_ && (!is_fast || n < kPacketsInARow); ++n) {
    if (!waiting_) {
      waiting_ = reader_->Next();
      if (!waiting_) {
        Finish();
        break;
      }
      const core::livox::ParsedPacket parsed = core::livox::ParsePacket(waiting_->packet);
      Track& track = tracks_[waiting_->device_index];
      waiting_utime_ = parsed.packet ? DueUtime(*parsed.packet, track) : played_utime_;
    }
    if (!is_fast && waiting_utime_ > until_utime) break;
    Play(*waiting_);
    waiting_.reset();
  }
  if (!is_fast) played_utime_ = std::max(played_utime_, until_utime);
  for (const auto& output : outputs_) output->PublishDue(played_utime_);
  if (!is_done_) runtime.After(is_fast ? 0 : kStep_us, [this] { Step(); });
}

void LvxReplay::Play(const io::LvxPackage& package) {
  ++packages_;
  played_utime_ = std::max(played_utime_, waiting_utime_);
  LidarOutput* const output = tracks_[package.device_index].output;
  if (output == nullptr) return;
  output->OnPacket(package.packet, waiting_utime_);
  output->PublishDue(played_utime_);
}

void LvxReplay::Finish() {
  if (settings_.loop && packages_ > 0) {
    reader_ = std::make_unique<io::LvxReader>(settings_.file);
    return;
  }
  is_done_ = true;
  // Nothing will come that a slice could wait for.
  for (const auto& output : outputs_) {
    output->PublishDue(played_utime_ + 10 * config_.scan_period_us);
  }
  Refresh();
  on_done_();
}

void LvxReplay::Refresh() {
  for (const auto& output : outputs_) output->SetCounters();
  const io::LvxReport& report = reader_->report();
  node_.SetCounter("replay_packages", packages_);
  node_.SetCounter("replay_foreign_types", report.foreign_types);
  node_.SetCounter("replay_unknown_devices", report.unknown_devices);
  node_.SetCounter("replay_damages", report.damages);
  std::string text = (is_done_ ? "replayed " : "replays ") + settings_.file.filename().string() +
                     ", " + std::to_string(packages_) + " packets";
  if (!unused_.empty()) text += "; not used: " + unused_;
  if (report.damages > 0) text += "; damaged: " + report.first_problem;
  if (report.cut_at) text += "; " + report.cut;
  const bool is_odd = report.damages > 0 || report.cut_at.has_value();
  node_.SetState({is_done_ ? status_t::STATE_DONE
                  : is_odd ? status_t::STATE_DEGRADED
                           : status_t::STATE_OK,
                  true,
                  text});
}

}  // namespace clearway
