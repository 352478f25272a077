// SPDX-License-Identifier: BSD-3-Clause
#include <cstdio>
#include <memory>

#include <CLI/CLI.hpp>

#include "common/graph/finite_check.hpp"
#include "common/graph/options.hpp"
#include "common/graph/output_files.hpp"
#include "common/io/map/map_writer.hpp"
#include "tools/map/build.hpp"
#include "tools/map/subcommand.hpp"

namespace clearway::map_tool {
namespace {

int RunBuild(const BuildSettings& settings) {
  graph::RefuseToOverwrite({settings.output}, {settings.log});
  const BuildReport report = BuildMap(settings);
  std::fputs(Describe(report).c_str(), stdout);
  io::SaveMap(report.map, settings.output);
  std::printf("map: %s\n", settings.output.c_str());
  return graph::kExitOk;
}

}  // namespace

Subcommand AddBuild(CLI::App& program) {
  const auto settings = std::make_shared<BuildSettings>();
  CLI::App* build =
      program.add_subcommand("build", "Makes a map from the LOCAL_MAPs of an LCM log");
  build->add_option("log", settings->log, "LCM log with LOCAL_MAP")->required()->type_name("LOG");
  build
      ->add_option(
          "--output", settings->output, "Write the map to this YAML file, and its image beside it")
      ->required()
      ->check(HasEnding({".yaml", ".yml"}))
      ->type_name("MAP.yaml");
  build
      ->add_option("--min-share",
                   settings->rules.min_share,
                   "A cell is occupied when it was hit in at least this share of the scans that "
                   "saw it. Higher forgets slow walkers, and thin or distant things too")
      ->check(graph::Finite())
      ->check(CLI::Range(0.001, 1.0))
      ->capture_default_str();
  build
      ->add_option(
          "--min-scans", settings->rules.min_scans, "A cell that fewer scans saw is unknown")
      ->check(CLI::Range(1, 1'000'000))
      ->capture_default_str();
  build
      ->add_option("--wall-depth",
                   settings->wall_depth_m,
                   "Unknown cells this near to an occupied one become occupied [m]: scans see the "
                   "face of a wall only, and a pose that is a little off looks behind it. 0: none")
      ->check(graph::Finite())
      ->check(CLI::Range(0.0, 1.0))
      ->capture_default_str();
  build->add_option("--channel-prefix", settings->channel_prefix, "Put before every channel name")
      ->type_name("TEXT");
  return {build, [settings] { return RunBuild(*settings); }};
}

}  // namespace clearway::map_tool
