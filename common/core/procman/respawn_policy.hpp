// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <optional>

namespace clearway::core::procman {

/// When a command that ended by itself is started again. XML element: <deputy><respawn>.
struct RespawnConfig {
  std::int64_t quick_death_us = 5'000'000;
  std::int64_t first_pause_us = 100'000;
  std::int64_t longest_pause_us = 10'000'000;
  int give_up_after = 10;

  template <typename Self, typename Visitor>
  static void Visit(Self& self, Visitor& visitor) {
    visitor.Milliseconds("quick_death_ms",
                         self.quick_death_us,
                         10.0,
                         600000.0,
                         "A command that lived for less than this died too early [ms].");
    visitor.Milliseconds("first_pause_ms",
                         self.first_pause_us,
                         0.0,
                         600000.0,
                         "From the first early death to the next start [ms]; doubles with each. "
                         "After a death that was not early it starts at once.");
    visitor.Milliseconds("longest_pause_ms",
                         self.longest_pause_us,
                         0.0,
                         600000.0,
                         "The pause grows up to this [ms].");
    visitor.Integer("give_up_after",
                    self.give_up_after,
                    1,
                    1000000,
                    "So many early deaths in a row, and it is not started again until a sheriff "
                    "orders a new run.");
  }
};

/// Counts early deaths of one command and answers with pauses. Time is an argument.
class RespawnPolicy {
 public:
  explicit RespawnPolicy(const RespawnConfig& config) : config_(config) {}

  /// It ended by itself after `lived_us`. The pause before its next start, counted from now [us];
  /// nothing: given up.
  [[nodiscard]] std::optional<std::int64_t> OnDeath(std::int64_t lived_us);

  /// A sheriff ordered a new run: all is forgotten.
  void Reset() { quick_deaths_ = 0; }

  /// Early deaths in a row.
  [[nodiscard]] int quick_deaths() const { return quick_deaths_; }

 private:
  RespawnConfig config_;
  int quick_deaths_ = 0;
};

}  // namespace clearway::core::procman
