// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <string>

#include <clearway/drive_permit_t.hpp>

#include "common/core/guard/base_gate.hpp"

namespace clearway::teleop {

/// The one line that an operator sees: what is wished, what is permitted, and why. Text of the
/// permit that is not printable becomes '?'. At most `width` characters.
[[nodiscard]] std::string StatusLine(const core::BaseMotion& wish,
                                     core::GateState permit_state,
                                     const drive_permit_t& permit,
                                     std::size_t width);

}  // namespace clearway::teleop
