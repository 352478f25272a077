// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <utility>

namespace clearway::process {

/// Timers ordered by due time, then by age. Knows no clock: time is an argument [us].
class Timers {
 public:
  using Id = std::uint64_t;

  /// First due at `due_us`; again every `period_us`, once when that is 0.
  Id Add(std::int64_t due_us, std::int64_t period_us, std::function<void()> callback);
  void Cancel(Id id);

  /// When the next timer is due; nothing when there is none.
  [[nodiscard]] std::optional<std::int64_t> NextDue() const;

  /// Runs the first timer that is due at `now_us`, if there is one; tells whether there was.
  /// Of a periodic timer's missed calls only one is made.
  bool RunOne(std::int64_t now_us);

 private:
  struct Timer {
    std::int64_t period_us;
    std::function<void()> callback;
  };
  std::map<std::pair<std::int64_t, Id>, Timer> timers_;
  Id next_id_ = 1;
};

}  // namespace clearway::process
