// SPDX-License-Identifier: BSD-3-Clause
#include "common/core/livox/packet_gaps.hpp"

#include <algorithm>
#include <utility>

namespace clearway::core::livox {
namespace {

constexpr std::int64_t kNsPerUs = 1000;
// How long a packet is remembered that came late or never [ns]: its copies may come later still.
constexpr std::int64_t kMemory_ns = 1'000'000'000;
// A gap with more packets is silence; they are lost, and none of them is waited for.
constexpr std::int64_t kMaxTracked = 1000;

std::int64_t Difference(std::uint64_t a, std::uint64_t b) {
  return static_cast<std::int64_t>(a - b);
}

}  // namespace

PacketGaps::Verdict PacketGaps::Observe(std::uint64_t stamp_ns,
                                        std::int64_t interval_ns,
                                        std::int64_t utime_ns,
                                        std::int64_t given_up_utime) {
  const std::int64_t ahead_ns = expected_ns_ ? Difference(stamp_ns, *expected_ns_) : 0;
  if (ahead_ns >= -interval_ns / 2) {
    const std::int64_t n = (ahead_ns + interval_ns / 2) / interval_ns;
    if (n > 0) Note(stamp_ns, interval_ns, utime_ns, n);
    expected_ns_ = stamp_ns + static_cast<std::uint64_t>(interval_ns);
    return Verdict::kNext;
  }
  const auto found = std::find_if(missing_.rbegin(), missing_.rend(), [&](const Missing& missing) {
    return std::abs(Difference(missing.stamp_ns, stamp_ns)) < interval_ns / 2;
  });
  if (found == missing_.rend()) {
    return ahead_ns < -kMemory_ns ? Verdict::kLate : Verdict::kDuplicate;
  }
  if (found->has_come) return Verdict::kDuplicate;
  found->has_come = true;
  return found->is_given_up || found->utime_ns < given_up_utime * kNsPerUs ? Verdict::kLate
                                                                           : Verdict::kFilled;
}

void PacketGaps::Note(std::uint64_t stamp_ns,
                      std::int64_t interval_ns,
                      std::int64_t utime_ns,
                      std::int64_t n) {
  if (n > kMaxTracked) {
    untold_ += n;
    return;
  }
  for (std::int64_t i = n; i > 0; --i) {
    missing_.push_back({.stamp_ns = stamp_ns - static_cast<std::uint64_t>(i * interval_ns),
                        .utime_ns = utime_ns - i * interval_ns});
  }
}

bool PacketGaps::HasOpenBefore(std::int64_t end_utime) const {
  return std::any_of(missing_.begin(), missing_.end(), [&](const Missing& missing) {
    return !missing.has_come && !missing.is_given_up && missing.utime_ns < end_utime * kNsPerUs;
  });
}

std::int64_t PacketGaps::GiveUpBefore(std::int64_t end_utime) {
  std::int64_t lost = std::exchange(untold_, 0);
  for (Missing& missing : missing_) {
    if (missing.utime_ns >= end_utime * kNsPerUs) break;
    if (missing.has_come || missing.is_given_up) continue;
    missing.is_given_up = true;
    ++lost;
  }
  while (!missing_.empty() && expected_ns_ &&
         Difference(*expected_ns_, missing_.front().stamp_ns) > kMemory_ns &&
         (missing_.front().has_come || missing_.front().is_given_up)) {
    missing_.pop_front();
  }
  return lost;
}

std::int64_t PacketGaps::Restart() {
  const std::int64_t lost =
      std::exchange(untold_, 0) +
      std::count_if(missing_.begin(), missing_.end(), [](const Missing& missing) {
        return !missing.has_come && !missing.is_given_up;
      });
  missing_.clear();
  expected_ns_.reset();
  return lost;
}

}  // namespace clearway::core::livox
