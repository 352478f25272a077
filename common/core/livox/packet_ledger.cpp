// SPDX-License-Identifier: BSD-3-Clause
#include "common/core/livox/packet_ledger.hpp"

#include <algorithm>
#include <limits>

namespace clearway::core::livox {

PacketLedger::PacketLedger() {
  remembered_.reserve(2 * kRemembered);
  waiting_.reserve(256);
  Clear();
}

void PacketLedger::Clear() {
  is_empty_ = true;
  accounted_ns_ = 0;
  newest_end_ns_ = 0;
  closed_ns_ = std::numeric_limits<std::int64_t>::min();
  unit_ns_ = 1;
  waiting_.clear();
  remembered_.clear();
}

PacketVerdict PacketLedger::Judge(std::int64_t stamp_ns) const {
  if (std::binary_search(remembered_.begin(), remembered_.end(), stamp_ns)) {
    return PacketVerdict::kDuplicate;
  }
  const bool is_late =
      stamp_ns < closed_ns_ || (!is_empty_ && stamp_ns < accounted_ns_ - unit_ns_ / 2);
  return is_late ? PacketVerdict::kLate : PacketVerdict::kNew;
}

void PacketLedger::Remember(std::int64_t stamp_ns) {
  if (remembered_.size() == 2 * kRemembered) {
    remembered_.erase(remembered_.begin(), remembered_.begin() + kRemembered);
  }
  if (remembered_.empty() || remembered_.back() < stamp_ns) {
    remembered_.push_back(stamp_ns);
    return;
  }
  remembered_.insert(std::upper_bound(remembered_.begin(), remembered_.end(), stamp_ns), stamp_ns);
}

void PacketLedger::Add(std::int64_t stamp_ns, std::int64_t duration_ns) {
  const PacketVerdict verdict = Judge(stamp_ns);
  Remember(stamp_ns);
  if (verdict != PacketVerdict::kNew) return;
  if (is_empty_) {
    is_empty_ = false;
    accounted_ns_ = stamp_ns;
    newest_end_ns_ = stamp_ns;
    unit_ns_ = duration_ns;
  }
  newest_end_ns_ = std::max(newest_end_ns_, stamp_ns + duration_ns);
  const auto place = std::upper_bound(
      waiting_.begin(), waiting_.end(), stamp_ns, [](std::int64_t stamp, const Waiting& other) {
        return stamp < other.stamp_ns;
      });
  waiting_.insert(place, {stamp_ns, duration_ns});
  Advance();
}

void PacketLedger::AddUnstamped(std::int64_t start_ns, std::int64_t duration_ns) {
  const std::int64_t end_ns = start_ns + duration_ns;
  accounted_ns_ = is_empty_ ? end_ns : std::max(accounted_ns_, end_ns);
  newest_end_ns_ = accounted_ns_;
  is_empty_ = false;
}

// Takes the packets that follow without a gap.
void PacketLedger::Advance() {
  auto next = waiting_.begin();
  while (next != waiting_.end() && next->stamp_ns < accounted_ns_ + (unit_ns_ + 1) / 2) {
    accounted_ns_ = std::max(accounted_ns_, next->stamp_ns + next->duration_ns);
    unit_ns_ = next->duration_ns;
    ++next;
  }
  waiting_.erase(waiting_.begin(), next);
}

std::int64_t PacketLedger::DeclareLost(std::int64_t until_ns) {
  std::int64_t lost = 0;
  while (!waiting_.empty() && accounted_ns_ < until_ns) {
    const std::int64_t gap_ns = waiting_.front().stamp_ns - accounted_ns_;
    const std::int64_t in_gap = (gap_ns + unit_ns_ / 2) / unit_ns_;
    const std::int64_t before = (until_ns - accounted_ns_ + unit_ns_ - 1) / unit_ns_;
    if (before < in_gap) {
      lost += before;
      accounted_ns_ += before * unit_ns_;
      return lost;
    }
    lost += in_gap;
    accounted_ns_ = waiting_.front().stamp_ns;
    Advance();
  }
  return lost;
}

}  // namespace clearway::core::livox
