// SPDX-License-Identifier: BSD-3-Clause
#include <cstdio>
#include <filesystem>
#include <memory>
#include <string>

#include <CLI/CLI.hpp>

#include "common/graph/options.hpp"
#include "common/graph/output_files.hpp"
#include "common/process/log.hpp"
#include "tools/map/show.hpp"
#include "tools/map/subcommand.hpp"

namespace clearway::map_tool {
namespace {

struct ShowArguments {
  std::filesystem::path map;
  std::filesystem::path output;
  std::filesystem::path json;
};

int RunShow(const ShowArguments& arguments) {
  graph::RefuseToOverwrite({arguments.output, arguments.json}, {arguments.map});
  const io::LoadedMap map = io::LoadMap(arguments.map);
  for (const std::string& key : map.description.ignored_keys) {
    process::LogWarning(arguments.map.string() + ": key " + io::Quoted(key) + " is ignored");
  }
  std::fputs(FormatLine(map).c_str(), stdout);
  DrawMap(map, arguments.map, arguments.output);
  if (!arguments.json.empty()) graph::WriteFile(arguments.json, FormatJson(map));
  return graph::kExitOk;
}

}  // namespace

Subcommand AddShow(CLI::App& program) {
  const auto arguments = std::make_shared<ShowArguments>();
  CLI::App* show = program.add_subcommand("show", "Draws a map as a picture");
  show->add_option("map", arguments->map, "YAML file of a Nav2 or ROS map")
      ->required()
      ->type_name("MAP.yaml");
  show->add_option("--output", arguments->output, "Write the picture to this PNG file")
      ->required()
      ->check(HasEnding({".png"}))
      ->type_name("FILE");
  show->add_option("--json", arguments->json, "Write the figures to this file")->type_name("FILE");
  return {show, [arguments] { return RunShow(*arguments); }};
}

}  // namespace clearway::map_tool
