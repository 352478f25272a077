// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>

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

/// `show MAP.yaml`: draws a map.
[[nodiscard]] Subcommand AddShow(CLI::App& program);

/// `build LOG`: makes a map.
[[nodiscard]] Subcommand AddBuild(CLI::App& program);

}  // namespace clearway::map_tool
