// SPDX-License-Identifier: BSD-3-Clause
// What a sheriff takes from deputies.
#include <algorithm>
#include <utility>

#include "common/core/procman/run_id.hpp"
#include "common/core/procman/sheriff.hpp"

namespace clearway::core::procman {
namespace {

// A report that is older than the one before it by less than this came out of order; by more: the
// sender's clock was set back, or it is another sender or another pass of a log.
constexpr std::int64_t kReorderedUs = 2'000'000;
// Two such steps within this: there are two senders.
constexpr std::int64_t kTwoSendersUs = 10'000'000;
// The longest pause of the reference deputy between two starts is half of this.
constexpr std::int64_t kReferencePauseUs = 2'000'000;
constexpr std::int64_t kHoldMarginUs = 1'000'000;

std::int32_t StartsOf(const KnownDeputy& deputy, const std::string& command) {
  const auto health = deputy.healths.find(command);
  return health == deputy.healths.end() ? -1 : health->second.starts;
}

// Whether the deputy's health, which came before this report, is about what this report shows and
// not about the run that the one before it showed.
bool KnowsThisRun(const ReportedCommand& before,
                  const CommandReport& report,
                  const KnownDeputy& deputy) {
  const auto health = deputy.healths.find(report.spec.id);
  if (health == deputy.healths.end()) return false;
  if (report.pid != 0) return before.starts >= 0 && health->second.starts != before.starts;
  const bool is_down = health->second.state != CommandState::kRunning &&
                       health->second.state != CommandState::kStopping;
  return is_down && before.report.pid != 0 && deputy.health_us > deputy.heard_us;
}

// What this report says of a command, and what the ones before it add.
ReportedCommand Follow(const ReportedCommand* before,
                       const CommandReport& report,
                       const KnownDeputy& deputy,
                       std::int64_t now_us) {
  if (before != nullptr && before->report.pid == report.pid &&
      before->report.run_id == report.run_id) {
    ReportedCommand same = *before;
    same.report = report;
    return same;
  }
  ReportedCommand next{.report = report};
  const bool is_same_run = before != nullptr && before->report.run_id == report.run_id;
  next.since_us = now_us;
  next.was_seen_down = before != nullptr || deputy.report.has_value();
  next.was_seen_up = report.pid != 0 || (is_same_run && before->was_seen_up);
  if (is_same_run) next.deaths = before->deaths + (before->report.pid != 0 ? 1 : 0);
  next.is_health_old = before != nullptr && !KnowsThisRun(*before, report, deputy);
  next.starts = before != nullptr && (next.is_health_old || report.pid == 0)
                    ? before->starts
                    : StartsOf(deputy, report.spec.id);
  return next;
}

}  // namespace

bool Sheriff::IsInScope(const std::string& deputy) const {
  return scope_ == Scope::kBus || std::any_of(deployment_.commands.begin(),
                                              deployment_.commands.end(),
                                              [&](const auto& c) { return c.deputy == deputy; });
}

void Sheriff::OnReport(const DeputyReport& report, std::int64_t now_us) {
  if (report.deputy_id.empty() || !IsInScope(report.deputy_id)) return;
  if (deputies_.size() >= kMaxDeputies && !deputies_.contains(report.deputy_id)) return;
  KnownDeputy& deputy = deputies_[report.deputy_id];
  deputy.id = report.deputy_id;
  if (deputy.report && report.utime < deputy.report->utime) {
    if (deputy.report->utime - report.utime < kReorderedUs) return;
    deputy.stamps_back = now_us - deputy.stamp_back_us < kTwoSendersUs ? deputy.stamps_back + 1 : 1;
    deputy.stamp_back_us = now_us;
  }
  TakeCommands(deputy, report, now_us);
  deputy.report = report;
  deputy.report->commands.clear();
  deputy.heard_us = now_us;
  // Whoever gave the orders that an observer knows has gone; others may come unheard.
  if (now_us - deputy.orders_us > kOrdersActiveUs) {
    for (auto& [id, command] : commands_) {
      if (command.deputy == deputy.id) command.is_mirrored = false;
    }
  }
  for (const auto& [id, reported] : deputy.commands) TakeOver(deputy, reported, now_us);
  for (auto& [id, command] : commands_) {
    if (command.deputy == deputy.id && command.waits_to_restart) {
      Resolve(command, *command.waits_to_restart ? Wish::kRestart : Wish::kStart);
      deputy.is_changed = true;
    }
  }
  RefineByHealth(deputy, now_us);
  TakeWhatTheReportLacks(deputy, now_us);
  NoteChanges(now_us, report.utime);
}

void Sheriff::TakeCommands(KnownDeputy& deputy, const DeputyReport& report, std::int64_t now_us) {
  std::map<std::string, ReportedCommand> commands;
  for (const CommandReport& each : report.commands) {
    if (each.spec.id.empty()) continue;
    const auto before = deputy.commands.find(each.spec.id);
    const ReportedCommand* known = before == deputy.commands.end() ? nullptr : &before->second;
    commands[each.spec.id] = Follow(known, each, deputy, now_us);
    // The second half of a restart, which the reference deputy does only when it is told again.
    const auto command = commands_.find(each.spec.id);
    if (known != nullptr && known->report.pid != 0 && each.pid == 0 && command != commands_.end() &&
        command->second.run_id != each.run_id) {
      deputy.is_changed = true;
    }
  }
  deputy.commands = std::move(commands);
}

// Nothing that runs is restarted: what nobody asked us for goes on as it is.
void Sheriff::TakeOver(const KnownDeputy& deputy,
                       const ReportedCommand& reported,
                       std::int64_t now_us) {
  const CommandReport& report = reported.report;
  if (commands_.size() >= kMaxCommands && !commands_.contains(report.spec.id)) return;
  const auto [entry, is_new] = commands_.try_emplace(report.spec.id);
  KnownCommand& command = entry->second;
  const auto is_listed_at_home = [&] {
    const KnownDeputy* home = Find(command.deputy);
    return home != nullptr && home->commands.contains(report.spec.id);
  };
  if (is_new || (!command.is_in_file && !command.is_asked && !is_listed_at_home())) {
    command = {.spec = report.spec, .deputy = deputy.id, .noted = command.noted};
  }
  if (command.deputy != deputy.id) return;
  if (report.pid != 0 && report.spec.exec != command.spec.exec) {
    command.old_exec_pid = report.pid;
    command.old_exec = report.spec.exec;
  } else if (report.pid != command.old_exec_pid) {
    command.old_exec_pid = 0;
  }
  TakeRunId(deputy, reported, now_us);
}

void Sheriff::TakeRunId(const KnownDeputy& deputy,
                        const ReportedCommand& reported,
                        std::int64_t now_us) {
  const CommandReport& report = reported.report;
  KnownCommand& command = commands_.at(report.spec.id);
  if (mode_ == Mode::kObserve) {
    if (!command.is_in_file) command.spec = report.spec;
    if (command.is_mirrored || command.run_id == report.run_id) return;
    command.run_id = report.run_id;
    if (report.pid != 0) command.force_quit = command.was_stopped = false;
    return;
  }
  if (command.run_id == 0) command.run_id = report.run_id;
  if (report.run_id != command.run_id || report.run_id == 0) return;
  if (report.pid != 0) {
    command.is_held = false;
    return;
  }
  // We ended it there ourselves, since it ran elsewhere too: the run that was asked for is to come.
  if (command.is_held) {
    command.is_held = false;
    command.run_id = NextRunId(command.run_id);
    return;
  }
  // A deputy that is started anew is not to run again what ended by itself, nor what we found
  // stopped. Where the deputy tells its health, that decides: it may be about to start it again;
  // the reference's does so within a second.
  const bool is_down_for_good =
      command.spec.auto_respawn
          ? !command.is_asked && now_us - reported.since_us > kReferencePauseUs
          : true;
  if (!deputy.health && is_down_for_good) command.force_quit = true;
}

void Sheriff::TakeWhatTheReportLacks(KnownDeputy& deputy, std::int64_t now_us) {
  std::vector<std::string> gone;
  for (auto& [id, command] : commands_) {
    if (command.deputy != deputy.id || deputy.commands.contains(id)) continue;
    if (mode_ == Mode::kObserve) {
      const bool is_unknown_here = command.is_removed || !command.is_mirrored;
      command.is_removed = command.is_removed && !command.is_in_file;
      if (is_unknown_here && !command.is_in_file) gone.push_back(id);
    } else if (command.is_removed && !IsListed(id)) {
      gone.push_back(id);
    }
  }
  for (const std::string& id : gone) {
    const Status noted = commands_.at(id).noted.value_or(Status::kUnknown);
    Note({.utime = deputy.report ? deputy.report->utime : 0,
          .deputy = deputy.id,
          .command = id,
          .from = std::string(WordsFor(noted)),
          .to = {},
          .before = noted,
          .text = "removed"});
    commands_.erase(id);
    // An observer follows what has moved.
    for (const auto& [other, known] : deputies_) {
      const auto listed = known.commands.find(id);
      if (listed != known.commands.end()) TakeOver(known, listed->second, now_us);
    }
  }
}

bool Sheriff::IsListed(const std::string& command) const {
  return std::any_of(deputies_.begin(), deputies_.end(), [&](const auto& entry) {
    return entry.second.commands.contains(command);
  });
}

void Sheriff::OnHealth(const DeputyHealth& health, std::int64_t utime, std::int64_t now_us) {
  if (health.deputy_id.empty() || !IsInScope(health.deputy_id)) return;
  if (deputies_.size() >= kMaxDeputies && !deputies_.contains(health.deputy_id)) return;
  KnownDeputy& deputy = deputies_[health.deputy_id];
  deputy.id = health.deputy_id;
  deputy.health = health;
  deputy.health->commands.clear();
  deputy.health_us = now_us;
  deputy.healths.clear();
  for (const CommandHealthReport& each : health.commands) deputy.healths[each.id] = each;
  for (auto& [id, reported] : deputy.commands) {
    // The first one after a report is about the same run; later ones may be ahead of the reports.
    if (reported.is_health_old || reported.starts < 0) reported.starts = StartsOf(deputy, id);
    reported.is_health_old = false;
  }
  RefineByHealth(deputy, now_us);
  NoteChanges(now_us, utime);
}

void Sheriff::RefineByHealth(KnownDeputy& deputy, std::int64_t now_us) {
  for (const auto& [id, health] : deputy.healths) {
    const auto known = commands_.find(id);
    const auto listed = deputy.commands.find(id);
    if (known == commands_.end() || listed == deputy.commands.end()) continue;
    KnownCommand& command = known->second;
    const CommandReport& report = listed->second.report;
    if (command.deputy != deputy.id || listed->second.is_health_old) continue;
    const bool is_down = report.pid == 0 && report.run_id != 0;
    if (health.state == CommandState::kEnded && is_down && report.run_id == command.run_id &&
        mode_ == Mode::kCommand) {
      command.force_quit = true;
    }
    if (command.is_asked || command.is_mirrored) continue;
    // Somebody stopped it: it is to stay so.
    if (health.state == CommandState::kStopped && is_down) {
      command.force_quit = true;
      command.was_stopped = true;
    }
    // Whether it is to stay down or to start again its deputy knows and we do not: let it finish.
    if (health.state != CommandState::kStopping) {
      command.held_back_until_us = -1;
    } else if (command.held_back_until_us == 0) {
      command.held_back_until_us =
          now_us + kHoldMarginUs +
          static_cast<std::int64_t>(report.spec.stop_time_allowed_s * 1e6F);
    }
  }
}

bool Sheriff::HasTwoSenders(const KnownDeputy& deputy, std::int64_t now_us) {
  return deputy.stamps_back >= 2 && now_us - deputy.stamp_back_us < kTwoSendersUs;
}

}  // namespace clearway::core::procman
