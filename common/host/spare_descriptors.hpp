// SPDX-License-Identifier: BSD-3-Clause
#pragma once

namespace clearway::host {

/// Descriptors that are kept for what must not fail: signals, a look at all processes, the bus.
inline constexpr int kSpareDescriptors = 32;

/// Whether this process may open descriptors for less than that: more than the spare ones are left
/// below its limit (RLIMIT_NOFILE). Two system calls and a bit.
[[nodiscard]] bool HasDescriptorsToSpare();

}  // namespace clearway::host
