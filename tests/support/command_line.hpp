// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "tests/support/running_graph.hpp"
#include "tests/support/test_data.hpp"

namespace clearway::test {

/// A shipped configuration.
inline std::string ShippedConfig(const std::string& name) {
  return SourceFolder() / "config" / name;
}

/// Appends words to a command.
inline std::vector<std::string> With(std::vector<std::string> command,
                                     const std::vector<std::string>& more) {
  command.insert(command.end(), more.begin(), more.end());
  return command;
}

}  // namespace clearway::test
