// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <sys/types.h>

namespace clearway::host {

/// Signals the process that has this pid and start time, and never another that got its pid since.
/// False: it is gone, or may not be signalled. A process that ended and is not reaped counts as
/// there.
bool SendSignal(pid_t pid, std::uint64_t start_ticks, int signal);

/// Signals the process group of its leader; the leader alone while it has not made its group yet.
/// False as above; where only the leader is gone, signal the others one by one.
/// @pre the leader is a child of this process: nobody else can reap it in between.
bool SendSignalToGroup(pid_t leader, std::uint64_t start_ticks, int signal);

}  // namespace clearway::host
