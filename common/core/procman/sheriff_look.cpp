// SPDX-License-Identifier: BSD-3-Clause
// What a sheriff shows.
#include <algorithm>
#include <set>

#include "common/core/procman/sheriff.hpp"

namespace clearway::core::procman {
namespace {

// A program that dies of its arguments or its configuration does so within this.
constexpr std::int64_t kSettledUs = 500'000;
// The reference deputy pauses for 1 s at most before it starts a command again.
constexpr std::int64_t kStopTakenUs = 1'500'000;

void FillIn(CommandView& view, const CommandReport& report) {
  view.pid = report.pid;
  view.run_id = report.run_id;
  view.exit_code = report.exit_code;
  view.cpu_usage = report.cpu_usage;
  view.mem_rss_bytes = report.mem_rss_bytes;
  view.mem_vsize_bytes = report.mem_vsize_bytes;
}

std::string Differences(const KnownCommand& command, const CommandReport& report) {
  std::string names;
  const auto consider = [&names](bool differs, const char* name) {
    if (differs) names += (names.empty() ? "" : ", ") + std::string(name);
  };
  const CommandSpec& told = report.spec;
  consider(told.exec != command.spec.exec, "exec");
  consider(told.group != command.spec.group, "group");
  consider(told.auto_respawn != command.spec.auto_respawn, "auto_respawn");
  consider(told.stop_signal != command.spec.stop_signal, "stop_signal");
  consider(told.stop_time_allowed_s != command.spec.stop_time_allowed_s, "stop_time_allowed");
  return names;
}

void Count(GroupView& group, const CommandView& command) {
  if (command.is_stray) return;
  ++group.commands;
  group.ready += command.is_ready ? 1 : 0;
  group.up += IsUp(command.status) ? 1 : 0;
  group.trouble += IsTrouble(command.status) ? 1 : 0;
  group.unknown += command.status == Status::kUnknown ? 1 : 0;
}

std::vector<GroupView> GroupsOf(const std::vector<CommandView>& commands) {
  std::map<std::string, GroupView> groups;
  groups[""];
  for (const CommandView& command : commands) {
    Count(groups[""], command);
    const std::string& path = command.group;
    for (std::size_t end = 0; !path.empty() && end != std::string::npos;) {
      end = path.find('/', end + 1);
      Count(groups[path.substr(0, end)], command);
    }
  }
  std::vector<GroupView> views;
  for (auto& [path, group] : groups) {
    group.path = path;
    views.push_back(std::move(group));
  }
  return views;
}

}  // namespace

std::vector<const KnownCommand*> Sheriff::InOrder() const {
  std::vector<const KnownCommand*> commands;
  for (const auto& [id, command] : commands_) commands.push_back(&command);
  std::stable_sort(commands.begin(), commands.end(), [](const auto* a, const auto* b) {
    if (a->is_in_file != b->is_in_file) return a->is_in_file;
    return a->is_in_file && a->position < b->position;
  });
  return commands;
}

bool Sheriff::IsSettled(const KnownCommand& command, const Copy& copy, std::int64_t now_us) {
  const std::int64_t for_us = now_us - copy.reported->since_us;
  if (copy.reported->report.pid != 0) {
    return !copy.reported->was_seen_down || for_us >= kSettledUs;
  }
  // Why it is down its deputy may be about to tell.
  if (copy.is_told && copy.health == nullptr && for_us < kStopTakenUs) return false;
  return !command.stop_needs_time || now_us - command.asked_us >= kStopTakenUs;
}

CommandView Sheriff::ViewOf(const KnownCommand& command, std::int64_t now_us) const {
  Judgement judgement = Judge(command, now_us);
  CommandView view{.id = command.spec.id,
                   .group = command.spec.group,
                   .deputy = command.deputy,
                   .exec = command.spec.exec,
                   .auto_respawn = command.spec.auto_respawn,
                   .is_in_file = command.is_in_file,
                   .status = judgement.status,
                   .is_ready = judgement.status == Status::kRunning,
                   .text = std::move(judgement.text),
                   .differs = {},
                   .desired_run_id = command.run_id,
                   .force_quit = command.force_quit,
                   .was_stopped = command.was_stopped};
  Copy copy = CopyOn(Find(command.deputy), command.spec.id, now_us);
  const KnownDeputy* elsewhere = Elsewhere(command);
  if (elsewhere != nullptr && (copy.reported == nullptr || copy.reported->report.pid == 0)) {
    copy = CopyOn(elsewhere, command.spec.id, now_us);
  }
  view.is_settled = true;
  if (copy.reported == nullptr) return view;
  const CommandReport& report = copy.reported->report;
  FillIn(view, report);
  // What ended where it was moved away from says nothing about the run that is wanted now.
  if (copy.deputy == elsewhere && elsewhere != nullptr) view.run_id = 0;
  view.deaths = copy.reported->deaths;
  view.is_settled = IsSettled(command, copy, now_us);
  if (report.pid != 0 && report.pid == command.old_exec_pid) {
    view.differs = "runs \"" + command.old_exec + "\" until it is restarted";
  } else if (const std::string names = Differences(command, report); !names.empty()) {
    view.differs = "its deputy does not know the file's " + names + " yet";
  }
  if (copy.health == nullptr) return view;
  view.starts = copy.health->starts;
  view.deaths = std::max(view.deaths, copy.health->quick_deaths);
  view.dropped_output_bytes = copy.health->dropped_output_bytes;
  if (copy.health->running_us >= 0) {
    view.running_us = copy.health->running_us + (now_us - copy.deputy->health_us);
    view.is_settled = view.is_settled || view.running_us >= kSettledUs ||
                      copy.health->health == CommandHealth::kReady;
  }
  return view;
}

std::optional<CommandView> Sheriff::View(const std::string& command, std::int64_t now_us) const {
  const auto found = commands_.find(command);
  if (found == commands_.end()) return std::nullopt;
  return ViewOf(found->second, now_us);
}

DeputyView Sheriff::ViewOf(const std::string& id, std::int64_t now_us) const {
  DeputyView view;
  view.id = id;
  view.is_in_file = std::any_of(deployment_.commands.begin(),
                                deployment_.commands.end(),
                                [&](const DeployedCommand& c) { return c.deputy == id; });
  const KnownDeputy* deputy = Find(id);
  if (deputy == nullptr) return view;
  view.is_heard = IsHeard(id, now_us);
  view.commands = static_cast<int>(deputy->commands.size());
  if (deputy->report) {
    view.age_us = now_us - deputy->heard_us;
    view.cpu_load = deputy->report->cpu_load;
    view.phys_mem_total_bytes = deputy->report->phys_mem_total_bytes;
    view.phys_mem_free_bytes = deputy->report->phys_mem_free_bytes;
    view.swap_total_bytes = deputy->report->swap_total_bytes;
    view.swap_free_bytes = deputy->report->swap_free_bytes;
  }
  if (deputy->health) {
    view.tells_health = CopyOn(deputy, {}, now_us).is_told;
    view.host = deputy->health->host;
    view.version = deputy->health->version;
    view.config_digest = deputy->health->config_digest;
    view.sheriff_id = deputy->health->sheriff_id;
    view.text = deputy->health->text;
  }
  if (HasTwoSenders(*deputy, now_us)) {
    view.text += (view.text.empty() ? "" : "; ") +
                 std::string("two deputies report under this name, or a log is played");
  }
  return view;
}

Snapshot Sheriff::Look(std::int64_t now_us) const {
  Snapshot snapshot{.file = deployment_.file,
                    .sheriff_id = id_,
                    .is_observer = mode_ == Mode::kObserve,
                    .other = ActiveOther(now_us),
                    .deputies = {},
                    .groups = {},
                    .commands = {}};
  std::set<std::string> deputies;
  for (const DeployedCommand& command : deployment_.commands) deputies.insert(command.deputy);
  for (const auto& [id, deputy] : deputies_) deputies.insert(id);
  for (const std::string& id : deputies) snapshot.deputies.push_back(ViewOf(id, now_us));
  for (const KnownCommand* command : InOrder()) {
    snapshot.commands.push_back(ViewOf(*command, now_us));
    AddStrays(*command, now_us, snapshot.commands);
  }
  snapshot.groups = GroupsOf(snapshot.commands);
  return snapshot;
}

// Copies on other deputies beside the one that the command's own line shows.
void Sheriff::AddStrays(const KnownCommand& command,
                        std::int64_t now_us,
                        std::vector<CommandView>& views) const {
  const Copy home = CopyOn(Find(command.deputy), command.spec.id, now_us);
  const bool shows_home = home.reported != nullptr && home.reported->report.pid != 0;
  const KnownDeputy* shown = shows_home ? home.deputy : Elsewhere(command);
  for (const auto& [id, deputy] : deputies_) {
    const Copy copy = CopyOn(&deputy, command.spec.id, now_us);
    if (id == command.deputy || &deputy == shown) continue;
    if (copy.reported == nullptr || copy.reported->report.pid == 0) continue;
    Judgement judgement = JudgeCopy({.spec = command.spec}, copy, now_us);
    if (!IsHeard(id, now_us)) judgement = {Status::kUnknown, "deputy " + id + " is silent"};
    CommandView view{.id = command.spec.id,
                     .group = command.spec.group,
                     .deputy = id,
                     .exec = copy.reported->report.spec.exec,
                     .auto_respawn = copy.reported->report.spec.auto_respawn,
                     .is_stray = true,
                     .status = judgement.status,
                     .is_ready = judgement.status == Status::kRunning,
                     .text = "a second copy; " + (judgement.text.empty()
                                                      ? "it ends with the next "
                                                        "start, restart or stop of this command"
                                                      : judgement.text),
                     .differs = {}};
    FillIn(view, copy.reported->report);
    views.push_back(std::move(view));
  }
}

}  // namespace clearway::core::procman
