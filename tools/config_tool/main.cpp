// SPDX-License-Identifier: BSD-3-Clause
#include <cstdio>
#include <filesystem>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>

#include "common/graph/options.hpp"
#include "tools/config_tool/generated_files.hpp"

namespace clearway {
namespace {

int Check(const std::vector<std::filesystem::path>& files) {
  int status = graph::kExitOk;
  for (const std::filesystem::path& file : files) {
    try {
      (void)config::Load<graph::GraphConfig>(file);
      std::printf("%s: good\n", file.c_str());
    } catch (const config::ConfigError& error) {
      std::fprintf(stderr, "%s\n", error.what());
      status = graph::kExitConfig;
    }
  }
  return status;
}

int Main(int argc, char** argv) {
  CLI::App app("Checks configurations and writes what is generated from their definition",
               "clearway-config");
  app.set_version_flag("--version", CLEARWAY_VERSION);
  app.require_subcommand(1);
  std::vector<std::filesystem::path> files;
  CLI::App* const check = app.add_subcommand("check", "Check configuration files");
  check->add_option("FILE", files, "XML files of a graph")->required();
  CLI::App* const defaults =
      app.add_subcommand("default", "Print config/default.xml: every value, with its help");
  CLI::App* const reference = app.add_subcommand("reference", "Print config/reference.md");
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? graph::kExitOk : graph::kExitUsage;
  }
  if (*check) return Check(files);
  if (*defaults) std::fputs(config_tool::DefaultXml().c_str(), stdout);
  if (*reference) std::fputs(config_tool::ReferenceMarkdown().c_str(), stdout);
  return graph::kExitOk;
}

}  // namespace
}  // namespace clearway

int main(int argc, char** argv) {
  return clearway::Main(argc, argv);
}
