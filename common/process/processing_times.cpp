// SPDX-License-Identifier: BSD-3-Clause
#include "common/process/processing_times.hpp"

#include <algorithm>

namespace clearway::process {

ProcessingTimes::Summary ProcessingTimes::Take() {
  Summary summary;
  summary.count = durations_us_.size();
  if (summary.count > 0) {
    const auto middle = durations_us_.begin() + static_cast<std::ptrdiff_t>(summary.count / 2);
    std::nth_element(durations_us_.begin(), middle, durations_us_.end());
    summary.median_ms = static_cast<double>(*middle) / 1000.0;
    summary.max_ms =
        static_cast<double>(*std::max_element(durations_us_.begin(), durations_us_.end())) / 1000.0;
  }
  durations_us_.clear();
  return summary;
}

}  // namespace clearway::process
