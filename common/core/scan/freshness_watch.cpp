// SPDX-License-Identifier: BSD-3-Clause
#include "common/core/scan/freshness_watch.hpp"

#include <algorithm>
#include <cmath>

namespace clearway::core {

namespace {
constexpr std::int64_t kLimit = std::int64_t{1} << 61;  // Differences of two such values fit.
}

void FreshnessWatch::OnArrival(std::int64_t monotonic_us, std::int64_t stamp_us) {
  const std::int64_t stamp = std::clamp(stamp_us, -kLimit, kLimit);
  const std::int64_t delay = monotonic_us - stamp;
  if (!has_arrived_ || stamp < stamp_us_ - kStepBack_us) {
    least_delay_us_ = delay;
    creep_us_ = 0.0;
  } else {
    creep_us_ +=
        kDrift * static_cast<double>(std::max<std::int64_t>(0, monotonic_us - arrival_us_));
    const double whole = std::floor(creep_us_);
    creep_us_ -= whole;
    least_delay_us_ = std::min(delay, least_delay_us_ + static_cast<std::int64_t>(whole));
  }
  has_arrived_ = true;
  arrival_us_ = monotonic_us;
  stamp_us_ = stamp;
  lateness_us_ = delay - least_delay_us_;
}

FreshnessWatch::State FreshnessWatch::Query(std::int64_t monotonic_us) const {
  if (!has_arrived_) return {};
  return {true, std::max<std::int64_t>(0, monotonic_us - arrival_us_), lateness_us_};
}

}  // namespace clearway::core
