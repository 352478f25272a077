// SPDX-License-Identifier: BSD-3-Clause
#include "processes/simulator/emulated_sensor.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "common/core/simulation/noise.hpp"
#include "common/process/log.hpp"

namespace clearway {
namespace {

using core::EmulatedMid70;
using core::Silenced;
using core::livox::kShotPeriod_us;

constexpr std::int64_t kTick_us = 1'000;
constexpr std::int64_t kNsPerUs = 1'000;
constexpr std::int64_t kLongestLag_us = 50'000;
constexpr std::int64_t kRetry_us = 1'000'000;
constexpr std::int64_t kSlowReading_us = 20;
// Real ones of this family send their points from here.
constexpr std::uint16_t kDataSourcePort = 60001;

core::EmulatedMid70Config DeviceConfigOf(const core::EmulatedSensorConfig& config) {
  return {.broadcast_code = config.broadcast_code,
          .announce_to = {*core::ParseIpv4(config.broadcast_to),
                          static_cast<std::uint16_t>(config.broadcast_port)},
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

// What happens once is done in order of time, whatever the order in the file.
core::EmulatedSensorConfig InOrder(core::EmulatedSensorConfig config) {
  const auto sort = [](auto& events) {
    std::stable_sort(
        events.begin(), events.end(), [](const auto& a, const auto& b) { return a.at_s < b.at_s; });
  };
  sort(config.clock_steps);
  sort(config.address_changes);
  return config;
}

std::int64_t ToUs(double seconds) {
  return std::llround(seconds * 1e6);
}

template <typename Events>
bool AnyHolds(const Events& events, std::int64_t now_us) {
  return std::any_of(events.begin(), events.end(), [now_us](const auto& event) {
    return event.times.Hold(now_us);
  });
}

}  // namespace

EmulatedSensor::EmulatedSensor(const core::EmulatedSensorConfig& config,
                               std::uint64_t seed,
                               process::Runtime& runtime,
                               net::Network& network,
                               Fire fire)
    : config_(InOrder(config)),
      runtime_(runtime),
      network_(network),
      fire_(std::move(fire)),
      start_us_(runtime.MonotonicUs()),
      utime_minus_true_us_(runtime.UtimeNow()),
      device_(DeviceConfigOf(config), MemoryOf(config), 0),
      clock_(config.clock_drift_ppm, ToUs(config.uptime_s)),
      faults_(config.network_faults, seed) {
  is_on_ = HasPower(0);
  if (is_on_) OpenSockets();
  timer_ = runtime_.Every(kTick_us, [this] { Tick(); });
}

EmulatedSensor::~EmulatedSensor() {
  runtime_.Cancel(timer_);
  if (flush_due_us_) runtime_.Cancel(flush_timer_);
}

EmulatedSensorCounts EmulatedSensor::counts() const {
  EmulatedSensorCounts counts = counts_;
  const core::PacketFaults::Counts& faults = faults_.counts();
  counts.lost = faults.lost;
  counts.duplicates = faults.duplicates;
  counts.reordered = faults.reordered;
  counts.control_lost = faults.control_lost;
  counts.under_way = static_cast<std::int64_t>(faults_.size());
  return counts;
}

bool EmulatedSensor::HasPower(std::int64_t now_us) const {
  return !AnyHolds(config_.power_cuts, now_us);
}

void EmulatedSensor::OpenSockets() {
  CloseSockets();
  bound_ip_ = device_.ip();
  command_socket_ =
      network_.Open({.bind = {bound_ip_, core::livox::kDevicePort}, .can_broadcast = true},
                    [this](std::span<const net::Datagram> datagrams) { OnCommands(datagrams); });
  data_socket_ =
      network_.Open({.bind = {bound_ip_, kDataSourcePort}}, [](std::span<const net::Datagram>) {});
}

// Its address may come from a host's command: one that cannot be had must not end the simulator.
void EmulatedSensor::TryOpenSockets(std::int64_t now_us) {
  if (now_us < next_try_us_ && bound_ip_ == device_.ip()) return;
  next_try_us_ = now_us + kRetry_us;
  try {
    OpenSockets();
    problem_.clear();
  } catch (const net::NetworkError& error) {
    CloseSockets();
    if (problem_ != error.what()) process::LogError(config_.sensor + ": " + error.what());
    problem_ = error.what();
  }
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

void EmulatedSensor::Tick() {
  const std::int64_t now_us = Now();
  MeasureUtime();
  FollowPower(now_us);
  FollowSchedule(now_us);
  if (!is_on_) return;
  const auto outgoing = device_.Advance(now_us);
  FollowRestart();
  if (!command_socket_ || !data_socket_ || bound_ip_ != device_.ip()) TryOpenSockets(now_us);
  SendControl(outgoing, now_us);
  SendPackets(now_us);
  Flush();
}

// The time of day may be slewed. A reading that was interrupted is worse than an old one.
void EmulatedSensor::MeasureUtime() {
  const std::int64_t before_us = Now();
  const std::int64_t utime = runtime_.UtimeNow();
  const std::int64_t after_us = Now();
  if (after_us - before_us > kSlowReading_us) return;
  utime_minus_true_us_ = utime - before_us - (after_us - before_us) / 2;
}

void EmulatedSensor::FollowPower(std::int64_t now_us) {
  const bool has_power = HasPower(now_us);
  if (is_on_ && !has_power) {
    CloseSockets();
    faults_.DropAll();
    problem_.clear();
  }
  if (!is_on_ && has_power) {
    device_.PowerCycle(now_us);
    next_try_us_ = now_us;
  }
  is_on_ = has_power;
}

// A restart begins the clock anew.
void EmulatedSensor::FollowRestart() {
  if (device_.started_us() == last_start_us_) return;
  last_start_us_ = device_.started_us();
  clock_.Restart(last_start_us_);
  next_oscillator_ns_ = -1;
}

// Clock, address and status, as the configuration has them at this moment.
void EmulatedSensor::FollowSchedule(std::int64_t now_us) {
  FollowRestart();
  while (num_clock_steps_ < config_.clock_steps.size() &&
         now_us >= ToUs(config_.clock_steps[num_clock_steps_].at_s)) {
    const core::ClockStepConfig& step = config_.clock_steps[num_clock_steps_++];
    if (step.reset) {
      clock_.ResetStamps(now_us);
    } else {
      clock_.Step(ToUs(step.step_s));
    }
  }
  while (num_address_changes_ < config_.address_changes.size() &&
         now_us >= ToUs(config_.address_changes[num_address_changes_].at_s)) {
    const std::string& ip = config_.address_changes[num_address_changes_++].ip;
    device_.ChangeAddress(*core::ParseIpv4(ip), now_us);
  }
  device_.SetStatus(StatusAt(now_us));
}

core::EmulatedTimeSync EmulatedSensor::SyncAt(std::int64_t now_us) const {
  if (AnyHolds(config_.time_sync_losses, now_us)) return {};
  return {.source = config_.time_sync, .error_us = config_.time_sync_error_us};
}

core::livox::DeviceStatus EmulatedSensor::StatusAt(std::int64_t now_us) const {
  using core::livox::TimestampType;
  core::livox::DeviceStatus status;
  const TimestampType source = SyncAt(now_us).source;
  status.ptp_present = source == TimestampType::kPtp;
  status.pps_present = source == TimestampType::kGps || source == TimestampType::kPps;
  if (source == TimestampType::kPtp) status.time_sync = core::livox::TimeSync::kPtp;
  if (source == TimestampType::kGps) status.time_sync = core::livox::TimeSync::kGps;
  if (source == TimestampType::kPps) status.time_sync = core::livox::TimeSync::kPps;
  for (const core::StatusFaultConfig& fault : config_.status_faults) {
    if (fault.times.Hold(now_us)) status = fault.AddTo(status);
  }
  return status;
}

void EmulatedSensor::OnCommands(std::span<const net::Datagram> datagrams) {
  const std::int64_t now_us = Now();
  for (const net::Datagram& datagram : datagrams) {
    if (IsSilent(Silenced::kAll, now_us) || faults_.LosesControl(now_us)) continue;
    const auto utc_before = device_.utc();
    const auto answers = device_.Receive(datagram.from, datagram.bytes, now_us);
    const auto& utc = device_.utc();
    const bool is_told = utc && (!utc_before || utc_before->told_us != utc->told_us);
    if (is_told) clock_.SetUtc(utc->utc_ns, utc->told_us);
    SendControl(answers, now_us);
  }
}

void EmulatedSensor::SendControl(const std::vector<EmulatedMid70::Outgoing>& outgoing,
                                 std::int64_t now_us) {
  for (const EmulatedMid70::Outgoing& out : outgoing) {
    const bool is_heartbeat = out.code == core::livox::CommandCode::kHeartbeat;
    if (IsSilent(is_heartbeat ? Silenced::kHeartbeats : Silenced::kAll, now_us)) continue;
    if (!command_socket_ || faults_.LosesControl(now_us)) continue;
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
  const std::int64_t duration_ns = shots * kShotPeriod_us * kNsPerUs;
  if (next_oscillator_ns_ < 0) {
    // The pattern goes on with the oscillator, whether or not anybody listens.
    const std::int64_t packet = clock_.OscillatorNs(now_us) / duration_ns;
    next_oscillator_ns_ = (packet + 1) * duration_ns;
  }
  while (clock_.TrueUs(next_oscillator_ns_ + duration_ns) <= now_us) {
    const std::int64_t begin_us = clock_.TrueUs(next_oscillator_ns_);
    if (begin_us < now_us - kLongestLag_us) {
      ++counts_.skipped;
    } else {
      MakePacket(*sampling, begin_us, now_us);
    }
    next_oscillator_ns_ += duration_ns;
  }
}

void EmulatedSensor::MakePacket(const EmulatedMid70::Sampling& sampling,
                                std::int64_t begin_us,
                                std::int64_t now_us) {
  const core::livox::DataLayout layout = core::livox::LayoutOf(sampling.data_type);
  shots_.assign(layout.shots_in_packet, {});
  const std::int64_t first_shot = next_oscillator_ns_ / (kShotPeriod_us * kNsPerUs);
  fire_(first_shot, begin_us, device_.memory().return_mode, shots_);
  ++counts_.packets;
  if (IsSilent(Silenced::kData, begin_us)) {
    ++counts_.silenced;
    return;
  }
  points_.clear();
  for (const core::SimulatedShot& shot : shots_) {
    for (std::size_t echo = 0; echo < layout.echoes; ++echo) {
      points_.push_back(shot.echoes[echo].point_sensor);
    }
  }
  const core::EmulatedClock::Stamp stamp =
      clock_.StampAt(next_oscillator_ns_, SyncAt(begin_us), utime_minus_true_us_);
  const core::livox::DataHeader header{.slot_id = device_.memory().slot,
                                       .lidar_id = 1,
                                       .status_code = device_.status_code(),
                                       .timestamp_type = stamp.type,
                                       .data_type = sampling.data_type,
                                       .timestamp = stamp.timestamp};
  faults_.Put({sampling.to, core::livox::PackPacket(header, points_)}, now_us);
}

// What is due leaves now; what is held back has a timer of its own, since a tick is too coarse.
void EmulatedSensor::Flush() {
  const std::int64_t now_us = Now();
  while (const std::optional<core::PacketFaults::Packet> packet = faults_.Take(now_us)) {
    const bool is_sent = data_socket_ && data_socket_->Send(packet->to, packet->bytes);
    if (!is_sent) ++counts_.refused;
  }
  const std::optional<std::int64_t> due_us = faults_.NextDue();
  if (!due_us || (flush_due_us_ && *flush_due_us_ <= *due_us)) return;
  if (flush_due_us_) runtime_.Cancel(flush_timer_);
  flush_due_us_ = due_us;
  flush_timer_ = runtime_.After(*due_us - now_us, [this] {
    flush_due_us_.reset();
    Flush();
  });
}

}  // namespace clearway
