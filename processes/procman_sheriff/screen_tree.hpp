// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <set>
#include <string>
#include <vector>

#include "common/core/procman/deployment.hpp"
#include "common/core/procman/sheriff_view.hpp"

namespace clearway::screen {

/// One line of the tree of groups and commands. It says where in a snapshot its content is.
struct TreeLine {
  enum class Kind { kEverything, kGroup, kCommand };
  Kind kind = Kind::kEverything;
  int depth = 0;          ///< 0: everything, and what is in no group.
  std::string name{};     ///< Of a group its last part.
  std::string path{};     ///< Of a group or of the group that the command is in.
  std::size_t index = 0;  ///< kCommand: in Snapshot::commands; else: in Snapshot::groups.
  bool is_folded = false;

  [[nodiscard]] core::procman::Target target() const;
};

/// Everything first, then groups and commands as they come first in the snapshot. What is below a
/// group in `folded` (paths) is left out. Deterministic; O(n log n).
[[nodiscard]] std::vector<TreeLine> TreeOf(const core::procman::Snapshot& snapshot,
                                           const std::set<std::string>& folded);

/// On its way to another status, which may take orders of a sheriff yet.
[[nodiscard]] bool IsOnItsWay(core::procman::Status status);

}  // namespace clearway::screen
