// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <string>

#include "tools/replay/replay.hpp"

namespace clearway::replay {

/// What is told about a replay.
struct Report {
  const ReplayResult& result;
  double wall_s = 0.0;  ///< Time that the replay took.
  std::optional<Comparison> comparison;

  /// Times faster than real time; 0 when nothing was recorded.
  [[nodiscard]] double speed() const { return wall_s > 0.0 ? result.recorded_s / wall_s : 0.0; }
};

/// The table that a person reads.
[[nodiscard]] std::string FormatTable(const Report& report);

/// The figures with their stable names; what was not measured is absent.
[[nodiscard]] std::string FormatJson(const Report& report);

/// What was wrong with the log, and with what the graph made of it, one line each; empty: nothing.
[[nodiscard]] std::string Problems(const Report& report);

}  // namespace clearway::replay
