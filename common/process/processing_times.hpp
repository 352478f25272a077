// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace clearway::process {

/// Durations of the units of work since the last look.
class ProcessingTimes {
 public:
  struct Summary {
    std::size_t count = 0;
    double median_ms = -1.0;  ///< -1 when there was no work.
    double max_ms = -1.0;
  };

  void Add(std::int64_t duration_us) { durations_us_.push_back(duration_us); }

  /// What was added since the last call.
  Summary Take();

 private:
  std::vector<std::int64_t> durations_us_;
};

}  // namespace clearway::process
