// SPDX-License-Identifier: BSD-3-Clause
#include "common/io/procman/pmd_checks.hpp"

#include <cstddef>
#include <map>
#include <string>
#include <vector>

#include "common/io/read_error.hpp"

namespace clearway::io::internal {
namespace {

using core::procman::Script;

void CheckName(const PmdContent& content, const PmdReference& reference, PmdProblems& problems) {
  std::string expected;
  switch (reference.kind) {
    case PmdReference::Kind::kCommand:
      if (content.command_lines.contains(reference.name)) return;
      expected = "cmd " + Quoted(reference.name) + ": expected the id of a command of this file";
      break;
    case PmdReference::Kind::kGroup:
      if (content.groups.contains(reference.name)) return;
      expected = "group " + Quoted(reference.name) + ": expected the path of a group of this file";
      break;
    case PmdReference::Kind::kScript:
      if (content.script_lines.contains(reference.name)) return;
      expected = "run_script " + Quoted(reference.name) + ": expected a script of this file";
      break;
  }
  problems.Add(reference.place, expected);
}

// Depth first, on a stack of its own: a file may hold thousands of scripts, each running the next.
class RecursionFinder {
 public:
  RecursionFinder(const PmdContent& content, PmdProblems& problems)
      : scripts_(content.deployment.scripts),
        problems_(problems),
        edges_(scripts_.size()),
        states_(scripts_.size(), State::kNew),
        positions_(scripts_.size()) {
    std::map<std::string, std::size_t> indices;
    for (std::size_t i = 0; i < scripts_.size(); ++i) indices.emplace(scripts_[i].name, i);
    for (const PmdReference& reference : content.references) {
      const auto found = indices.find(reference.name);
      if (reference.kind != PmdReference::Kind::kScript || found == indices.end()) continue;
      edges_[reference.script].push_back({found->second, reference.place});
    }
  }

  void Find() {
    for (std::size_t i = 0; i < scripts_.size(); ++i) {
      if (states_[i] == State::kNew) FindFrom(i);
    }
  }

 private:
  enum class State { kNew, kOnPath, kDone };
  struct Edge {
    std::size_t script = 0;  // That is run.
    PmdPlace place;
  };
  struct Step {
    std::size_t script = 0;
    std::size_t next_edge = 0;
  };

  void FindFrom(std::size_t first) {
    Enter(first);
    while (!path_.empty()) {
      Step& step = path_.back();
      if (step.next_edge == edges_[step.script].size()) {
        states_[step.script] = State::kDone;
        path_.pop_back();
        continue;
      }
      const Edge& edge = edges_[step.script][step.next_edge++];
      if (states_[edge.script] == State::kOnPath) Report(edge);
      if (states_[edge.script] == State::kNew) Enter(edge.script);
    }
  }

  void Enter(std::size_t script) {
    states_[script] = State::kOnPath;
    positions_[script] = path_.size();
    path_.push_back({script});
  }

  void Report(const Edge& edge) {
    constexpr std::ptrdiff_t kMaxShown = 6;
    const auto begin = path_.begin() + static_cast<std::ptrdiff_t>(positions_[edge.script]);
    std::string circle;
    for (auto step = begin; step != path_.end() && step - begin < kMaxShown; ++step) {
      circle += Quoted(scripts_[step->script].name) + " runs ";
    }
    if (path_.end() - begin > kMaxShown) circle += "... runs ";
    const std::string name = Quoted(scripts_[edge.script].name);
    problems_.Add(edge.place,
                  "run_script " + name + " where " + circle + name +
                      ": expected a script that does not lead back here");
  }

  const std::vector<Script>& scripts_;
  PmdProblems& problems_;
  std::vector<std::vector<Edge>> edges_;
  std::vector<State> states_;
  std::vector<std::size_t> positions_;  // In the path, of those on it.
  std::vector<Step> path_;
};

}  // namespace

void CheckPmdContent(const PmdContent& content, PmdProblems& problems) {
  for (const PmdReference& reference : content.references) CheckName(content, reference, problems);
  RecursionFinder(content, problems).Find();
}

}  // namespace clearway::io::internal
