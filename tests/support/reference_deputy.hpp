// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "common/core/procman/orders.hpp"

namespace clearway::test {

/// What the reference procman's deputy does with orders, in memory: no process is started, time is
/// an argument [us]. It has no timers of its own for SIGKILL, and a restart needs two orders.
/// A command's text is what its process would do:
///   "run"          runs until it is signalled, and takes 5 ms to end then
///   "stubborn"     ends by SIGKILL only
///   "end CODE MS"  ends by itself after MS with exit status CODE
class ReferenceDeputy {
 public:
  /// One start of a process.
  struct Run {
    std::string id;
    std::string exec;
    std::int32_t run_id = 0;
    std::int64_t started_us = 0;
    std::int64_t ended_us = -1;  ///< -1: runs.
  };

  explicit ReferenceDeputy(std::string id) : id_(std::move(id)) {}

  [[nodiscard]] const std::string& id() const { return id_; }

  /// `utime` is the deputy's time of day: older orders than a minute are dropped.
  void TakeOrders(const core::procman::Orders& orders, std::int64_t now_us, std::int64_t utime);
  /// Lets processes end and starts them again.
  void Tick(std::int64_t now_us);
  /// Whether a report is due: once for each change, and at 1 Hz.
  [[nodiscard]] bool IsReportDue(std::int64_t now_us);
  [[nodiscard]] core::procman::DeputyReport Report(std::int64_t utime) const;

  /// The host went down and came up: nothing is known any more. Processes are gone.
  void Reboot(std::int64_t now_us);
  /// A process dies as if somebody had killed it.
  void Crash(const std::string& id, std::int64_t now_us);

  [[nodiscard]] bool IsUp(const std::string& id) const;
  [[nodiscard]] bool Knows(const std::string& id) const { return commands_.contains(id); }
  [[nodiscard]] const std::vector<Run>& runs() const { return runs_; }
  [[nodiscard]] int StartsOf(const std::string& id) const;

 private:
  struct Command {
    core::procman::CommandSpec spec;
    std::int32_t pid = 0;
    std::int32_t run_id = 0;
    int exit_code = 0;
    bool should_run = true;
    bool is_removed = false;
    std::int64_t backoff_us = 10'000;
    std::int64_t started_us = 0;
    std::int64_t respawn_us = -1;
    std::int64_t ends_us = -1;
    int end_code = 0;
    std::int64_t signalled_us = -1;
    std::size_t run = 0;  // Index into runs_.
  };

  void Start(Command& command, std::int64_t now_us);
  void Stop(Command& command, std::int64_t now_us);
  void Reap(Command& command, int code, std::int64_t now_us);

  std::string id_;
  std::map<std::string, Command> commands_;
  std::vector<Run> runs_;
  std::int32_t next_pid_ = 1000;
  bool is_changed_ = true;
  std::int64_t reported_us_ = 0;
};

}  // namespace clearway::test
