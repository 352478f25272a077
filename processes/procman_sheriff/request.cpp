// SPDX-License-Identifier: BSD-3-Clause
#include "processes/procman_sheriff/request.hpp"

#include <algorithm>
#include <array>
#include <set>
#include <utility>

namespace clearway {
namespace {

using core::procman::CommandSpec;
using core::procman::DeployedCommand;
using core::procman::Deployment;
using core::procman::Script;
using core::procman::ScriptAction;
using core::procman::Target;

constexpr std::array<std::pair<std::string_view, SheriffVerb>, 9> kVerbs = {{
    {"status", SheriffVerb::kStatus},
    {"start", SheriffVerb::kStart},
    {"stop", SheriffVerb::kStop},
    {"restart", SheriffVerb::kRestart},
    {"run", SheriffVerb::kRun},
    {"follow", SheriffVerb::kFollow},
    {"observe", SheriffVerb::kObserve},
    {"check", SheriffVerb::kCheck},
    {"screen", SheriffVerb::kScreen},
}};

constexpr std::size_t kMostNames = 12;

// Groups as they are stored have no surplus slashes.
std::string Squeezed(std::string_view path) {
  std::string squeezed;
  for (const char c : path) {
    if (c != '/' || (!squeezed.empty() && squeezed.back() != '/')) squeezed += c;
  }
  if (!squeezed.empty() && squeezed.back() == '/') squeezed.pop_back();
  return squeezed;
}

std::string KnownNames(const std::vector<CommandSpec>& commands) {
  std::set<std::string> names;
  for (const CommandSpec& command : commands) {
    names.insert(command.id);
    if (!command.group.empty()) names.insert(command.group);
  }
  std::string list;
  std::size_t count = 0;
  for (const std::string& name : names) {
    if (++count > kMostNames) return list + ", ...";
    list += (list.empty() ? "" : ", ") + name;
  }
  return list.empty() ? "nothing" : list;
}

void Collect(const Script& script,
             const Deployment& deployment,
             std::set<std::string>& visited,
             std::set<std::string>& ids) {
  if (!visited.insert(script.name).second) return;
  for (const ScriptAction& action : script.actions) {
    if (action.kind == ScriptAction::Kind::kWaitTime) continue;
    if (action.kind == ScriptAction::Kind::kRunScript) {
      const Script* inner = FindScript(deployment, action.script);
      if (inner != nullptr) Collect(*inner, deployment, visited, ids);
      continue;
    }
    for (const DeployedCommand& command : deployment.commands) {
      if (IsTargeted(command.spec, action.target)) ids.insert(command.spec.id);
    }
  }
}

}  // namespace

std::optional<SheriffVerb> VerbOf(std::string_view word) {
  for (const auto& [name, verb] : kVerbs) {
    if (name == word) return verb;
  }
  return std::nullopt;
}

std::string KnownVerbs() {
  std::string list;
  for (const auto& [name, verb] : kVerbs) list.append(list.empty() ? "" : ", ").append(name);
  return list;
}

NamedTarget FindTarget(const std::string& word, const std::vector<CommandSpec>& commands) {
  constexpr std::string_view kCommandPrefix = "cmd:";
  constexpr std::string_view kGroupPrefix = "group:";
  if (word == "everything") return {Target{}, {}};
  const bool only_command = word.starts_with(kCommandPrefix);
  const bool only_group = word.starts_with(kGroupPrefix);
  const std::string id = only_command ? word.substr(kCommandPrefix.size()) : word;
  const std::string path = Squeezed(only_group ? word.substr(kGroupPrefix.size()) : word);
  const bool is_command =
      !only_group && std::any_of(commands.begin(), commands.end(), [&](const CommandSpec& c) {
        return c.id == id;
      });
  const bool is_group = !only_command && !path.empty() &&
                        std::any_of(commands.begin(), commands.end(), [&](const CommandSpec& c) {
                          return core::procman::IsInGroup(c.group, path);
                        });
  if (is_command && is_group) {
    return {std::nullopt,
            "\"" + word + "\" is a command and a group: say cmd:" + word + " or group:" + word};
  }
  if (is_command) return {Target{Target::Kind::kCommand, id}, {}};
  if (is_group) return {Target{Target::Kind::kGroup, path}, {}};
  return {std::nullopt,
          "there is no command or group \"" + word + "\"; known: " + KnownNames(commands)};
}

const Script* FindScript(const Deployment& deployment, const std::string& name) {
  const auto found = std::find_if(deployment.scripts.begin(),
                                  deployment.scripts.end(),
                                  [&](const Script& script) { return script.name == name; });
  return found == deployment.scripts.end() ? nullptr : &*found;
}

std::vector<DeployedCommand> CommandsOf(const Script& script, const Deployment& deployment) {
  std::set<std::string> visited;
  std::set<std::string> ids;
  Collect(script, deployment, visited, ids);
  std::vector<DeployedCommand> commands;
  for (const DeployedCommand& command : deployment.commands) {
    if (ids.contains(command.spec.id)) commands.push_back(command);
  }
  return commands;
}

Script ScriptFor(SheriffVerb verb, const std::vector<Target>& targets, bool waits) {
  Script script;
  for (const Target& target : targets) {
    ScriptAction action;
    action.target = target;
    action.kind = verb == SheriffVerb::kStart  ? ScriptAction::Kind::kStart
                  : verb == SheriffVerb::kStop ? ScriptAction::Kind::kStop
                                               : ScriptAction::Kind::kRestart;
    script.actions.push_back(action);
  }
  // All at once, then all are waited for.
  for (const Target& target : targets) {
    if (!waits) break;
    ScriptAction action;
    action.target = target;
    action.kind = ScriptAction::Kind::kWaitStatus;
    action.wait = verb == SheriffVerb::kStop ? ScriptAction::Status::kStopped
                                             : ScriptAction::Status::kRunning;
    script.actions.push_back(action);
  }
  return script;
}

}  // namespace clearway
