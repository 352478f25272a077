// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace clearway::core::procman {

/// A command as a deployment file defines it and as it travels to a deputy.
struct CommandSpec {
  std::string id;                    ///< Unique over all deputies.
  std::string exec;                  ///< Program and arguments; grammar in exec_string.hpp.
  std::string group;                 ///< '/' separates levels; empty: none.
  bool auto_respawn = false;         ///< Start again when it ends by itself.
  int stop_signal = 2;               ///< First signal to stop it; 2 is SIGINT.
  float stop_time_allowed_s = 7.0F;  ///< From that signal to SIGKILL [s].
  friend bool operator==(const CommandSpec&, const CommandSpec&) = default;
};

/// A command of a deployment file and the deputy that is to run it.
struct DeployedCommand {
  CommandSpec spec;
  std::string deputy;
  int line = 0;  ///< Of the file, for messages.
};

/// What an action of a script is about.
struct Target {
  enum class Kind {
    kEverything,
    kCommand,  ///< `name` is a command's id.
    kGroup,    ///< `name` is a path of groups; those below it belong to it.
  };
  Kind kind = Kind::kEverything;
  std::string name;
  friend bool operator==(const Target&, const Target&) = default;
};

/// One line of a script.
struct ScriptAction {
  enum class Kind { kStart, kStop, kRestart, kWaitTime, kWaitStatus, kRunScript };
  /// kRunning: runs and, where the deputy tells, is ready. kStopped: does not run.
  enum class Status { kNone, kRunning, kStopped };
  Kind kind = Kind::kStart;
  Target target;                 ///< Not for kWaitTime and kRunScript.
  Status wait = Status::kNone;   ///< Of kStart, kStop, kRestart: waited for; kWaitStatus: which.
  std::int64_t duration_ms = 0;  ///< kWaitTime only.
  std::string script;            ///< kRunScript only.
  int line = 0;                  ///< Of the file, for messages.
};

struct Script {
  std::string name;
  std::vector<ScriptAction> actions;
  int line = 0;
};

/// A deployment file: which commands run where, and scripts about them. Ids and script names are
/// unique, and every target and script that a script names is there: the reader saw to it.
struct Deployment {
  std::string file;  ///< As it was named to the reader, for messages.
  std::vector<DeployedCommand> commands;
  std::vector<Script> scripts;
};

/// Whether a command of this group belongs to the target's group: "drivers" holds "drivers/aux",
/// not "drivers2".
[[nodiscard]] inline bool IsInGroup(const std::string& group, const std::string& target) {
  return group == target ||
         (group.size() > target.size() && group.starts_with(target) && group[target.size()] == '/');
}

/// Whether the command is one of the target's.
[[nodiscard]] inline bool IsTargeted(const CommandSpec& spec, const Target& target) {
  switch (target.kind) {
    case Target::Kind::kCommand:
      return spec.id == target.name;
    case Target::Kind::kGroup:
      return IsInGroup(spec.group, target.name);
    case Target::Kind::kEverything:
      break;
  }
  return true;
}

}  // namespace clearway::core::procman
