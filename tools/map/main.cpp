// SPDX-License-Identifier: BSD-3-Clause
#include <vector>

#include <CLI/CLI.hpp>

#include "common/graph/options.hpp"
#include "tools/map/subcommand.hpp"

namespace clearway::map_tool {
namespace {

int Main(int argc, char** argv) {
  CLI::App app("Works with maps in the format of Nav2 and ROS", "clearway-map");
  app.set_version_flag("--version", CLEARWAY_VERSION);
  app.require_subcommand(1);
  const std::vector<Subcommand> subcommands = {AddShow(app), AddBuild(app)};
  return graph::GuardedMain(app, {}, argc, argv, [&] {
    for (const Subcommand& subcommand : subcommands) {
      if (subcommand.app->parsed()) return subcommand.run();
    }
    return graph::kExitUsage;
  });
}

}  // namespace
}  // namespace clearway::map_tool

int main(int argc, char** argv) {
  return clearway::map_tool::Main(argc, argv);
}
