// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <clearway/drive_permit_t.hpp>

#include "common/core/guard/stop_guard.hpp"

namespace clearway::messages {

/// Limits, reason and cause of a permit. Stamp, numbering, validity, text and what concerns the
/// input are left to the caller.
[[nodiscard]] drive_permit_t ToLcm(const core::Permit& permit);

/// A permit's reason in words.
[[nodiscard]] const char* ReasonText(core::PermitReason reason);

}  // namespace clearway::messages
