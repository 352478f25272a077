// SPDX-License-Identifier: BSD-3-Clause
#include "common/core/simulation/emulated_clock.hpp"

#include <algorithm>
#include <cmath>

namespace clearway::core {
namespace {

constexpr std::int64_t kNsPerUs = 1000;
constexpr std::int64_t kNsPerS = 1'000'000'000;
constexpr std::int64_t kYear2000Ns = 946'684'800 * kNsPerS;

// No GPS stamp is older.
std::uint64_t GpsStamp(std::int64_t utc_ns) {
  return livox::ToGpsTimestamp(std::max(utc_ns, kYear2000Ns));
}

// PPS stamps wrap at each pulse, also before the epoch.
std::int64_t SincePulseNs(std::int64_t ns) {
  const std::int64_t rest = ns % kNsPerS;
  return rest < 0 ? rest + kNsPerS : rest;
}

}  // namespace

EmulatedClock::EmulatedClock(double drift_ppm, std::int64_t start_us)
    : rate_(drift_ppm * 1e-6), offset_ns_(start_us * kNsPerUs) {}

void EmulatedClock::Restart(std::int64_t true_us) {
  started_us_ = true_us;
  offset_ns_ = 0;
  utc_minus_true_ns_.reset();
}

std::int64_t EmulatedClock::OscillatorNs(std::int64_t true_us) const {
  const std::int64_t elapsed_ns = (true_us - started_us_) * kNsPerUs;
  return elapsed_ns + std::llround(static_cast<double>(elapsed_ns) * rate_);
}

std::int64_t EmulatedClock::TrueUs(std::int64_t oscillator_ns) const {
  // t = o / (1 + r) = o - o r / (1 + r): the second term is small, so that double is exact enough.
  const double late_ns = static_cast<double>(oscillator_ns) * (rate_ / (1.0 + rate_));
  const std::int64_t elapsed_ns = oscillator_ns - std::llround(late_ns);
  const std::int64_t below = elapsed_ns >= 0 ? elapsed_ns : elapsed_ns - (kNsPerUs - 1);
  return started_us_ + below / kNsPerUs;
}

EmulatedClock::Stamp EmulatedClock::StampAt(std::int64_t oscillator_ns,
                                            const EmulatedTimeSync& sync,
                                            std::int64_t utime_minus_true_us) const {
  using livox::TimestampType;
  const auto stamp = [](TimestampType type, std::int64_t ns) {
    return Stamp{type, static_cast<std::uint64_t>(std::max<std::int64_t>(ns, 0))};
  };
  const double late_ns = static_cast<double>(oscillator_ns) * (rate_ / (1.0 + rate_));
  const std::int64_t true_ns = started_us_ * kNsPerUs + oscillator_ns - std::llround(late_ns);
  const std::int64_t source_ns = true_ns + (utime_minus_true_us + sync.error_us) * kNsPerUs;
  switch (sync.source) {
    case TimestampType::kPtp:
      return stamp(TimestampType::kPtp, source_ns);
    case TimestampType::kGps:
      return {TimestampType::kGps, GpsStamp(source_ns)};
    case TimestampType::kPps:
      if (!utc_minus_true_ns_) return stamp(TimestampType::kPps, SincePulseNs(source_ns));
      return {TimestampType::kGps,
              GpsStamp(true_ns + *utc_minus_true_ns_ + sync.error_us * kNsPerUs)};
    default:
      return stamp(TimestampType::kNoSync, oscillator_ns + offset_ns_);
  }
}

}  // namespace clearway::core
