// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

namespace clearway::core {

/// What one message's (session, sequence) means against those before it.
enum class SequenceVerdict : std::int8_t {
  kFirst,       ///< The first message ever.
  kNext,        ///< The successor of the newest.
  kGap,         ///< Ahead of the successor: messages are missing in between.
  kDuplicate,   ///< A number that was received already.
  kOutOfOrder,  ///< A number before the newest that was not received yet, or too old to know.
  kRestart,     ///< The first message of a new session, or of one that began again (see below).
  kForeign,     ///< Of a session that gave way to another a moment ago: two publishers.
  kInvalid,     ///< A sequence number below zero; counted, otherwise ignored.
};

/// True when the message is the newest of its stream so far; the others must not count as news.
[[nodiscard]] constexpr bool IsNewest(SequenceVerdict verdict) {
  return verdict == SequenceVerdict::kFirst || verdict == SequenceVerdict::kNext ||
         verdict == SequenceVerdict::kGap || verdict == SequenceVerdict::kRestart;
}

/// Counts of a stream since the start.
struct SequenceCounts {
  std::int64_t received = 0;      ///< All messages observed, whatever the verdict.
  std::int64_t missing = 0;       ///< Numbers skipped and not received later. Saturates.
  std::int64_t duplicates = 0;    ///< Received again.
  std::int64_t out_of_order = 0;  ///< Received late; no longer in `missing`.
  std::int64_t restarts = 0;      ///< Verdicts kRestart.
  std::int64_t foreign = 0;       ///< Of a second publisher beside the current one.
  std::int64_t invalid = 0;       ///< Negative sequence numbers.
};

/// Watches the numbering of one stream that has one owner. A publisher draws a random session at
/// its start and counts its messages. Two sessions that take turns within kForeign_us are two
/// publishers, not restarts; the one that appeared last is taken as the owner until it has been
/// silent for that long. A session whose numbers go far back and then count on from there for
/// kRejoin messages, without one ahead of the newest, began again: a log played a second time.
/// O(1) time and memory; the last 64 numbers are remembered one by one.
class SequenceTracker {
 public:
  /// A session that was heard within this time has not ended [us].
  static constexpr std::int64_t kForeign_us = 2'000'000;

  static constexpr int kRejoin = 8;

  /// `now_us` is the receiver's monotonic clock.
  SequenceVerdict Observe(std::int64_t session, std::int64_t sequence, std::int64_t now_us);

  [[nodiscard]] const SequenceCounts& counts() const { return counts_; }
  /// The owner's session; meaningless before the first message.
  [[nodiscard]] std::int64_t session() const { return current_.session; }

 private:
  struct Heard {
    std::int64_t session = 0;
    std::int64_t last_us = 0;
    bool used = false;
  };

  [[nodiscard]] bool IsForeign(std::int64_t session, std::int64_t now_us);
  void Remember(const Heard& heard);
  void Begin(std::int64_t session, std::int64_t sequence, std::int64_t now_us);
  SequenceVerdict Advance(std::int64_t sequence);
  SequenceVerdict LookBack(std::int64_t sequence, std::int64_t now_us);

  Heard current_;
  std::int64_t newest_ = 0;  // Highest sequence of the current session.
  std::uint64_t seen_ = 0;   // Bit k: newest_ - k was received.
  std::uint64_t known_ = 0;  // Bit k: newest_ - k belongs to what was counted as missing or seen.
  std::int64_t rejoin_next_ = -1;  // Successor of the last message from far back.
  int rejoin_run_ = 0;             // How many have counted on from far back.
  std::array<Heard, 8> former_{};
  std::size_t next_former_ = 0;
  SequenceCounts counts_;
};

}  // namespace clearway::core
