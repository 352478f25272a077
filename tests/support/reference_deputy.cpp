// SPDX-License-Identifier: BSD-3-Clause
#include "tests/support/reference_deputy.hpp"

#include <algorithm>
#include <csignal>
#include <set>
#include <sstream>

namespace clearway::test {
namespace {

using core::procman::CommandReport;
using core::procman::DesiredCommand;

constexpr std::int64_t kOldestOrdersUs = 60'000'000;
constexpr std::int64_t kReportPeriodUs = 1'000'000;
constexpr std::int64_t kDyingUs = 5'000;

}  // namespace

void ReferenceDeputy::TakeOrders(const core::procman::Orders& orders,
                                 std::int64_t now_us,
                                 std::int64_t utime) {
  if (orders.deputy_id != id_ || utime - orders.utime > kOldestOrdersUs) return;
  std::set<std::string> ordered;
  for (const DesiredCommand& desired : orders.commands) ordered.insert(desired.spec.id);
  for (auto& [id, command] : commands_) {
    if (ordered.contains(id)) continue;
    command.is_removed = true;
    command.should_run = false;
    is_changed_ = true;
    if (command.pid != 0) Stop(command, now_us);
  }
  std::erase_if(commands_, [](const auto& c) { return c.second.is_removed && c.second.pid == 0; });
  for (const DesiredCommand& desired : orders.commands) {
    const bool is_new = !commands_.contains(desired.spec.id);
    Command& command = commands_[desired.spec.id];  // Rule 1.
    if (is_new || !(command.spec == desired.spec)) is_changed_ = true;
    command.spec = desired.spec;               // Rule 2.
    command.should_run = !desired.force_quit;  // Rule 3.
    command.is_removed = false;
    if (command.pid == 0 && command.run_id != desired.run_id && command.should_run) {  // Rule 4.
      command.run_id = desired.run_id;
      Start(command, now_us);
    } else if (command.pid != 0 && (!command.should_run || (desired.run_id != command.run_id &&
                                                            desired.run_id != 0))) {  // Rule 5.
      Stop(command, now_us);
      is_changed_ = true;
    } else if (desired.run_id != 0) {  // Rule 6.
      command.run_id = desired.run_id;
    }
  }
}

void ReferenceDeputy::Start(Command& command, std::int64_t now_us) {
  const std::int64_t ran_us = now_us - command.started_us;
  if (ran_us < 1'000'000) {
    command.backoff_us = std::min<std::int64_t>(1'000'000, 2 * command.backoff_us);
  } else {
    const std::int64_t shift = std::min<std::int64_t>(ran_us / 1'000'000, 40);
    command.backoff_us = std::max<std::int64_t>(10'000, command.backoff_us >> shift);
  }
  command.pid = next_pid_++;
  command.exit_code = 0;
  command.started_us = now_us;
  command.respawn_us = -1;
  command.signalled_us = -1;
  command.ends_us = -1;
  std::istringstream words(command.spec.exec);
  std::string verb;
  words >> verb;
  if (verb == "end") {
    int status = 0;
    std::int64_t lives_ms = 0;
    words >> status >> lives_ms;
    command.ends_us = now_us + lives_ms * 1000;
    command.end_code = status << 8;
  }
  command.run = runs_.size();
  runs_.push_back({command.spec.id, command.spec.exec, command.run_id, now_us, -1});
  is_changed_ = true;
}

void ReferenceDeputy::Stop(Command& command, std::int64_t now_us) {
  int signal = 0;
  if (command.signalled_us < 0) {
    command.signalled_us = now_us;
    signal = command.spec.stop_signal;
    if (runs_[command.run].exec == "stubborn") return;
  } else {
    const auto allowed_us = static_cast<std::int64_t>(command.spec.stop_time_allowed_s * 1e6F);
    if (now_us - command.signalled_us < allowed_us) return;
    signal = SIGKILL;
  }
  command.ends_us = now_us + kDyingUs;
  command.end_code = signal;
}

void ReferenceDeputy::Reap(Command& command, int code, std::int64_t now_us) {
  runs_[command.run].ended_us = now_us;
  command.pid = 0;
  command.exit_code = code;
  command.ends_us = -1;
  is_changed_ = true;
  if (command.spec.auto_respawn && command.should_run) {
    command.respawn_us = now_us + command.backoff_us;
  }
}

void ReferenceDeputy::Tick(std::int64_t now_us) {
  for (auto& [id, command] : commands_) {
    if (command.pid != 0 && command.ends_us >= 0 && now_us >= command.ends_us) {
      Reap(command, command.end_code, now_us);
    }
    if (command.pid == 0 && command.respawn_us >= 0 && now_us >= command.respawn_us) {
      command.respawn_us = -1;
      if (command.should_run && command.spec.auto_respawn) Start(command, now_us);
    }
  }
  std::erase_if(commands_, [](const auto& c) { return c.second.is_removed && c.second.pid == 0; });
}

bool ReferenceDeputy::IsReportDue(std::int64_t now_us) {
  if (!is_changed_ && now_us - reported_us_ < kReportPeriodUs) return false;
  is_changed_ = false;
  reported_us_ = now_us;
  return true;
}

core::procman::DeputyReport ReferenceDeputy::Report(std::int64_t utime) const {
  core::procman::DeputyReport report;
  report.utime = utime;
  report.deputy_id = id_;
  report.cpu_load = 0.5F;
  for (const auto& [id, command] : commands_) {
    CommandReport each;
    each.spec = command.spec;
    each.pid = command.pid;
    each.run_id = command.run_id;
    each.exit_code = command.exit_code;
    report.commands.push_back(each);
  }
  return report;
}

void ReferenceDeputy::Reboot(std::int64_t now_us) {
  for (Run& run : runs_) {
    if (run.ended_us < 0) run.ended_us = now_us;
  }
  commands_.clear();
  is_changed_ = true;
}

void ReferenceDeputy::Crash(const std::string& id, std::int64_t now_us) {
  Command& command = commands_.at(id);
  if (command.pid != 0) Reap(command, SIGSEGV, now_us);
}

bool ReferenceDeputy::IsUp(const std::string& id) const {
  const auto found = commands_.find(id);
  return found != commands_.end() && found->second.pid != 0;
}

int ReferenceDeputy::StartsOf(const std::string& id) const {
  return static_cast<int>(
      std::count_if(runs_.begin(), runs_.end(), [&](const Run& run) { return run.id == id; }));
}

}  // namespace clearway::test
