// SPDX-License-Identifier: BSD-3-Clause
#include "common/core/scan/sequence_tracker.hpp"

#include <limits>

namespace clearway::core {

SequenceVerdict SequenceTracker::Observe(std::int64_t session,
                                         std::int64_t sequence,
                                         std::int64_t now_us) {
  ++counts_.received;
  if (sequence < 0) {
    ++counts_.invalid;
    return SequenceVerdict::kInvalid;
  }
  if (!current_.used) {
    Begin(session, sequence, now_us);
    return SequenceVerdict::kFirst;
  }
  if (session == current_.session) {
    current_.last_us = now_us;
    return sequence > newest_ ? Advance(sequence) : LookBack(sequence, now_us);
  }
  if (IsForeign(session, now_us)) {
    ++counts_.foreign;
    return SequenceVerdict::kForeign;
  }
  Remember(current_);
  Begin(session, sequence, now_us);
  ++counts_.restarts;
  return SequenceVerdict::kRestart;
}

// A former owner takes over again only after the present one has fallen silent.
bool SequenceTracker::IsForeign(std::int64_t session, std::int64_t now_us) {
  for (Heard& heard : former_) {
    if (!heard.used || heard.session != session) continue;
    heard.used = now_us - current_.last_us <= kForeign_us;
    return heard.used;
  }
  return false;
}

void SequenceTracker::Remember(const Heard& heard) {
  former_[next_former_] = heard;
  next_former_ = (next_former_ + 1) % former_.size();
}

void SequenceTracker::Begin(std::int64_t session, std::int64_t sequence, std::int64_t now_us) {
  current_ = {session, now_us, true};
  newest_ = sequence;
  seen_ = 1;
  known_ = 1;
  rejoin_run_ = 0;
}

SequenceVerdict SequenceTracker::Advance(std::int64_t sequence) {
  const std::int64_t step = sequence - newest_;  // Both are >= 0: no overflow.
  newest_ = sequence;
  rejoin_run_ = 0;
  if (step < 64) {
    seen_ = (seen_ << step) | 1U;
    known_ = (known_ << step) | ((std::uint64_t{1} << step) - 1U);
  } else {
    seen_ = 1;
    known_ = ~std::uint64_t{0};
  }
  if (step == 1) return SequenceVerdict::kNext;
  const std::int64_t room = std::numeric_limits<std::int64_t>::max() - counts_.missing;
  counts_.missing += step - 1 < room ? step - 1 : room;
  return SequenceVerdict::kGap;
}

SequenceVerdict SequenceTracker::LookBack(std::int64_t sequence, std::int64_t now_us) {
  const std::int64_t back = newest_ - sequence;
  if (back >= 64) {
    rejoin_run_ = sequence == rejoin_next_ ? rejoin_run_ + 1 : 1;
    rejoin_next_ = sequence + 1;
    if (rejoin_run_ >= kRejoin) {
      Begin(current_.session, sequence, now_us);
      ++counts_.restarts;
      return SequenceVerdict::kRestart;
    }
    ++counts_.out_of_order;
    return SequenceVerdict::kOutOfOrder;
  }
  const std::uint64_t bit = std::uint64_t{1} << back;
  if ((seen_ & bit) != 0) {
    ++counts_.duplicates;
    return SequenceVerdict::kDuplicate;
  }
  if ((known_ & bit) != 0) --counts_.missing;
  seen_ |= bit;
  ++counts_.out_of_order;
  return SequenceVerdict::kOutOfOrder;
}

}  // namespace clearway::core
