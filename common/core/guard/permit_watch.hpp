// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>

#include "common/core/scan/freshness_watch.hpp"

namespace clearway::core {

/// Settings of PermitWatch.
struct PermitWatchConfig {
  std::int64_t validity_us = 100'000;
  std::int64_t max_lateness_us = 100'000;
  std::int64_t unlock_us = 1'000'000;

  template <typename Self, typename Visitor>
  static void Visit(Self& self, Visitor& visitor) {
    visitor.Milliseconds("validity_ms",
                         self.validity_us,
                         20.0,
                         1000.0,
                         "Without a new permit for longer than this the base stops [ms].");
    visitor.Milliseconds("max_lateness_ms",
                         self.max_lateness_us,
                         20.0,
                         1000.0,
                         "A permit later than the quickest ones by more than this means stop: its "
                         "publisher was frozen [ms].");
    visitor.Milliseconds("unlock_ms",
                         self.unlock_us,
                         100.0,
                         60000.0,
                         "The publisher must be silent for this long before another is obeyed "
                         "[ms].");
  }
};

/// Whether the base may move by the permit that it holds.
enum class PermitState : std::int8_t {
  kValid,     ///< Obey the last accepted permit.
  kNone,      ///< None has come: stop.
  kStale,     ///< The last one is older than validity_us: stop.
  kLate,      ///< Permits come late: stop.
  kRepeated,  ///< The last sequence was repeated or went back: stop until the next good one.
};

/// The rule on the base's side, which holds whatever became of the stop guard: a permit counts only
/// while it is young by the receiver's own clock, its sequence ascends, and it comes from the one
/// publisher that the base has locked to. Permits of others are ignored and counted, until that one
/// has been silent for unlock_us. O(1). Thread safety: none.
class PermitWatch {
 public:
  explicit PermitWatch(const PermitWatchConfig& config = {}) : config_(config) {}

  /// A permit arrived; `utime` is its stamp. True when its limits are to replace those held.
  bool OnPermit(std::int64_t session,
                std::int64_t sequence,
                std::int64_t utime,
                std::int64_t now_us);

  [[nodiscard]] PermitState State(std::int64_t now_us) const;
  [[nodiscard]] bool IsValid(std::int64_t now_us) const {
    return State(now_us) == PermitState::kValid;
  }

  [[nodiscard]] std::int64_t num_foreign() const { return num_foreign_; }
  [[nodiscard]] std::int64_t num_repeated() const { return num_repeated_; }

 private:
  PermitWatchConfig config_;
  bool is_locked_ = false;
  std::int64_t session_ = 0;
  std::int64_t sequence_ = 0;  // Highest of the session.
  std::int64_t heard_us_ = 0;  // Last message of the session, good or not.
  bool is_repeated_ = false;
  FreshnessWatch freshness_;
  std::int64_t num_foreign_ = 0;
  std::int64_t num_repeated_ = 0;
};

}  // namespace clearway::core
