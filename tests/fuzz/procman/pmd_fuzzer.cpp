// SPDX-License-Identifier: BSD-3-Clause
// Any bytes as a deployment: commands and scripts within their bounds whose names are all there, or
// problems of one line each that begin with the file.
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <iterator>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <string_view>

#include "common/core/procman/exec_string.hpp"
#include "common/io/procman/pmd_reader.hpp"

namespace {

using namespace clearway::core::procman;

void Require(bool holds) {
  if (!holds) std::abort();
}

void RequireCommands(const Deployment& deployment, std::size_t num_lines) {
  std::set<std::string> ids;
  for (const auto& [spec, deputy, line] : deployment.commands) {
    Require(!spec.id.empty() && spec.id.find('/') == std::string::npos);
    Require(ids.insert(spec.id).second);
    Require(!deputy.empty() && spec.stop_signal >= 1 && spec.stop_signal <= 64);
    Require(spec.stop_time_allowed_s >= 1.0F && spec.stop_time_allowed_s <= 3600.0F);
    Require(line >= 1 && static_cast<std::size_t>(line) <= num_lines);
    Require(spec.group.empty() || (spec.group.front() != '/' && spec.group.back() != '/'));
    const auto nothing = [](const std::string&) { return std::optional<std::string>(); };
    Require(ParseExecLine(spec.exec, nothing).line.has_value());
  }
}

// Scripts that are all there and run none that is being run.
void RequireScripts(const Deployment& deployment) {
  std::map<std::string, std::set<std::string>> runs;
  for (const Script& script : deployment.scripts)
    Require(runs.emplace(script.name, std::set<std::string>()).second);
  for (const Script& script : deployment.scripts) {
    for (const ScriptAction& action : script.actions) {
      if (action.kind == ScriptAction::Kind::kRunScript) runs[script.name].insert(action.script);
      if (action.target.kind != Target::Kind::kCommand) continue;
      Require(std::any_of(
          deployment.commands.begin(), deployment.commands.end(), [&](const auto& command) {
            return IsTargeted(command.spec, action.target);
          }));
    }
  }
  Require(runs.size() == deployment.scripts.size());
  // Whatever runs nothing that is left can be taken away, until nothing is left.
  for (std::size_t left = runs.size() + 1; runs.size() < left;) {
    left = runs.size();
    for (auto entry = runs.begin(); entry != runs.end();) {
      const bool is_free = std::none_of(entry->second.begin(),
                                        entry->second.end(),
                                        [&](const auto& name) { return runs.count(name) > 0; });
      entry = is_free ? runs.erase(entry) : std::next(entry);
    }
  }
  Require(runs.empty());
}

void RequireMessage(std::string_view message) {
  std::size_t num_lines = 0;
  while (!message.empty()) {
    const std::string_view line = message.substr(0, message.find('\n'));
    Require(line.substr(0, 9) == "fuzz.pmd:");
    for (const char letter : line) Require(letter >= ' ' && letter <= '~');
    Require(++num_lines <= clearway::io::kMaxPmdProblems);
    message.remove_prefix(line.size());
    if (!message.empty()) message.remove_prefix(1);
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view bytes(reinterpret_cast<const char*>(data), size);
  try {
    const Deployment deployment = clearway::io::ParsePmd(bytes, "fuzz.pmd");
    const auto num_lines = std::count(bytes.begin(), bytes.end(), '\n') + 1;
    RequireCommands(deployment, static_cast<std::size_t>(num_lines));
    RequireScripts(deployment);
  } catch (const clearway::io::ReadError& error) {
    RequireMessage(error.what());
  }
  return 0;
}
