// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <utility>
#include <vector>

namespace CLI {
class App;
}

namespace clearway::map_tool {

/// A subcommand of clearway-map: its arguments are added to an app, which parses them, and then it
/// is run if it was the one named.
struct Subcommand {
  const CLI::App* app = nullptr;
  std::function<int()> run;  ///< Gives the exit status.
};

/// A check of a file name: it has one of these endings.
[[nodiscard]] inline std::function<std::string(const std::string&)> HasEnding(
    std::vector<std::string> endings) {
  return [endings = std::move(endings)](const std::string& name) -> std::string {
    for (const std::string& ending : endings) {
      if (std::filesystem::path(name).extension() == ending) return {};
    }
    return name + ": expected a name that ends in " + endings.front();
  };
}

/// `show MAP.yaml`: draws a map.
[[nodiscard]] Subcommand AddShow(CLI::App& program);

/// `build LOG`: makes a map.
[[nodiscard]] Subcommand AddBuild(CLI::App& program);

}  // namespace clearway::map_tool
