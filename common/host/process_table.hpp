// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <optional>
#include <string_view>
#include <sys/types.h>
#include <utility>
#include <vector>

namespace clearway::host {

/// One process, as /proc/PID/stat has it.
struct ProcessEntry {
  pid_t pid = 0;
  pid_t ppid = 0;
  pid_t pgrp = 0;
  pid_t session = 0;
  char state = '?';               ///< R, S, D, Z (ended, not yet reaped), T (stopped), ...
  std::uint64_t start_ticks = 0;  ///< Since the host's start; with the pid, who it is.
  std::uint64_t cpu_ticks = 0;    ///< User and system time so far, all threads.
  std::int64_t vsize_bytes = 0;
  std::int64_t rss_bytes = 0;
};

/// Seconds of CPU time or since the host's start.
[[nodiscard]] double SecondsOf(std::uint64_t ticks);

/// The text of /proc/PID/stat; a process's name may hold anything. Nothing when it is not whole.
[[nodiscard]] std::optional<ProcessEntry> ParseStat(std::string_view text);

/// Nothing when there is no such process.
[[nodiscard]] std::optional<ProcessEntry> ReadProcess(pid_t pid);

/// Whether the process was started with this variable, "NAME=value". False when it is not to be
/// known: it is gone or another user's. A program may write over its environment.
[[nodiscard]] bool HasVariable(pid_t pid, std::string_view variable);

/// All processes of the host. Not of one instant: each is read by itself.
class ProcessTable {
 public:
  /// One pass over /proc; about 10 us a process. Throws std::runtime_error when there is no /proc.
  [[nodiscard]] static ProcessTable Read();

  ProcessTable() = default;
  /// In any order; of several with one pid, one counts.
  explicit ProcessTable(std::vector<ProcessEntry> entries);

  /// By ascending pid.
  [[nodiscard]] const std::vector<ProcessEntry>& entries() const { return entries_; }

  /// nullptr: not there. Valid as long as the table.
  [[nodiscard]] const ProcessEntry* Find(pid_t pid) const;

  /// Children, their children and so on, by ascending pid, without the process itself. A process
  /// whose parent ended is its reaper's child and no longer among them. O(log n) each.
  [[nodiscard]] std::vector<ProcessEntry> Descendants(pid_t pid) const;

 private:
  std::vector<ProcessEntry> entries_;
  std::vector<std::pair<pid_t, std::size_t>> by_parent_;  // Parent's pid, index of the child.
};

}  // namespace clearway::host
