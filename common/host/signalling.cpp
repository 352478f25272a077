// SPDX-License-Identifier: BSD-3-Clause
#include "common/host/signalling.hpp"

#include <csignal>
#include <sys/syscall.h>
#include <unistd.h>

#include "common/host/descriptor.hpp"
#include "common/host/process_table.hpp"

namespace clearway::host {

bool SendSignal(pid_t pid, std::uint64_t start_ticks, int signal) {
  if (pid <= 0) return false;
  const Descriptor process(static_cast<int>(syscall(SYS_pidfd_open, pid, 0)));
  if (!process.is_open()) return false;
  // What the descriptor holds is older than this look: if it is the one, the descriptor is, too.
  const auto entry = ReadProcess(pid);
  if (!entry || entry->start_ticks != start_ticks) return false;
  return syscall(SYS_pidfd_send_signal, process.get(), signal, nullptr, 0) == 0;
}

bool SendSignalToGroup(pid_t leader, std::uint64_t start_ticks, int signal) {
  if (leader <= 0) return false;
  const auto entry = ReadProcess(leader);
  if (!entry || entry->start_ticks != start_ticks) return false;
  if (entry->pgrp != leader) return SendSignal(leader, start_ticks, signal);
  return kill(-leader, signal) == 0;
}

}  // namespace clearway::host
