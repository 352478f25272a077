// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "common/core/procman/deployment.hpp"
#include "common/io/procman/pmd_lexer.hpp"

namespace clearway::io::internal {

/// A name in an action of a script.
struct PmdReference {
  enum class Kind { kCommand, kGroup, kScript };
  Kind kind = Kind::kCommand;
  std::string name;  ///< As ids and paths are kept.
  PmdPlace place;
  std::size_t script = 0;  ///< Index of the script whose action it is.
};

/// What a file holds, before names in scripts are looked up.
struct PmdContent {
  core::procman::Deployment deployment;
  std::map<std::string, std::size_t> command_lines;  ///< Id to its first line.
  std::map<std::string, std::size_t> script_lines;   ///< Name to its first line.
  std::set<std::string> groups;                      ///< Paths, also of groups without commands.
  std::vector<PmdReference> references;
};

}  // namespace clearway::io::internal
