// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <optional>

#include "common/core/geometry/pose_buffer.hpp"
#include "common/core/scan/sequence_tracker.hpp"

namespace clearway::core {

/// Whether POSE is to be believed. It is not while its source says that it is lost, and not while
/// there are two sources. POSE has no session: two sources show by stamps that go back a little, or
/// that go back far and then on again from where they were.
/// The word "lost" holds until the source takes it back; it is forgotten when the source has died:
/// neither POSE nor POSE_STATUS for kSourceDied_us, and then POSE again.
/// All times are those of the receiver's monotonic clock. O(1). Thread safety: none.
class PoseTrust {
 public:
  enum class Doubt : std::int8_t { kNone, kLost, kTwoSources };

  /// For how long two sources are remembered [us].
  static constexpr std::int64_t kTwoSources_us = 1'000'000;
  static constexpr std::int64_t kSourceDied_us = 2'500'000;

  /// A pose with the stamp `utime` came, and a PoseBuffer said `outcome` to it.
  void OnPose(std::int64_t utime, PoseBuffer::Outcome outcome, std::int64_t now_us);

  /// A word of the source about itself, with the session and number of its message. Messages that
  /// were overtaken are ignored, as is the good word of a second sender.
  void OnStatus(bool is_lost, std::int64_t session, std::int64_t sequence, std::int64_t now_us);

  [[nodiscard]] Doubt Query(std::int64_t now_us) const;

  /// Poses that showed two sources, since the start.
  [[nodiscard]] std::int64_t out_of_order() const { return out_of_order_; }

 private:
  void NoteTwoSources(std::int64_t now_us);

  struct StepBack {
    std::int64_t from_utime;
    std::int64_t at_us;
  };

  bool is_lost_ = false;
  SequenceTracker statuses_;
  std::optional<std::int64_t> heard_us_;  // The source: POSE or POSE_STATUS.
  std::optional<std::int64_t> newest_utime_;
  std::optional<StepBack> step_back_;
  std::optional<std::int64_t> two_sources_us_;
  std::int64_t out_of_order_ = 0;
};

}  // namespace clearway::core
