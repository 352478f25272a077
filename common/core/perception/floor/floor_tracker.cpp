// SPDX-License-Identifier: BSD-3-Clause
#include "common/core/perception/floor/floor_tracker.hpp"

#include <algorithm>
#include <limits>

namespace clearway::core {
namespace {

// later - earlier for later >= earlier, saturated: stamps of a damaged log may lie far apart.
std::int64_t Elapsed_us(std::int64_t earlier, std::int64_t later) {
  const std::uint64_t elapsed =
      static_cast<std::uint64_t>(later) - static_cast<std::uint64_t>(earlier);
  constexpr std::int64_t kLargest = std::numeric_limits<std::int64_t>::max();
  return static_cast<std::int64_t>(std::min(elapsed, static_cast<std::uint64_t>(kLargest)));
}

}  // namespace

FloorEstimate FloorTracker::Update(std::int64_t utime, const std::optional<FloorFit>& found) {
  if (last_utime_ && utime < *last_utime_) last_good_.reset();
  last_utime_ = utime;
  if (found) {
    last_good_ = found;
    last_good_utime_ = utime;
    return {.state = FloorState::kFound, .fit = *found, .age_us = 0};
  }
  if (!last_good_) return {.state = FloorState::kConfigured, .fit = {}, .age_us = -1};
  const std::int64_t age_us = Elapsed_us(last_good_utime_, utime);
  if (age_us > config_.hold_us) {
    return {.state = FloorState::kConfigured, .fit = {}, .age_us = age_us};
  }
  return {.state = FloorState::kHeld, .fit = *last_good_, .age_us = age_us};
}

}  // namespace clearway::core
