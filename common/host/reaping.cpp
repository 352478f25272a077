// SPDX-License-Identifier: BSD-3-Clause
#include "common/host/reaping.hpp"

#include <cerrno>
#include <stdexcept>
#include <sys/prctl.h>
#include <sys/wait.h>

#include "common/host/proc_file.hpp"

namespace clearway::host {

std::vector<Exit> ReapAll() {
  std::vector<Exit> exits;
  while (true) {
    int status = 0;
    const pid_t pid = waitpid(-1, &status, WNOHANG);
    if (pid < 0 && errno == EINTR) continue;
    if (pid <= 0) return exits;
    exits.push_back({pid, status});
  }
}

void BecomeSubreaper() {
  if (prctl(PR_SET_CHILD_SUBREAPER, 1, 0, 0, 0) != 0) {
    throw std::runtime_error(WithReason("cannot become the reaper of orphaned descendants"));
  }
}

}  // namespace clearway::host
