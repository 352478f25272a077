// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>

namespace clearway::core {

/// Tells how fresh a stream of stamped messages is without comparing two clocks: by the time since
/// the last arrival, and by (arrival - stamp) against its own least value so far. The second finds
/// a pipeline that is steadily late, and a process that was frozen and now drains its queue: its
/// messages arrive in quick order, but each is old.
///
/// The least value may creep up by kDrift of the time passed, since two clocks drift apart; a
/// lateness is therefore forgiven only at that rate (0.1 s takes 200 s), never because a window
/// slid past. A stamp that goes back by more than kStepBack_us cannot come out of a queue: it is a
/// stepped clock, another publisher or a log played again, and starts the comparison anew.
/// What was late from the very first message on cannot be told from what is not.
/// O(1) time and memory.
class FreshnessWatch {
 public:
  static constexpr double kDrift = 500e-6;
  static constexpr std::int64_t kStepBack_us = 100'000;

  struct State {
    bool has_arrived = false;      ///< False: nothing arrived since the start; the rest is 0.
    std::int64_t age_us = 0;       ///< Since the last arrival [us].
    std::int64_t lateness_us = 0;  ///< Of the last message, against the quickest so far [us].
  };

  /// `monotonic_us` is the receiver's clock, `stamp_us` the sender's (of the measurement).
  /// Stamps beyond +-2^61 are clamped to that: no value can overflow.
  void OnArrival(std::int64_t monotonic_us, std::int64_t stamp_us);

  [[nodiscard]] State Query(std::int64_t monotonic_us) const;

  /// Forgets everything, as for a publisher that started anew.
  void Reset() { *this = FreshnessWatch(); }

 private:
  bool has_arrived_ = false;
  std::int64_t arrival_us_ = 0;
  std::int64_t stamp_us_ = 0;
  std::int64_t lateness_us_ = 0;
  double creep_us_ = 0.0;            // Part of the drift that is not yet a whole microsecond.
  std::int64_t least_delay_us_ = 0;  // Running minimum of arrival - stamp.
};

}  // namespace clearway::core
