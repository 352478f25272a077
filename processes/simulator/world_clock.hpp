// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <cstdlib>

#include "common/process/runtime.hpp"

namespace clearway {

/// The time of the simulated world [us]: it starts with the process and goes as the host's
/// monotonic clock does. Stamps are the host's time of day.
class WorldClock {
 public:
  explicit WorldClock(process::Runtime& runtime)
      : runtime_(runtime), start_us_(runtime.MonotonicUs()), start_utime_(runtime.UtimeNow()) {}

  [[nodiscard]] std::int64_t Now() const { return runtime_.MonotonicUs() - start_us_; }

  /// The host's time of day at a moment of the world [us since the epoch].
  [[nodiscard]] std::int64_t UtimeOf(std::int64_t time_us) const { return start_utime_ + time_us; }

  /// The world's time at a time of day.
  [[nodiscard]] std::int64_t TimeOf(std::int64_t utime) const { return utime - start_utime_; }

  /// Follows a time of day that was set; true when it was. Two clocks are never read at once: what
  /// may be the time between two readings is no step.
  bool Follow() {
    const std::int64_t before_us = Now();
    const std::int64_t utime = runtime_.UtimeNow();
    const std::int64_t after_us = Now();
    const std::int64_t step_us = utime - UtimeOf(before_us);
    if (std::abs(step_us) < kLeastStep_us + (after_us - before_us)) return false;
    start_utime_ += step_us;
    return true;
  }

 private:
  static constexpr std::int64_t kLeastStep_us = 2000;

  process::Runtime& runtime_;
  std::int64_t start_us_;
  std::int64_t start_utime_;
};

}  // namespace clearway
