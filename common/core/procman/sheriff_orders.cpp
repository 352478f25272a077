// SPDX-License-Identifier: BSD-3-Clause
// What a sheriff tells each deputy.
#include <algorithm>

#include "common/core/procman/sheriff.hpp"

namespace clearway::core::procman {
namespace {

constexpr std::int64_t kOrdersPeriodUs = 1'000'000;
// A report that comes this long after orders was made in their knowledge, if they arrived at all.
constexpr std::int64_t kOrdersArriveUs = 200'000;

}  // namespace

std::vector<Orders> Sheriff::OrdersDue(std::int64_t now_us, std::int64_t utime) {
  NoteChanges(now_us);
  std::vector<Orders> due;
  if (mode_ == Mode::kObserve) return due;
  for (auto& [id, deputy] : deputies_) {
    if (!deputy.report || IsHeldBack(deputy, now_us)) continue;
    std::vector<DesiredCommand> wanted = WantedOf(deputy, now_us);
    const bool is_due = deputy.is_changed || !deputy.sent_us ||
                        now_us - *deputy.sent_us >= kOrdersPeriodUs || wanted != deputy.sent;
    if (!is_due) continue;
    deputy.is_changed = false;
    deputy.sent_us = now_us;
    deputy.sent = wanted;
    for (const DesiredCommand& command : wanted) {
      if (!command.force_quit && command.run_id != 0) {
        deputy.told_to_run_us[command.spec.id] = now_us;
      }
    }
    for (auto& [command_id, command] : commands_) {
      if (command.deputy == id && Obstacle(command, now_us) != nullptr) command.is_held = true;
    }
    last_utime_ = std::max(utime, last_utime_ + 1);
    due.push_back(
        {.utime = last_utime_, .deputy_id = id, .sheriff_id = id_, .commands = std::move(wanted)});
  }
  return due;
}

bool Sheriff::IsHeldBack(const KnownDeputy& deputy, std::int64_t now_us) const {
  return std::any_of(commands_.begin(), commands_.end(), [&](const auto& entry) {
    const KnownCommand& command = entry.second;
    return command.deputy == deputy.id && now_us < command.held_back_until_us;
  });
}

std::vector<DesiredCommand> Sheriff::WantedOf(const KnownDeputy& deputy,
                                              std::int64_t now_us) const {
  std::vector<DesiredCommand> wanted;
  for (const auto& [id, command] : commands_) {
    if (command.is_removed) continue;
    const auto listed = deputy.commands.find(id);
    const CommandReport* report =
        listed == deputy.commands.end() ? nullptr : &listed->second.report;
    if (command.deputy != deputy.id) {
      // It is to run elsewhere. Until somebody asks for that it stays as it is; then it is left out
      // of these orders, which ends it here.
      if (report != nullptr && !command.is_asked) {
        wanted.push_back({.spec = report->spec,
                          .run_id = report->run_id,
                          .force_quit = report->pid == 0 && report->run_id == 0});
      }
      continue;
    }
    DesiredCommand desired{
        .spec = command.spec, .run_id = command.run_id, .force_quit = command.force_quit};
    const std::int32_t reported_run_id = report == nullptr ? 0 : report->run_id;
    // To a deputy 0 is a run id like others for a command that does not run: it would start what
    // has run meanwhile.
    if (desired.run_id == 0) desired.run_id = reported_run_id;
    if (desired.run_id == 0 && (report == nullptr || report->pid == 0)) desired.force_quit = true;
    // Not the new run id: a deputy takes it silently from an order to stop, and then never runs it.
    if (Obstacle(command, now_us) != nullptr) {
      desired.run_id = reported_run_id;
      desired.force_quit = true;
    }
    wanted.push_back(desired);
  }
  return wanted;
}

// The deputy on which it has to end first; null when there is none.
const KnownDeputy* Sheriff::Obstacle(const KnownCommand& command, std::int64_t now_us) const {
  if (!command.is_asked || command.force_quit || command.is_removed) return nullptr;
  const KnownDeputy* home = Find(command.deputy);
  if (home != nullptr) {
    const auto listed = home->commands.find(command.spec.id);
    if (listed != home->commands.end() && listed->second.report.pid != 0 &&
        listed->second.report.run_id == command.run_id) {
      return nullptr;
    }
  }
  for (const auto& [id, deputy] : deputies_) {
    if (id == command.deputy) continue;
    const auto listed = deputy.commands.find(command.spec.id);
    const auto told = deputy.told_to_run_us.find(command.spec.id);
    // Orders may have started it there since the report that we know.
    const bool was_told =
        told != deputy.told_to_run_us.end() && deputy.heard_us < told->second + kOrdersArriveUs;
    if (listed == deputy.commands.end() && !was_told) continue;
    const bool may_run =
        was_told || listed->second.report.pid != 0 || listed->second.report.spec.auto_respawn;
    if (!IsHeard(id, now_us) && (!may_run || command.is_forced)) continue;
    return &deputy;
  }
  return nullptr;
}

}  // namespace clearway::core::procman
