// SPDX-License-Identifier: BSD-3-Clause
#include "common/core/procman/sheriff.hpp"

#include <algorithm>
#include <stdexcept>
#include <utility>

#include "common/core/procman/run_id.hpp"

namespace clearway::core::procman {

Sheriff::Sheriff(std::string sheriff_id, Mode mode, Scope scope)
    : id_(std::move(sheriff_id)), mode_(mode), scope_(scope) {}

void Sheriff::SetMode(Mode mode) {
  mode_ = mode;
  for (auto& [id, command] : commands_) {
    command.is_mirrored = false;
    command.is_asked = false;
    command.waits_to_restart.reset();
    if (command.is_in_file) command.is_removed = false;
  }
}

void Sheriff::Load(Deployment deployment, std::int64_t now_us) {
  deployment_ = std::move(deployment);
  std::erase_if(deputies_, [this](const auto& entry) { return !IsInScope(entry.first); });
  for (auto& [id, command] : commands_) command.is_in_file = false;
  for (std::size_t i = 0; i < deployment_.commands.size(); ++i) {
    const DeployedCommand& deployed = deployment_.commands[i];
    const auto [entry, is_new] = commands_.try_emplace(deployed.spec.id);
    KnownCommand& command = entry->second;
    // What was wanted was wanted of the other deputy.
    if (command.deputy != deployed.deputy) command = {.noted = command.noted};
    command.spec = deployed.spec;
    command.deputy = deployed.deputy;
    command.is_in_file = true;
    command.is_removed = false;
    command.position = i;
  }
  std::erase_if(commands_, [this](const auto& entry) {
    return !entry.second.is_in_file && !IsListed(entry.first);
  });
  for (auto& [id, deputy] : deputies_) {
    for (const auto& [command, reported] : deputy.commands) TakeOver(deputy, reported, now_us);
    RefineByHealth(deputy, now_us);
  }
  NoteChanges(now_us);
}

std::vector<std::string> Sheriff::Targeted(const Target& target, Extent extent) const {
  const bool only_file = extent == Extent::kStart && target.kind == Target::Kind::kEverything &&
                         !deployment_.commands.empty();
  std::vector<std::string> ids;
  for (const KnownCommand* command : InOrder()) {
    if (only_file && !command->is_in_file) continue;
    if (IsTargeted(command->spec, target)) ids.push_back(command->spec.id);
  }
  return ids;
}

int Sheriff::Act(const Target& target,
                 Extent extent,
                 std::int64_t now_us,
                 const std::function<void(KnownCommand&)>& action) {
  if (mode_ == Mode::kObserve) throw std::logic_error("an observer gives no orders");
  const std::vector<std::string> ids = Targeted(target, extent);
  for (const std::string& id : ids) {
    KnownCommand& command = commands_.at(id);
    command.is_asked = true;
    command.asked_us = now_us;
    command.held_back_until_us = -1;
    command.is_held = false;
    action(command);
    MarkChanged(command);
  }
  NoteChanges(now_us);
  return static_cast<int>(ids.size());
}

int Sheriff::Start(const Target& target, std::int64_t now_us, bool force) {
  return Run(target, Wish::kStart, now_us, force);
}

int Sheriff::Restart(const Target& target, std::int64_t now_us, bool force) {
  return Run(target, Wish::kRestart, now_us, force);
}

int Sheriff::Run(const Target& target, Wish wish, std::int64_t now_us, bool force) {
  return Act(target, Extent::kStart, now_us, [&](KnownCommand& command) {
    command.is_forced = force;
    command.is_removed = false;
    // What seems to run may have ended since the last report: then the next one tells.
    const bool is_done = IsHeard(command.deputy, now_us) && Resolve(command, wish);
    if (!is_done) command.waits_to_restart = wish == Wish::kRestart;
  });
}

int Sheriff::Stop(const Target& target, std::int64_t now_us) {
  return Act(target, Extent::kStop, now_us, [&](KnownCommand& command) {
    const Copy copy = CopyOn(Find(command.deputy), command.spec.id, now_us);
    command.stop_needs_time = !command.force_quit && !copy.is_told && copy.reported != nullptr &&
                              copy.reported->report.pid == 0 && copy.reported->report.run_id != 0 &&
                              command.spec.auto_respawn;
    command.force_quit = true;
    command.was_stopped = true;
    command.waits_to_restart.reset();
  });
}

int Sheriff::Remove(const Target& target, std::int64_t now_us) {
  const int count = Act(target, Extent::kStop, now_us, [](KnownCommand& command) {
    command.is_removed = true;
    command.was_stopped = true;
    command.waits_to_restart.reset();
  });
  // Of what no deputy lists nothing is left to be done.
  for (auto& [id, deputy] : deputies_) TakeWhatTheReportLacks(deputy, now_us);
  std::erase_if(commands_, [this](const auto& entry) {
    return entry.second.is_removed && Find(entry.second.deputy) == nullptr;
  });
  return count;
}

// False: nothing is to be done, since it runs. @pre the command's deputy has reported.
bool Sheriff::Resolve(KnownCommand& command, Wish wish) {
  const KnownDeputy& deputy = *Find(command.deputy);
  const auto listed = deputy.commands.find(command.spec.id);
  const CommandReport none;
  const CommandReport& report = listed == deputy.commands.end() ? none : listed->second.report;
  const auto health = deputy.healths.find(command.spec.id);
  const bool is_ending = health != deputy.healths.end() && !listed->second.is_health_old &&
                         health->second.state == CommandState::kStopping;
  const bool is_on_its_way = command.run_id != report.run_id && command.run_id != 0;
  command.waits_to_restart.reset();
  const bool is_wanted = !command.force_quit;
  command.force_quit = false;
  command.was_stopped = false;
  command.stop_needs_time = false;
  if (wish == Wish::kStart && is_wanted) {
    if (is_on_its_way) return true;
    if (report.pid != 0 && !is_ending) return false;
  }
  // Neither the id that its deputy told nor one that may be under way to it.
  const std::int32_t ordered = command.run_id;
  command.run_id = NextRunId(report.run_id);
  if (command.run_id == ordered && is_on_its_way) command.run_id = NextRunId(ordered);
  return true;
}

void Sheriff::MarkChanged(const KnownCommand& command) {
  for (auto& [id, deputy] : deputies_) {
    if (id == command.deputy || deputy.commands.contains(command.spec.id)) deputy.is_changed = true;
  }
}

void Sheriff::RepeatOrders() {
  for (auto& [id, deputy] : deputies_) deputy.is_changed = true;
}

void Sheriff::Tick(std::int64_t now_us) {
  NoteChanges(now_us);
}

}  // namespace clearway::core::procman
