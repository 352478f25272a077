// SPDX-License-Identifier: BSD-3-Clause
#include "common/core/guard/permit_watch.hpp"

namespace clearway::core {

bool PermitWatch::OnPermit(std::int64_t session,
                           std::int64_t sequence,
                           std::int64_t utime,
                           std::int64_t now_us) {
  if (is_locked_ && session != session_) {
    if (now_us - heard_us_ <= config_.unlock_us) {
      ++num_foreign_;
      return false;
    }
    is_locked_ = false;
  }
  heard_us_ = now_us;
  if (!is_locked_) {
    is_locked_ = true;
    session_ = session;
    freshness_.Reset();
  } else if (sequence <= sequence_) {
    ++num_repeated_;
    is_repeated_ = true;
    return false;
  }
  sequence_ = sequence;
  is_repeated_ = false;
  freshness_.OnArrival(now_us, utime);
  return true;
}

PermitState PermitWatch::State(std::int64_t now_us) const {
  const FreshnessWatch::State freshness = freshness_.Query(now_us);
  if (!freshness.has_arrived) return PermitState::kNone;
  if (is_repeated_) return PermitState::kRepeated;
  if (freshness.age_us > config_.validity_us) return PermitState::kStale;
  if (freshness.lateness_us > config_.max_lateness_us) return PermitState::kLate;
  return PermitState::kValid;
}

}  // namespace clearway::core
