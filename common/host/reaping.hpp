// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <sys/types.h>
#include <vector>

namespace clearway::host {

/// A child's end.
struct Exit {
  pid_t pid = 0;
  int status = 0;  ///< As wait() gives it: WIFEXITED() and its kin take it apart.
};

/// Reaps all children that have ended, without waiting; also those that were handed to a
/// sub-reaper. Takes the status from whoever else waits for a child of this process.
[[nodiscard]] std::vector<Exit> ReapAll();

/// From now on, descendants whose parent ends become children of this process instead of init's.
/// Throws std::runtime_error.
void BecomeSubreaper();

}  // namespace clearway::host
