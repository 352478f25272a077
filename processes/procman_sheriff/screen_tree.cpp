// SPDX-License-Identifier: BSD-3-Clause
#include "processes/procman_sheriff/screen_tree.hpp"

#include <map>
#include <utility>

namespace clearway::screen {
namespace {

using core::procman::Snapshot;
using core::procman::Status;
using core::procman::Target;

struct Node {
  std::vector<TreeLine> children;
};
using Nodes = std::map<std::string, Node>;  // By path; "" is everything.

// Paths of the groups that a group is in, outermost first, and its own.
std::vector<std::string> PathsTo(const std::string& group) {
  std::vector<std::string> paths;
  for (std::size_t end = 0; !group.empty() && end != std::string::npos;) {
    end = group.find('/', end + 1);
    paths.push_back(group.substr(0, end));
  }
  return paths;
}

Nodes NodesOf(const Snapshot& snapshot) {
  std::map<std::string, std::size_t> index_of;
  for (std::size_t i = 0; i < snapshot.groups.size(); ++i) index_of[snapshot.groups[i].path] = i;
  Nodes nodes;
  nodes[""];
  for (std::size_t i = 0; i < snapshot.commands.size(); ++i) {
    const auto& command = snapshot.commands[i];
    std::string parent;
    int depth = 0;
    for (const std::string& path : PathsTo(command.group)) {
      if (nodes.try_emplace(path).second) {
        const std::size_t name = parent.empty() ? 0 : parent.size() + 1;
        nodes[parent].children.push_back({.kind = TreeLine::Kind::kGroup,
                                          .depth = depth,
                                          .name = path.substr(name),
                                          .path = path,
                                          .index = index_of[path]});
      }
      parent = path;
      ++depth;
    }
    nodes[parent].children.push_back({.kind = TreeLine::Kind::kCommand,
                                      .depth = depth,
                                      .name = command.id,
                                      .path = command.group,
                                      .index = i});
  }
  return nodes;
}

}  // namespace

Target TreeLine::target() const {
  switch (kind) {
    case Kind::kCommand:
      return {.kind = Target::Kind::kCommand, .name = name};
    case Kind::kGroup:
      return {.kind = Target::Kind::kGroup, .name = path};
    case Kind::kEverything:
      break;
  }
  return {};
}

std::vector<TreeLine> TreeOf(const Snapshot& snapshot, const std::set<std::string>& folded) {
  const Nodes nodes = NodesOf(snapshot);
  std::vector<TreeLine> lines{{.name = "everything"}};
  // A stack of its own: paths come from outside and may be deep.
  std::vector<std::pair<const Node*, std::size_t>> open{{&nodes.at(""), 0}};
  while (!open.empty()) {
    auto& [node, next] = open.back();
    if (next == node->children.size()) {
      open.pop_back();
      continue;
    }
    TreeLine line = node->children[next++];
    if (line.kind == TreeLine::Kind::kGroup) {
      line.is_folded = folded.contains(line.path);
      if (!line.is_folded) open.emplace_back(&nodes.at(line.path), 0);
    }
    lines.push_back(std::move(line));
  }
  return lines;
}

bool IsOnItsWay(Status status) {
  return status == Status::kStarting || status == Status::kRestarting ||
         status == Status::kStopping || status == Status::kMoving || status == Status::kRemoving;
}

}  // namespace clearway::screen
