// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <string>

#include "common/core/procman/sheriff_view.hpp"
#include "processes/procman_sheriff/screen_model.hpp"

namespace clearway::screen {

/// The time of day here, "12:34:56".
[[nodiscard]] std::string Clock(std::int64_t utime);

/// "clusterer: Running -> Failed: exited with 1".
[[nodiscard]] std::string ChangeInWords(const core::procman::Change& change);

/// "stop group sense (3 commands)". @pre the intent is an order.
[[nodiscard]] std::string OrderInWords(const Intent& intent, int commands);

}  // namespace clearway::screen
