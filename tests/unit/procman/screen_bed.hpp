// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "processes/procman_sheriff/screen_model.hpp"
#include "processes/procman_sheriff/screen_text.hpp"

namespace clearway::screen {

using core::procman::CommandView;
using core::procman::DeputyView;
using core::procman::GroupView;
using core::procman::Snapshot;
using core::procman::Status;
using core::procman::Target;

inline CommandView Command(std::string id, std::string group, Status status) {
  CommandView view;
  view.id = std::move(id);
  view.group = std::move(group);
  view.deputy = "rig";
  view.exec = view.id + " --config lab.xml";
  view.is_in_file = true;
  view.status = status;
  view.is_ready = status == Status::kRunning;
  if (IsUp(status)) {
    view.pid = 4711;
    view.cpu_usage = 0.031F;
    view.mem_rss_bytes = 48'300'000;
    view.running_us = 754'000'000;
  }
  view.starts = 1;
  return view;
}

/// As Sheriff::Look() counts them.
inline void CountGroups(Snapshot& snapshot) {
  std::vector<GroupView> groups{{.path = ""}};
  for (const CommandView& command : snapshot.commands) {
    for (std::size_t end = 0; !command.group.empty() && end != std::string::npos;) {
      end = command.group.find('/', end + 1);
      const std::string path = command.group.substr(0, end);
      if (std::none_of(
              groups.begin(), groups.end(), [&](const auto& g) { return g.path == path; })) {
        groups.push_back({.path = path});
      }
    }
  }
  for (GroupView& group : groups) {
    for (const CommandView& command : snapshot.commands) {
      if (command.is_stray) continue;
      if (!group.path.empty() && !core::procman::IsInGroup(command.group, group.path)) continue;
      ++group.commands;
      group.ready += command.is_ready ? 1 : 0;
      group.up += IsUp(command.status) ? 1 : 0;
      group.trouble += IsTrouble(command.status) ? 1 : 0;
      group.unknown += command.status == Status::kUnknown ? 1 : 0;
    }
  }
  std::sort(
      groups.begin(), groups.end(), [](const auto& a, const auto& b) { return a.path < b.path; });
  snapshot.groups = std::move(groups);
}

inline DeputyView Host(std::string id) {
  DeputyView view;
  view.id = std::move(id);
  view.is_in_file = true;
  view.is_heard = true;
  view.age_us = 400'000;
  view.version = "1.0.0";
  view.config_digest = "aaaaaaaaaaaa";
  view.tells_health = true;
  view.cpu_load = 0.23F;
  view.phys_mem_total_bytes = 8'200'000'000;
  view.phys_mem_free_bytes = 5'100'000'000;
  view.commands = 3;
  return view;
}

/// A small robot: two hosts, two groups, one command in trouble.
inline ScreenContent SmallRobot() {
  ScreenContent content;
  Snapshot& snapshot = content.snapshot;
  snapshot.file = "robot.pmd";
  snapshot.sheriff_id = "desk:812:1700000000000000";
  snapshot.deputies = {Host("arm"), Host("rig")};
  snapshot.deputies[0].is_heard = false;
  snapshot.deputies[0].age_us = 12'000'000;
  snapshot.commands = {Command("lidar-driver", "sense", Status::kRunning),
                       Command("preprocessor", "sense/perceive", Status::kRunning),
                       Command("clusterer", "sense/perceive", Status::kGaveUp),
                       Command("stop-guard", "", Status::kGettingReady),
                       Command("gripper", "hand", Status::kUnknown)};
  snapshot.commands[2].text = "ended 5 times within 3 s of its start; last exit status 1";
  snapshot.commands[2].starts = 5;
  snapshot.commands[3].text = "has not said yet that it is ready";
  snapshot.commands[4].deputy = "arm";
  snapshot.commands[4].text = "deputy arm is silent";
  CountGroups(snapshot);
  core::procman::ScriptAction start;
  start.wait = core::procman::ScriptAction::Status::kRunning;
  core::procman::ScriptAction stop;
  stop.kind = core::procman::ScriptAction::Kind::kStop;
  content.scripts = {{.name = "bring-up", .actions = {start}}, {.name = "down", .actions = {stop}}};
  return content;
}

/// A model with its stores, fitted to a size.
struct ScreenBed {
  explicit ScreenBed(ScreenContent content = SmallRobot(), ScreenSize screen_size = {})
      : size(screen_size) {
    model.Take(std::move(content));
    model.Fit(RowsOf(model, size));
  }

  Intent Press(char character) {
    return Press(
        {.kind = KeyPress::Kind::kCharacter, .character = static_cast<char32_t>(character)});
  }
  Intent Press(KeyPress::Kind kind) { return Press(KeyPress{.kind = kind}); }
  Intent Press(const KeyPress& key) {
    const Intent intent = model.OnKey(key);
    model.Fit(RowsOf(model, size));
    return intent;
  }

  /// Moves the selection there.
  void Select(const std::string& name) {
    Press(KeyPress::Kind::kHome);
    while (Selected() != name && model.selected() + 1 < model.lines().size()) {
      Press(KeyPress::Kind::kDown);
    }
  }
  [[nodiscard]] const std::string& Selected() const { return model.lines()[model.selected()].name; }

  [[nodiscard]] std::vector<Line> Lines() const { return Compose(model, size, "12:34:56"); }
  [[nodiscard]] std::string Text() const {
    std::string text;
    for (const Line& line : Lines()) {
      std::string row = TextOf(line);
      row.erase(row.find_last_not_of(' ') + 1);
      text += row + "\n";
    }
    return text;
  }

  OutputStore output;
  OutputLines messages;
  ScreenModel model{output, messages};
  ScreenSize size;
};

}  // namespace clearway::screen
