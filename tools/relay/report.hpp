// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "tools/relay/hub.hpp"

namespace clearway::relay {

/// One line of JSON without its end: `ports`, `directions`, `channels`, `delayed`. Counts are since
/// the start; `mbit_per_s` and `messages_per_s` are over the interval. `kernel_drops` are, for each
/// port, the frames that came faster than they were read.
[[nodiscard]] std::string FormatStatistics(const Hub& hub,
                                           const std::vector<std::uint64_t>& kernel_drops,
                                           double interval_s);

}  // namespace clearway::relay
