// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <optional>

namespace clearway::core::livox {

/// Which packets of one sensor are missing: there are no sequence numbers, but each packet's stamp
/// follows from the one before, so that a gap of n + 1 intervals lacks n packets. They stay missing
/// until they come after all, or are given up with the time that they belong to.
/// O(missing packets of the last second). Thread safety: none.
class PacketGaps {
 public:
  enum class Verdict : std::uint8_t {
    kNext,       ///< Younger than all before; there may be a gap in front of it.
    kFilled,     ///< One that was missing.
    kLate,       ///< One that had been given up; it stays counted as lost.
    kDuplicate,  ///< It was there already.
  };

  /// Takes the stamp of a packet that lasts `interval_ns`; `utime_ns` is the same on the host's
  /// clock, `given_up_utime` the time before which everything is over.
  Verdict Observe(std::uint64_t stamp_ns,
                  std::int64_t interval_ns,
                  std::int64_t utime_ns,
                  std::int64_t given_up_utime);

  /// True when a packet is missing that would have begun before `end_utime`.
  [[nodiscard]] bool HasOpenBefore(std::int64_t end_utime) const;

  /// Gives up what would have begun before `end_utime`: how many never came.
  std::int64_t GiveUpBefore(std::int64_t end_utime);

  /// Forgets the stream; gives up what is missing: how many.
  std::int64_t Restart();

 private:
  struct Missing {
    std::uint64_t stamp_ns = 0;
    std::int64_t utime_ns = 0;
    bool has_come = false;
    bool is_given_up = false;
  };
  void Note(std::uint64_t stamp_ns,
            std::int64_t interval_ns,
            std::int64_t utime_ns,
            std::int64_t n);

  std::deque<Missing> missing_;  // Ascending stamps.
  std::optional<std::uint64_t> expected_ns_;
  std::int64_t untold_ = 0;  // Given up at once: too many, or too old when they were found missing.
};

}  // namespace clearway::core::livox
