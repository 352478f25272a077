// SPDX-License-Identifier: BSD-3-Clause
#include "common/core/procman/order_ledger.hpp"

#include <algorithm>

namespace clearway::core::procman {
namespace {

// Ids come from outside; a sheriff that is started anew has a new one.
constexpr std::size_t kMaxSheriffs = 256;
// Orders come at 1 Hz.
constexpr std::int64_t kActiveUs = 3'000'000;
// No network keeps one back for so long: what is older than the last one and comes after such a
// silence is a sheriff whose clock was set back.
constexpr std::int64_t kClockStepUs = 10'000'000;

}  // namespace

OrderLedger::Verdict OrderLedger::Judge(const std::string& sheriff_id,
                                        std::int64_t utime,
                                        std::int64_t now_us) {
  const auto known = sheriffs_.find(sheriff_id);
  if (known != sheriffs_.end() && utime <= known->second.utime &&
      now_us - known->second.heard_us < kClockStepUs) {
    return utime == known->second.utime ? Verdict::kRepeated : Verdict::kStale;
  }
  if (known == sheriffs_.end() && sheriffs_.size() >= kMaxSheriffs) ForgetTheOldest();
  const std::int64_t since_us = known == sheriffs_.end() ? now_us : known->second.since_us;
  sheriffs_[sheriff_id] = {utime, now_us, since_us};
  current_ = sheriff_id;
  return Verdict::kNew;
}

std::int64_t OrderLedger::AgeUs(std::int64_t now_us) const {
  const auto found = sheriffs_.find(current_);
  return found == sheriffs_.end() ? -1 : now_us - found->second.heard_us;
}

std::string OrderLedger::Rival(std::int64_t now_us) const {
  if (AgeUs(now_us) < 0 || AgeUs(now_us) > kActiveUs) return {};
  const std::int64_t since_us = sheriffs_.at(current_).since_us;
  for (const auto& [id, sheriff] : sheriffs_) {
    const bool is_recent = now_us - sheriff.heard_us <= kActiveUs;
    if (id != current_ && is_recent && sheriff.heard_us >= since_us) return id;
  }
  return {};
}

void OrderLedger::ForgetTheOldest() {
  sheriffs_.erase(
      std::min_element(sheriffs_.begin(), sheriffs_.end(), [](const auto& a, const auto& b) {
        return a.second.heard_us < b.second.heard_us;
      }));
}

}  // namespace clearway::core::procman
