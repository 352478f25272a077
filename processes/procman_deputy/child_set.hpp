// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "common/core/procman/allow_list.hpp"
#include "common/host/descriptor.hpp"
#include "common/host/host_load.hpp"
#include "common/host/process_table.hpp"
#include "common/process/live_runtime.hpp"
#include "processes/procman_deputy/machine.hpp"

namespace clearway {

/// Environment of every child: which deputy it belongs to, and which command.
inline constexpr char kDeputyVariable[] = "CLEARWAY_DEPUTY";
inline constexpr char kCommandVariable[] = "CLEARWAY_COMMAND";

/// Variables that a command line may set for the deputy itself: the status channel to watch, and
/// after how many seconds of bad health the command is started anew.
inline constexpr char kStatusChannelVariable[] = "CLEARWAY_STATUS_CHANNEL";
inline constexpr char kRestartUnhealthyVariable[] = "CLEARWAY_RESTART_UNHEALTHY";

/// Where programs are looked for: as execvp() looks, but beside this program first, so that what
/// belongs together is found together.
[[nodiscard]] std::string SearchPath();

/// Processes of this host, each a session of its own on a terminal of its own. What a command
/// starts is watched, too, wherever it hides: by descent, by session, by its environment, and since
/// orphans become this process's children. None of it outlives its command.
class ChildSet final : public Machine {
 public:
  /// `allowed`: what may run; nothing: anything. `deputy_mark` tells this deputy's children from
  /// those of others. Makes this process the one that orphans are given to.
  ChildSet(process::LiveRuntime& runtime,
           std::optional<core::procman::AllowList> allowed,
           std::string deputy_mark);
  ~ChildSet() override;
  ChildSet(const ChildSet&) = delete;
  ChildSet& operator=(const ChildSet&) = delete;

  void SetListener(Listener* listener) override { listener_ = listener; }
  core::procman::StartOutcome Start(const core::procman::CommandSpec& spec) override;
  void Signal(std::int32_t pid, int signal) override;
  [[nodiscard]] std::int32_t CommandPidOf(std::int32_t pid) const override;
  HostUse Sample() override;
  [[nodiscard]] Use UseOf(std::int32_t pid) const override;

  /// Takes in what has ended; to be called on SIGCHLD.
  void Reap();

  /// SIGKILL to what an earlier life of this deputy, which did not end by itself, left behind,
  /// until it is gone, for at most 2 s. Returns how many there were. @pre that life is over.
  int KillLeftovers();

 private:
  struct Child {
    std::string command_id;
    std::uint64_t start_ticks = 0;
    host::Descriptor output;
    std::set<std::pair<pid_t, std::uint64_t>> members;  // Seen so far, with their start times.
    bool had_children = false;
    std::optional<int> wait_status;  // Once it has ended.
    int clean_looks = 0;             // In a row, since then: nothing was left of it.
    std::int64_t ended_us = 0;
    std::uint64_t cpu_ticks = 0;
    Use use;
  };

  [[nodiscard]] std::vector<std::string> EnvironmentOf(const core::procman::ExecLine& line,
                                                       const std::string& command_id) const;
  core::procman::StartOutcome StartLine(const core::procman::ExecLine& line,
                                        const core::procman::CommandSpec& spec);
  void WatchOutput(pid_t pid, const Child& child);
  void ReadOutput(pid_t pid, std::size_t max_bytes);
  [[nodiscard]] bool HasMarks(pid_t pid, const Child& child) const;
  [[nodiscard]] std::vector<host::ProcessEntry> MembersOf(pid_t pid,
                                                          Child& child,
                                                          const host::ProcessTable& table) const;
  [[nodiscard]] std::vector<host::ProcessEntry> UnclaimedOrphans(
      const host::ProcessTable& table) const;
  [[nodiscard]] bool KillRemains(pid_t pid, Child& child, const host::ProcessTable& table);
  void FinishEnded();
  void MeasureChild(pid_t pid, Child& child, const host::ProcessTable& table, double elapsed_s);

  process::LiveRuntime& runtime_;
  std::optional<core::procman::AllowList> allowed_;
  std::string deputy_mark_;
  std::string path_;  // Where programs are looked for.
  Listener* listener_ = nullptr;
  std::map<pid_t, Child> children_;
  host::HostLoad host_load_;
  std::int64_t sampled_us_ = -1;
  bool finish_is_due_ = false;
};

}  // namespace clearway
