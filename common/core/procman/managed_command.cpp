// SPDX-License-Identifier: BSD-3-Clause
#include "common/core/procman/managed_command.hpp"

#include <algorithm>
#include <cmath>
#include <csignal>
#include <cstring>
#include <sys/wait.h>
#include <utility>

namespace clearway::core::procman {
namespace {

constexpr int kLastSignal = 64;
constexpr float kLongestStopTime_s = 3600.0F;
// SIGKILL is repeated: a process may have been born between two looks.
constexpr std::int64_t kKillAgainUs = 500'000;
// Where no process was made sheriffs see an error all the same, as wait() would give it: that of a
// shell for a file that may not be run, and the reference's for one that cannot be.
constexpr int kRefusedExitCode = 126 << 8;
constexpr int kFailedExitCode = 255 << 8;

std::int64_t StopTimeUs(const CommandSpec& spec) {
  return static_cast<std::int64_t>(spec.stop_time_allowed_s * 1e6F);
}

}  // namespace

std::string DescribeExit(int wait_status) {
  if (!WIFSIGNALED(wait_status)) return "exited with " + std::to_string(WEXITSTATUS(wait_status));
  const char* const name = sigabbrev_np(WTERMSIG(wait_status));
  return std::string("killed by ") +
         (name != nullptr ? std::string("SIG") + name
                          : "signal " + std::to_string(WTERMSIG(wait_status))) +
         (WCOREDUMP(wait_status) ? ", core dumped" : "");
}

ManagedCommand::ManagedCommand(const CommandSpec& spec,
                               const RespawnConfig& respawn,
                               const HealthConfig& health,
                               CommandHost& host)
    : respawn_(respawn), health_config_(health), host_(host) {
  TakeSpec(spec);
}

// Values that make no sense come from outside: they are replaced by procman's defaults and named.
void ManagedCommand::TakeSpec(const CommandSpec& spec) {
  spec_ = spec;
  spec_problem_.clear();
  const CommandSpec defaults;
  if (spec.stop_signal < 1 || spec.stop_signal > kLastSignal) {
    spec_problem_ =
        "stop_signal " + std::to_string(spec.stop_signal) + " is no signal: SIGINT is used";
    spec_.stop_signal = defaults.stop_signal;
  }
  if (!(spec.stop_time_allowed_s >= 0.0F && spec.stop_time_allowed_s <= kLongestStopTime_s)) {
    spec_problem_ = "stop_time_allowed is not in [0, 3600] s: 7 s are used";
    spec_.stop_time_allowed_s = defaults.stop_time_allowed_s;
  }
}

void ManagedCommand::Obey(const DesiredCommand& desired, std::int64_t now_us) {
  if (!(desired.spec == spec_)) TakeSpec(desired.spec);
  is_removed_ = false;
  desired_run_id_ = desired.run_id;
  should_run_ = !desired.force_quit;
  const bool is_new_run = desired.run_id != run_id_ && desired.run_id != 0;
  if (pid_ != 0) {
    if (!should_run_) {
      Stop(now_us, "stopped by order");
    } else if (is_new_run) {
      Stop(now_us, "restarted by order");
    } else if (state_ == CommandState::kStopping && !was_unhealthy_) {
      // The order to stop was taken back before the process ended.
      state_ = CommandState::kRunning;
      text_ = "the order to stop was taken back";
      kill_at_us_.reset();
    }
    return;
  }
  if (!should_run_) {
    if (desired.run_id != 0) run_id_ = desired.run_id;
    if (state_ == CommandState::kBackingOff) Rest(CommandState::kStopped, "stopped by order");
    return;
  }
  if (!is_new_run) return;
  respawn_.Reset();
  run_id_ = desired.run_id;
  Start(now_us);
}

void ManagedCommand::Remove(std::int64_t now_us) {
  is_removed_ = true;
  should_run_ = false;
  if (pid_ != 0) {
    Stop(now_us, "removed by order");
  } else {
    Rest(CommandState::kStopped, "removed by order");
  }
}

void ManagedCommand::KeepFromStarting() {
  if (should_run_ && (pid_ != 0 || state_ == CommandState::kBackingOff)) ends_with_deputy_ = true;
  should_run_ = false;
  if (state_ == CommandState::kBackingOff) Rest(CommandState::kStopped, "the deputy stops");
}

void ManagedCommand::ShutDown(std::int64_t now_us) {
  KeepFromStarting();
  if (pid_ != 0) Stop(now_us, "the deputy stops");
}

void ManagedCommand::Kill() {
  if (pid_ != 0) host_.Signal(pid_, SIGKILL);
}

void ManagedCommand::Start(std::int64_t now_us) {
  start_at_us_.reset();
  exit_code_ = 0;
  health_.reset();
  was_unhealthy_ = false;
  StartOutcome outcome = host_.Start(spec_);
  if (outcome.pid == 0) {
    NotStarted(outcome, now_us);
    return;
  }
  pid_ = outcome.pid;
  started_us_ = now_us;
  ++starts_;
  state_ = CommandState::kRunning;
  text_.clear();
  status_channel_ = std::move(outcome.status_channel);
  restart_unhealthy_us_ = outcome.restart_unhealthy_us;
  if (!status_channel_.empty()) health_.emplace(health_config_, now_us);
  host_.Note(spec_.id, "started, process " + std::to_string(pid_));
}

void ManagedCommand::NotStarted(const StartOutcome& outcome, std::int64_t now_us) {
  host_.Note(spec_.id, "not started: " + outcome.problem);
  exit_code_ = outcome.is_refused ? kRefusedExitCode : kFailedExitCode;
  Rest(CommandState::kRefused, outcome.problem);
  if (!outcome.is_refused && spec_.auto_respawn) AfterDeath(0, now_us);
}

void ManagedCommand::Stop(std::int64_t now_us, const std::string& why) {
  if (state_ == CommandState::kStopping) return;
  state_ = CommandState::kStopping;
  text_ = why;
  kill_at_us_ = now_us + StopTimeUs(spec_);
  host_.Note(spec_.id, why);
  host_.Signal(pid_, spec_.stop_signal);
}

void ManagedCommand::Rest(CommandState state, std::string text) {
  state_ = state;
  text_ = std::move(text);
  start_at_us_.reset();
  kill_at_us_.reset();
}

void ManagedCommand::OnExit(int wait_status, std::int64_t now_us) {
  const bool was_told = state_ == CommandState::kStopping && !was_unhealthy_;
  const std::int64_t lived_us =
      was_unhealthy_ && !(health_ && health_->was_ready()) ? 0 : now_us - started_us_;
  host_.Note(spec_.id, DescribeExit(wait_status));
  pid_ = 0;
  exit_code_ = wait_status;
  health_.reset();
  Rest(CommandState::kStopped, DescribeExit(wait_status));
  if (!should_run_) {
    if (desired_run_id_ != 0 && !is_removed_) run_id_ = desired_run_id_;
    return;
  }
  if (desired_run_id_ != run_id_ && desired_run_id_ != 0) {
    respawn_.Reset();
    run_id_ = desired_run_id_;
    Start(now_us);
  } else if (spec_.auto_respawn || was_unhealthy_) {
    if (was_told) {
      Start(now_us);
    } else {
      AfterDeath(lived_us, now_us);
    }
  } else {
    state_ = CommandState::kEnded;
  }
}

void ManagedCommand::AfterDeath(std::int64_t lived_us, std::int64_t now_us) {
  const std::optional<std::int64_t> pause_us = respawn_.OnDeath(lived_us);
  if (!pause_us) {
    Rest(CommandState::kGaveUp,
         text_ + "; gave up after " + std::to_string(respawn_.quick_deaths()) +
             " early ends in a row");
    host_.Note(spec_.id, text_);
    return;
  }
  state_ = CommandState::kBackingOff;
  text_ += "; starts again in " + std::to_string(*pause_us / 1000) + " ms";
  start_at_us_ = now_us + *pause_us;
}

void ManagedCommand::OnStatus(const StatusWord& word, std::int64_t now_us) {
  if (health_) health_->OnStatus(word, now_us);
}

void ManagedCommand::Tick(std::int64_t now_us) {
  if (start_at_us_ && now_us >= *start_at_us_) Start(now_us);
  if (kill_at_us_ && now_us >= *kill_at_us_) {
    host_.Note(spec_.id, "did not end in its time: SIGKILL");
    host_.Signal(pid_, SIGKILL);
    kill_at_us_ = now_us + kKillAgainUs;
  }
  if (health_ && state_ == CommandState::kRunning) {
    health_->Tick(now_us);
    RestartWhenUnhealthy(now_us);
  }
}

void ManagedCommand::RestartWhenUnhealthy(std::int64_t now_us) {
  const auto since_us = health_->unhealthy_since_us();
  if (!since_us || !restart_unhealthy_us_ || now_us - *since_us < *restart_unhealthy_us_) return;
  was_unhealthy_ = true;
  Stop(now_us, "unhealthy, restarted: " + health_->text());
}

std::optional<std::int64_t> ManagedCommand::NextDue() const {
  std::optional<std::int64_t> due_us;
  const auto consider = [&due_us](std::int64_t time_us) {
    due_us = due_us ? std::min(*due_us, time_us) : time_us;
  };
  if (start_at_us_) consider(*start_at_us_);
  if (kill_at_us_) consider(*kill_at_us_);
  if (health_ && state_ == CommandState::kRunning) {
    const auto since_us = health_->unhealthy_since_us();
    if (!since_us) consider(health_->NextDue());
    if (since_us && restart_unhealthy_us_) consider(*since_us + *restart_unhealthy_us_);
  }
  return due_us;
}

CommandReport ManagedCommand::Report() const {
  return {.spec = spec_, .pid = pid_, .run_id = run_id_, .exit_code = pid_ != 0 ? 0 : exit_code_};
}

CommandHealthReport ManagedCommand::Health(std::int64_t now_us) const {
  CommandHealthReport report{.id = spec_.id,
                             .state = state_,
                             .health = CommandHealth::kNotExpected,
                             .text = text_,
                             .starts = starts_,
                             .quick_deaths = respawn_.quick_deaths(),
                             .running_us = pid_ != 0 ? now_us - started_us_ : -1};
  // To a sheriff "stopped" is an order of somebody, which it takes over: this is none, and a later
  // life goes on with it.
  if (ends_with_deputy_ && state_ == CommandState::kStopped) report.state = CommandState::kStopping;
  if (health_) {
    report.health = health_->health();
    if (state_ == CommandState::kRunning) report.text = health_->text();
  }
  if (!spec_problem_.empty()) report.text += (report.text.empty() ? "" : "; ") + spec_problem_;
  return report;
}

DesiredCommand ManagedCommand::ToKeep() const {
  const bool has_ended = state_ == CommandState::kEnded || state_ == CommandState::kGaveUp;
  return {.spec = spec_, .run_id = desired_run_id_, .force_quit = !should_run_ || has_ended};
}

}  // namespace clearway::core::procman
