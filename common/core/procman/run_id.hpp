// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <limits>

namespace clearway::core::procman {

/// The run id after `run_id`: 1, 2, ... and after the last one 1 again; 0 means "leave it alone" on
/// the wire and is never given, nor is a negative one, whatever a deputy reports.
[[nodiscard]] constexpr std::int32_t NextRunId(std::int32_t run_id) {
  return run_id < 0 || run_id == std::numeric_limits<std::int32_t>::max() ? 1 : run_id + 1;
}

}  // namespace clearway::core::procman
