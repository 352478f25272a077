// SPDX-License-Identifier: BSD-3-Clause
#include "common/core/procman/respawn_policy.hpp"

#include <algorithm>

namespace clearway::core::procman {

std::optional<std::int64_t> RespawnPolicy::OnDeath(std::int64_t lived_us) {
  if (lived_us >= config_.quick_death_us) {
    quick_deaths_ = 0;
    return 0;
  }
  ++quick_deaths_;
  if (quick_deaths_ >= config_.give_up_after) return std::nullopt;
  // Far fewer doublings than would overflow reach any longest pause.
  const int doublings = std::min(quick_deaths_ - 1, 30);
  return std::min(config_.first_pause_us << doublings, config_.longest_pause_us);
}

}  // namespace clearway::core::procman
