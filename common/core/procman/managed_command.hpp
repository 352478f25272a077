// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "common/core/procman/command_host.hpp"
#include "common/core/procman/health_watch.hpp"
#include "common/core/procman/orders.hpp"
#include "common/core/procman/respawn_policy.hpp"

namespace clearway::core::procman {

/// One command of a deputy: from orders, ends of processes, statuses and time to starts and
/// signals. Time is an argument [us, monotonic]. Rules of the reference procman, except that
/// SIGKILL, respawn and the second half of a restart need no further orders.
class ManagedCommand {
 public:
  ManagedCommand(const CommandSpec& spec,
                 const RespawnConfig& respawn,
                 const HealthConfig& health,
                 CommandHost& host);

  /// What a sheriff wants of it. Repeating an order changes nothing.
  void Obey(const DesiredCommand& desired, std::int64_t now_us);

  /// The sheriff wants it no more: it ends, and may be forgotten then.
  void Remove(std::int64_t now_us);
  [[nodiscard]] bool is_removed() const { return is_removed_; }
  [[nodiscard]] bool MayBeForgotten() const { return is_removed_ && pid_ == 0; }

  /// From now on it is not started again: the deputy stops.
  void KeepFromStarting();
  /// Ends it for that reason.
  void ShutDown(std::int64_t now_us);
  /// Without waiting for its stop time any more.
  void Kill();

  /// Its process has ended, and nothing that came from it is left. `wait_status` as of wait().
  void OnExit(int wait_status, std::int64_t now_us);

  void OnStatus(const StatusWord& word, std::int64_t now_us);

  /// Does what is due.
  void Tick(std::int64_t now_us);
  [[nodiscard]] std::optional<std::int64_t> NextDue() const;

  [[nodiscard]] const CommandSpec& spec() const { return spec_; }
  [[nodiscard]] std::int32_t pid() const { return pid_; }
  [[nodiscard]] std::int64_t started_us() const { return started_us_; }
  [[nodiscard]] const std::string& status_channel() const { return status_channel_; }

  /// Without what the machine knows (processor, memory).
  [[nodiscard]] CommandReport Report() const;
  [[nodiscard]] CommandHealthReport Health(std::int64_t now_us) const;

  /// What is to be kept for the deputy's next life: what has ended by itself stays ended.
  [[nodiscard]] DesiredCommand ToKeep() const;

 private:
  void TakeSpec(const CommandSpec& spec);
  void Start(std::int64_t now_us);
  void NotStarted(const StartOutcome& outcome, std::int64_t now_us);
  void Stop(std::int64_t now_us, const std::string& why);
  void AfterDeath(std::int64_t lived_us, std::int64_t now_us);
  void RestartWhenUnhealthy(std::int64_t now_us);
  void Rest(CommandState state, std::string text);

  CommandSpec spec_;
  RespawnPolicy respawn_;
  HealthConfig health_config_;
  CommandHost& host_;

  std::int32_t desired_run_id_ = 0;
  std::int32_t run_id_ = 0;
  bool should_run_ = false;
  bool is_removed_ = false;
  bool was_unhealthy_ = false;     // It is being stopped for that.
  bool ends_with_deputy_ = false;  // And for no other reason.

  CommandState state_ = CommandState::kStopped;
  std::string text_;
  std::string spec_problem_;
  std::int32_t pid_ = 0;
  int exit_code_ = 0;
  int starts_ = 0;
  std::int64_t started_us_ = 0;
  std::optional<std::int64_t> kill_at_us_;   // While it is being stopped.
  std::optional<std::int64_t> start_at_us_;  // While it backs off.
  std::optional<std::int64_t> restart_unhealthy_us_;
  std::string status_channel_;
  std::optional<HealthWatch> health_;
};

/// How a process ended, in words: "exited with 1", "killed by signal 9".
[[nodiscard]] std::string DescribeExit(int wait_status);

}  // namespace clearway::core::procman
