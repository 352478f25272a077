// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <vector>

#include "tools/doctor/heard.hpp"
#include "tools/doctor/network_checks.hpp"

namespace clearway::doctor {

struct BusFacts {
  std::vector<LoopBack> loop_backs;  ///< Of each bus, in order.
  Heard heard;                       ///< On all of them.
};

/// Sends on a channel of its own (CLEARWAY_DOCTOR) on each bus and asks deputies to report, then
/// listens for `listen_us`.
[[nodiscard]] BusFacts ListenTo(const std::vector<Bus>& buses, std::int64_t listen_us);

}  // namespace clearway::doctor
