// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <map>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "common/core/procman/command_host.hpp"

namespace clearway::test {

/// A host whose processes are numbers: tests end them and see what was asked of it.
class FakeCommands : public core::procman::CommandHost {
 public:
  core::procman::StartOutcome Start(const core::procman::CommandSpec& spec) override {
    started.push_back(spec.id);
    core::procman::StartOutcome outcome = next;
    if (outcome.problem.empty()) {
      outcome.pid = ++last_pid;
      running.emplace(outcome.pid, spec.id);
    }
    return outcome;
  }
  void Signal(std::int32_t pid, int signal) override { signals.emplace_back(pid, signal); }
  void Note(const std::string& command_id, const std::string& text) override {
    notes.push_back(command_id + ": " + text);
  }

  /// The process of a command; 0: it does not run. More than one is a mistake of who started them.
  [[nodiscard]] std::int32_t PidOf(const std::string& id) const {
    for (const auto& [pid, name] : running) {
      if (name == id) return pid;
    }
    return 0;
  }
  [[nodiscard]] bool HasTwins() const {
    std::set<std::string> ids;
    for (const auto& [pid, id] : running) {
      if (!ids.insert(id).second) return true;
    }
    return false;
  }

  core::procman::StartOutcome next;  ///< What the next starts come to.
  std::map<std::int32_t, std::string> running;
  std::vector<std::string> started;
  std::vector<std::pair<std::int32_t, int>> signals;
  std::vector<std::string> notes;
  std::int32_t last_pid = 100;
};

}  // namespace clearway::test
