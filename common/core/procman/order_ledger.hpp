// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <map>
#include <string>

namespace clearway::core::procman {

/// Who commands, and whether an order is newer than the last one of the same sheriff. A sheriff's
/// clock is compared with nothing but itself; where it was set back, the sheriff is obeyed again
/// after 10 s without anything newer. Bounded memory, for ids of bounded length.
class OrderLedger {
 public:
  enum class Verdict {
    kNew,
    kRepeated,  ///< The newest once more: the network doubled it.
    kStale,     ///< Older than what this sheriff already said.
  };

  /// `utime` is the order's stamp, `now_us` the receiver's monotonic clock.
  Verdict Judge(const std::string& sheriff_id, std::int64_t utime, std::int64_t now_us);

  /// Whose orders were new last; empty: nobody's.
  [[nodiscard]] const std::string& current() const { return current_; }
  /// Since then [us]; -1: never.
  [[nodiscard]] std::int64_t AgeUs(std::int64_t now_us) const;

  /// The other sheriff, while two command at once: it spoke less than 3 s ago, and after the
  /// current one had begun. Empty: there is none.
  [[nodiscard]] std::string Rival(std::int64_t now_us) const;

 private:
  struct Sheriff {
    std::int64_t utime = 0;
    std::int64_t heard_us = 0;
    std::int64_t since_us = 0;  // Its first orders.
  };
  void ForgetTheOldest();

  std::map<std::string, Sheriff> sheriffs_;
  std::string current_;
};

}  // namespace clearway::core::procman
