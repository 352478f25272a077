// SPDX-License-Identifier: BSD-3-Clause
#include "common/core/livox/device_clock.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace clearway::core::livox {
namespace {

constexpr std::int64_t kNsPerUs = 1000;
constexpr std::int64_t kNsPerSecond = 1'000'000'000;
constexpr std::int64_t kStep_ns = DeviceClock::kStep_us * kNsPerUs;
// Later than this, a packet is no longer taken for one that waited.
constexpr double kMaxDelay_ns = 200e6;
// While settling, the delay of the first packets is not known to be small.
constexpr double kMaxSettlingError_ns = 1e9;
// A packet that old came late; one that is older belongs to another life of the clock.
constexpr std::int64_t kMaxLate_ns = kNsPerSecond;
constexpr double kSlewTime_ns = 200e6;
constexpr double kMaxSlew = 0.01;
constexpr int kLot = 32;
constexpr std::int64_t kIgnoredLag_us = 2000;
constexpr double kNone = std::numeric_limits<double>::infinity();

std::int64_t Difference(std::uint64_t a, std::uint64_t b) {
  return static_cast<std::int64_t>(a - b);
}

bool HasAbsoluteTime(TimestampType type) {
  return type == TimestampType::kPtp || type == TimestampType::kGps;
}

}  // namespace

DeviceClock::DeviceClock(const ClockConfig& config) : config_(config) {}

void DeviceClock::Restart() {
  anchor_.reset();
  candidate_ = {};
  is_settled_ = false;
  believes_ = false;
  doubts_ = false;
  source_ = TimeSource::kUnknown;
  residual_us_ = 0;
  least_ns_ = {kNone, kNone};
}

std::uint64_t DeviceClock::CountOnPulses(std::uint64_t timestamp, std::int64_t arrival_ns) const {
  const auto phase_ns = static_cast<std::int64_t>(timestamp % kNsPerSecond);
  if (!anchor_ || newest_.type != TimestampType::kPps) {
    return static_cast<std::uint64_t>(kNsPerSecond + phase_ns);
  }
  const auto expected_ns =
      newest_.device_ns + static_cast<std::uint64_t>(arrival_ns - newest_.arrival_ns);
  // The stamp with this phase that is nearest to what is expected.
  std::int64_t ahead_ns =
      (phase_ns - static_cast<std::int64_t>(expected_ns % kNsPerSecond)) % kNsPerSecond;
  if (ahead_ns > kNsPerSecond / 2) ahead_ns -= kNsPerSecond;
  if (ahead_ns < -kNsPerSecond / 2) ahead_ns += kNsPerSecond;
  return expected_ns + static_cast<std::uint64_t>(ahead_ns);
}

DeviceClock::Observation DeviceClock::Interpret(TimestampType type,
                                                std::uint64_t timestamp,
                                                std::int64_t duration_us,
                                                std::int64_t arrival_utime) const {
  Observation seen{.type = type,
                   .device_ns = timestamp,
                   .sent_ns = (arrival_utime - duration_us) * kNsPerUs,
                   .arrival_ns = arrival_utime * kNsPerUs};
  if (type == TimestampType::kPps) seen.device_ns = CountOnPulses(timestamp, seen.arrival_ns);
  if (type == TimestampType::kGps) {
    const std::optional<std::int64_t> utc_ns = GpsUtcNs(timestamp);
    seen.is_device_stamp = utc_ns.has_value();
    seen.device_ns = static_cast<std::uint64_t>(utc_ns.value_or(seen.sent_ns));
  }
  return seen;
}

DelayEnvelope::Sample DeviceClock::ToSample(const Observation& seen) const {
  const std::int64_t stamp_ns = Difference(seen.device_ns, anchor_->device_ns);
  const auto elapsed = static_cast<std::uint64_t>(seen.sent_ns - anchor_->sent_ns);
  return {.stamp_ns = stamp_ns,
          .offset_ns = static_cast<std::int64_t>(elapsed - static_cast<std::uint64_t>(stamp_ns)),
          .arrival_ns = seen.arrival_ns};
}

bool DeviceClock::IsOtherClock(const Observation& seen) const {
  return seen.type != anchor_->type || seen.is_device_stamp != anchor_->is_device_stamp;
}

// What an undisturbed clock would not show.
bool DeviceClock::Surprises(const Observation& seen) const {
  if (IsOtherClock(seen)) return true;
  if (Difference(seen.device_ns, newest_.device_ns) < -kStep_ns) return true;
  const DelayEnvelope::Sample sample = ToSample(seen);
  const double above_ns = static_cast<double>(sample.offset_ns) - envelope_.At(sample.stamp_ns);
  if (!is_settled_) return std::abs(above_ns) > kMaxSettlingError_ns;
  return above_ns < static_cast<double>(-kStep_ns) || above_ns > kMaxDelay_ns;
}

// Nevertheless, a packet that came late is one of ours.
bool DeviceClock::IsUsable(const Observation& seen) const {
  if (IsOtherClock(seen)) return false;
  const DelayEnvelope::Sample sample = ToSample(seen);
  const double above_ns = static_cast<double>(sample.offset_ns) - envelope_.At(sample.stamp_ns);
  const std::int64_t ahead_ns = Difference(seen.device_ns, newest_.device_ns);
  if (ahead_ns < -kMaxLate_ns) return false;
  if (!is_settled_) return std::abs(above_ns) <= kMaxSettlingError_ns;
  return above_ns >= static_cast<double>(-kStep_ns);
}

bool DeviceClock::ConfirmsJump(const Observation& seen) {
  const auto agrees = [&] {
    const Observation& first = candidate_.first;
    if (seen.type != first.type || seen.is_device_stamp != first.is_device_stamp) return false;
    const std::int64_t stamps_ns = Difference(seen.device_ns, first.device_ns);
    const std::int64_t arrivals_ns = seen.arrival_ns - first.arrival_ns;
    return std::abs(static_cast<double>(arrivals_ns) - static_cast<double>(stamps_ns)) <
               static_cast<double>(kStep_ns) &&
           Difference(seen.device_ns, candidate_.newest.device_ns) > -kStep_ns;
  };
  if (candidate_.count == 0 || !agrees()) candidate_ = {.count = 0, .first = seen, .newest = seen};
  ++candidate_.count;
  if (Difference(seen.device_ns, candidate_.newest.device_ns) > 0) candidate_.newest = seen;
  if (candidate_.count < kConfirmPackets) return false;
  // A burst that waited somewhere shows one moment of arrival and many stamps.
  const std::int64_t stamps_ns =
      Difference(candidate_.newest.device_ns, candidate_.first.device_ns);
  const std::int64_t arrivals_ns = seen.arrival_ns - candidate_.first.arrival_ns;
  return stamps_ns > 0 && arrivals_ns >= stamps_ns / 2;
}

ClockEvent DeviceClock::NameJump(const Observation& seen) const {
  if (IsOtherClock(seen)) return ClockEvent::kSourceChanged;
  const bool counts_from_power_on = !HasAbsoluteTime(seen.type) && seen.type != TimestampType::kPps;
  const std::int64_t ahead_ns = Difference(seen.device_ns, newest_.device_ns);
  // Also forward: it runs for less time than nothing was heard of it. Where it just goes on, the
  // host's clock was set.
  const std::int64_t silence_ns = std::max<std::int64_t>(0, seen.arrival_ns - newest_.arrival_ns);
  const bool is_young = seen.device_ns <= static_cast<std::uint64_t>(silence_ns) &&
                        (ahead_ns > kMaxLate_ns || ahead_ns < -kMaxLate_ns);
  const bool went_back = ahead_ns < -kStep_ns;
  return counts_from_power_on && (went_back || is_young) ? ClockEvent::kReset
                                                         : ClockEvent::kStepped;
}

void DeviceClock::Count(ClockEvent event) {
  if (event == ClockEvent::kReset) ++resets_;
  if (event == ClockEvent::kStepped) ++steps_;
}

void DeviceClock::Begin(const Observation& seen) {
  if (anchor_ && IsOtherClock(seen)) doubts_ = false;
  anchor_ = seen;
  newest_ = seen;
  candidate_ = {};
  envelope_.Start(ToSample(seen));
  is_settled_ = false;
  num_packets_ = 1;
  knot_ns_ = 0;
  slew_ = 0.0;
  offset_ns_ = 0.0;
  residual_us_ = 0;
  least_ns_ = {kNone, kNone};
  num_in_lot_ = 0;
}

DeviceClock::Reading DeviceClock::Observe(TimestampType type,
                                          std::uint64_t timestamp,
                                          std::int64_t duration_us,
                                          std::int64_t arrival_utime) {
  const Observation seen = Interpret(type, timestamp, duration_us, arrival_utime);
  Reading reading{
      .device_ns = seen.device_ns, .is_usable = true, .is_device_stamp = seen.is_device_stamp};
  if (!anchor_) {
    reading.event = ClockEvent::kStarted;
    Begin(seen);
  } else if (!Surprises(seen)) {
    candidate_.count = 0;
    reading.event = Track(seen);
  } else if (ConfirmsJump(seen)) {
    reading.event = NameJump(seen);
    Begin(seen);
  } else {
    reading.is_usable = IsUsable(seen);
    if (reading.is_usable) NoteResidual(seen);
  }
  Count(reading.event);
  if (HasAbsoluteTime(type) && (!seen.is_device_stamp || (is_settled_ && !believes_))) {
    ++implausible_;
  }
  if (reading.is_usable) reading.utime_ns = ToHost(seen.device_ns);
  return reading;
}

ClockEvent DeviceClock::Track(const Observation& seen) {
  const DelayEnvelope::Sample sample = ToSample(seen);
  envelope_.Add(sample);
  NoteResidual(seen);
  ++num_packets_;
  if (Difference(seen.device_ns, newest_.device_ns) > 0) newest_ = seen;
  if (!is_settled_) {
    const std::int64_t waited_us = (seen.arrival_ns - anchor_->arrival_ns) / kNsPerUs;
    const bool is_enough = num_packets_ >= kSettlePackets && waited_us >= kMinSettle_us;
    if (is_enough || waited_us >= kMaxSettle_us) Settle();
    return ClockEvent::kNone;
  }
  const TimeSource source_before = source_;
  JudgeAbsoluteTime();
  const double error_ns = TargetAt(sample.stamp_ns) - OffsetAt(sample.stamp_ns);
  if (std::abs(error_ns) > static_cast<double>(kStep_ns)) {
    Begin(seen);
    return source_ == source_before ? ClockEvent::kStepped : ClockEvent::kSourceChanged;
  }
  if (sample.stamp_ns > knot_ns_) Slew(sample.stamp_ns);
  return source_ == source_before ? ClockEvent::kNone : ClockEvent::kSourceChanged;
}

void DeviceClock::Settle() {
  if (!anchor_ || is_settled_) return;
  is_settled_ = true;
  JudgeAbsoluteTime();
  knot_ns_ = Difference(newest_.device_ns, anchor_->device_ns);
  offset_ns_ = TargetAt(knot_ns_);
  slew_ = 0.0;
}

// Does the line say that PTP and GPS stamps agree with the host's clock?
void DeviceClock::JudgeAbsoluteTime() {
  if (!anchor_->is_device_stamp) {
    believes_ = false;
    source_ = TimeSource::kHost;
    return;
  }
  if (!HasAbsoluteTime(anchor_->type)) {
    believes_ = false;
    source_ = TimeSource::kDevice;
    return;
  }
  const std::int64_t stamp_ns = Difference(newest_.device_ns, anchor_->device_ns);
  const double error_ns = std::abs(envelope_.At(stamp_ns) - AbsoluteOffset_ns());
  const double max_error_ns = static_cast<double>(config_.max_error_us) * 1e3;
  believes_ = error_ns < (doubts_ ? 0.5 * max_error_ns : max_error_ns);
  doubts_ = !believes_;
  const bool is_ptp = anchor_->type == TimestampType::kPtp;
  source_ = !believes_ ? TimeSource::kDevice : is_ptp ? TimeSource::kPtp : TimeSource::kGps;
}

// Of stamps that are taken as they are.
double DeviceClock::AbsoluteOffset_ns() const {
  return static_cast<double>(
      Difference(anchor_->device_ns, static_cast<std::uint64_t>(anchor_->sent_ns)));
}

double DeviceClock::TargetAt(std::int64_t stamp_ns) const {
  return believes_ ? AbsoluteOffset_ns() : envelope_.At(stamp_ns);
}

// The offset in use: along the drift, and towards the target for kSlewTime_ns.
double DeviceClock::OffsetAt(std::int64_t stamp_ns) const {
  const auto since_ns = static_cast<double>(stamp_ns - knot_ns_);
  const double drift = believes_ ? 0.0 : envelope_.slope();
  return offset_ns_ + drift * since_ns + slew_ * std::clamp(since_ns, -kSlewTime_ns, kSlewTime_ns);
}

void DeviceClock::Slew(std::int64_t stamp_ns) {
  offset_ns_ = OffsetAt(stamp_ns);
  knot_ns_ = stamp_ns;
  slew_ = std::clamp((TargetAt(stamp_ns) - offset_ns_) / kSlewTime_ns, -kMaxSlew, kMaxSlew);
}

void DeviceClock::NoteResidual(const Observation& seen) {
  const DelayEnvelope::Sample sample = ToSample(seen);
  const double residual_ns = static_cast<double>(sample.offset_ns) - envelope_.At(sample.stamp_ns);
  residual_us_ = static_cast<std::int64_t>(residual_ns) / kNsPerUs;
  least_ns_[0] = std::min(least_ns_[0], residual_ns);
  if (++num_in_lot_ < kLot) return;
  num_in_lot_ = 0;
  least_ns_[1] = least_ns_[0];
  least_ns_[0] = kNone;
}

std::int64_t DeviceClock::lag_us() const {
  if (least_ns_[1] == kNone) return 0;
  const auto lag_us = static_cast<std::int64_t>(std::min(least_ns_[0], least_ns_[1])) / kNsPerUs;
  return lag_us < kIgnoredLag_us ? 0 : lag_us;
}

std::int64_t DeviceClock::ToHost(std::uint64_t device_ns) const {
  if (!anchor_) return 0;
  const std::int64_t stamp_ns = Difference(device_ns, anchor_->device_ns);
  const double offset_ns = is_settled_ ? OffsetAt(stamp_ns) : envelope_.At(stamp_ns);
  return static_cast<std::int64_t>(static_cast<std::uint64_t>(anchor_->sent_ns) +
                                   static_cast<std::uint64_t>(stamp_ns) +
                                   static_cast<std::uint64_t>(std::llround(offset_ns)));
}

std::uint64_t DeviceClock::ToDevice(std::int64_t utime_ns) const {
  if (!anchor_) return 0;
  // The offset changes by 1 % of the time at most: each round gains two digits.
  std::uint64_t device_ns = newest_.device_ns;
  for (int round = 0; round < 6; ++round) {
    device_ns += static_cast<std::uint64_t>(utime_ns - ToHost(device_ns));
  }
  return device_ns;
}

std::optional<double> DeviceClock::drift_ppm() const {
  if (!anchor_ || !envelope_.knows_slope()) return std::nullopt;
  return -1e6 * envelope_.slope();
}

}  // namespace clearway::core::livox
