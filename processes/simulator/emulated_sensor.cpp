// SPDX-License-Identifier: BSD-3-Clause
#include "processes/simulator/emulated_sensor.hpp"

#include <algorithm>
#include <utility>

#include "common/core/simulation/noise.hpp"
#include "common/process/log.hpp"

namespace clearway {
namespace {

using core::EmulatedMid70;
using core::Endpoint;
using core::Silenced;
using core::livox::kShotPeriod_us;

constexpr std::int64_t kTick_us = 1'000;
constexpr std::int64_t kNsPerUs = 1'000;
constexpr std::int64_t kLongestLag_us = 50'000;
// Real ones of this family send their points from here.
constexpr std::uint16_t kDataSourcePort = 60001;

core::EmulatedMid70Config DeviceConfigOf(const core::EmulatedSensorConfig& config) {
  return {.broadcast_code = config.broadcast_code,
          .announce_to = {*core::ParseIpv4(config.broadcast_to), core::livox::kBroadcastPort},
          .boot_us = config.boot_us,
          .start_up_us = config.start_up_us,
          .host_timeout_us = config.host_timeout_us,
          .lets_others_take_over = config.lets_others_take_over};
}

core::EmulatedMid70Memory MemoryOf(const core::EmulatedSensorConfig& config) {
  core::EmulatedMid70Memory memory;
  memory.ip = *core::ParseIpv4(config.ip);
  return memory;
}

}  // namespace

EmulatedSensor::EmulatedSensor(const core::EmulatedSensorConfig& config,
                               std::uint64_t seed,
                               process::Runtime& runtime,
                               net::Network& network,
                               Fire fire)
    : config_(config),
      seed_(seed),
      runtime_(runtime),
      network_(network),
      fire_(std::move(fire)),
      start_us_(runtime.MonotonicUs()),
      utime_minus_true_us_(runtime.UtimeNow()),
      device_(DeviceConfigOf(config), MemoryOf(config), 0),
      clock_(config.clock_drift_ppm, static_cast<std::int64_t>(config.uptime_s * 1e6)) {
  OpenSockets();
  timer_ = runtime_.Every(kTick_us, [this] { Tick(); });
}

EmulatedSensor::~EmulatedSensor() {
  runtime_.Cancel(timer_);
}

void EmulatedSensor::OpenSockets() {
  command_socket_ =
      network_.Open({.bind = {device_.ip(), core::livox::kDevicePort}, .can_broadcast = true},
                    [this](std::span<const net::Datagram> datagrams) { OnCommands(datagrams); });
  data_socket_ = network_.Open({.bind = {device_.ip(), kDataSourcePort}},
                               [](std::span<const net::Datagram>) {});
}

void EmulatedSensor::CloseSockets() {
  command_socket_.reset();
  data_socket_.reset();
}

bool EmulatedSensor::IsSilent(Silenced what, std::int64_t now_us) const {
  return std::any_of(config_.silences.begin(), config_.silences.end(), [&](const auto& silence) {
    return silence.times.Hold(now_us) && (silence.what == Silenced::kAll || silence.what == what);
  });
}

double EmulatedSensor::NextRandom() {
  const std::uint64_t bits = core::SplitMix64(core::SplitMix64(seed_) ^ num_random_++);
  return static_cast<double>(bits >> 11U) * 0x1.0p-53;
}

void EmulatedSensor::Tick() {
  const std::int64_t now_us = Now();
  FollowSchedule(now_us);
  if (!is_on_) return;
  SendControl(device_.Advance(now_us), now_us);
  if (device_.started_us() != last_start_us_) {  // A reboot.
    last_start_us_ = device_.started_us();
    clock_.Restart(last_start_us_);
    next_oscillator_ns_ = -1;
  }
  SendPackets(now_us);
}

// Power, clock, address and status, as the configuration has them at this moment.
void EmulatedSensor::FollowSchedule(std::int64_t now_us) {
  const bool has_power = std::none_of(config_.power_cuts.begin(),
                                      config_.power_cuts.end(),
                                      [&](const auto& cut) { return cut.times.Hold(now_us); });
  if (is_on_ && !has_power) CloseSockets();
  if (!is_on_ && has_power) {
    device_.PowerCycle(now_us);
    OpenSockets();
  }
  is_on_ = has_power;
  const auto is_due = [now_us](double at_s) { return static_cast<double>(now_us) >= at_s * 1e6; };
  while (num_clock_steps_ < config_.clock_steps.size() &&
         is_due(config_.clock_steps[num_clock_steps_].at_s)) {
    clock_.Step(static_cast<std::int64_t>(config_.clock_steps[num_clock_steps_].step_s * 1e6));
    ++num_clock_steps_;
  }
  while (num_address_changes_ < config_.address_changes.size() &&
         is_due(config_.address_changes[num_address_changes_].at_s)) {
    device_.ChangeAddress(*core::ParseIpv4(config_.address_changes[num_address_changes_].ip),
                          now_us);
    ++num_address_changes_;
    if (!is_on_) continue;
    CloseSockets();
    OpenSockets();
  }
  core::livox::DeviceStatus status;
  for (const core::StatusFaultConfig& fault : config_.status_faults) {
    if (fault.times.Hold(now_us)) status = fault.Status();
  }
  device_.SetStatus(status);
}

void EmulatedSensor::OnCommands(std::span<const net::Datagram> datagrams) {
  const std::int64_t now_us = Now();
  for (const net::Datagram& datagram : datagrams) {
    if (IsSilent(Silenced::kAll, now_us)) continue;
    const auto utc_before = device_.utc();
    SendControl(device_.Receive(datagram.from, datagram.bytes, now_us), now_us);
    const auto& utc = device_.utc();
    const bool is_told = utc && (!utc_before || utc_before->told_us != utc->told_us);
    if (is_told) clock_.SetUtc(utc->utc_ns, utc->told_us);
  }
}

void EmulatedSensor::SendControl(const std::vector<EmulatedMid70::Outgoing>& outgoing,
                                 std::int64_t now_us) {
  for (const EmulatedMid70::Outgoing& out : outgoing) {
    const bool is_heartbeat = out.code == core::livox::CommandCode::kHeartbeat;
    if (IsSilent(is_heartbeat ? Silenced::kHeartbeats : Silenced::kAll, now_us)) continue;
    command_socket_->Send(out.to, out.bytes);
  }
}

void EmulatedSensor::SendPackets(std::int64_t now_us) {
  const std::optional<EmulatedMid70::Sampling> sampling = device_.sampling(now_us);
  if (!sampling) {
    next_oscillator_ns_ = -1;
    return;
  }
  const auto shots =
      static_cast<std::int64_t>(core::livox::LayoutOf(sampling->data_type).shots_in_packet);
  const std::int64_t duration_us = shots * kShotPeriod_us;
  if (next_oscillator_ns_ < 0) {
    // The pattern goes on with the oscillator, whether or not anybody listens.
    const std::int64_t shot = clock_.OscillatorNs(now_us) / (kShotPeriod_us * kNsPerUs);
    next_oscillator_ns_ = shot * kShotPeriod_us * kNsPerUs;
  }
  while (true) {
    const std::int64_t begin_us = clock_.TrueUs(next_oscillator_ns_);
    if (begin_us + duration_us > now_us) break;
    if (begin_us < now_us - kLongestLag_us) {
      ++counts_.skipped;
    } else {
      MakePacket(*sampling, begin_us);
    }
    next_oscillator_ns_ += duration_us * kNsPerUs;
  }
}

void EmulatedSensor::MakePacket(const EmulatedMid70::Sampling& sampling, std::int64_t begin_us) {
  const core::livox::DataLayout layout = core::livox::LayoutOf(sampling.data_type);
  shots_.assign(layout.shots_in_packet, {});
  const std::int64_t first_shot = next_oscillator_ns_ / (kShotPeriod_us * kNsPerUs);
  fire_(first_shot, begin_us, device_.memory().return_mode, shots_);
  points_.clear();
  for (const core::SimulatedShot& shot : shots_) {
    for (std::size_t echo = 0; echo < layout.echoes; ++echo) {
      points_.push_back(shot.echoes[echo].point_sensor);
    }
  }
  const core::EmulatedTimeSync sync{.source = config_.time_sync,
                                    .error_us = config_.time_sync_error_us};
  const core::EmulatedClock::Stamp stamp =
      clock_.StampAt(next_oscillator_ns_, sync, utime_minus_true_us_);
  ++counts_.packets;
  SendData(sampling.to,
           core::livox::PackPacket({.slot_id = device_.memory().slot,
                                    .lidar_id = 1,
                                    .status_code = device_.status_code(),
                                    .timestamp_type = stamp.type,
                                    .data_type = sampling.data_type,
                                    .timestamp = stamp.timestamp},
                                   points_),
           begin_us);
}

void EmulatedSensor::SendData(const Endpoint& to, core::livox::Bytes packet, std::int64_t now_us) {
  if (IsSilent(Silenced::kData, now_us)) {
    ++counts_.silenced;
    return;
  }
  const auto fault = std::find_if(config_.network_faults.begin(),
                                  config_.network_faults.end(),
                                  [&](const auto& each) { return each.times.Hold(now_us); });
  if (fault == config_.network_faults.end()) {
    Deliver(to, std::move(packet), 0);
    return;
  }
  if (NextRandom() < fault->loss) {
    ++counts_.lost;
    return;
  }
  std::int64_t delay_us = 0;
  if (fault->jitter_us > 0) {
    delay_us = static_cast<std::int64_t>(NextRandom() * static_cast<double>(fault->jitter_us));
    const std::int64_t due_us = std::max(last_due_us_, Now() + delay_us);
    last_due_us_ = due_us;
    delay_us = due_us - Now();
  }
  if (NextRandom() < fault->reorder) {
    ++counts_.reordered;
    delay_us += fault->reorder_us;
  }
  if (NextRandom() < fault->duplicates) {
    ++counts_.duplicates;
    Deliver(to, packet, delay_us + kTick_us);
  }
  Deliver(to, std::move(packet), delay_us);
}

void EmulatedSensor::Deliver(const Endpoint& to, core::livox::Bytes packet, std::int64_t delay_us) {
  if (delay_us <= 0) {
    if (data_socket_) data_socket_->Send(to, packet);
    return;
  }
  runtime_.After(delay_us,
                 [this, to, bytes = std::move(packet), alive = std::weak_ptr<int>(alive_)] {
                   if (alive.lock() && data_socket_) data_socket_->Send(to, bytes);
                 });
}

}  // namespace clearway
