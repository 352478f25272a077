// SPDX-License-Identifier: BSD-3-Clause
#include "common/graph/options.hpp"

#include <cstdio>

#include <CLI/CLI.hpp>

#include "common/process/log.hpp"

namespace clearway::graph {
namespace {

// One line to stderr, also when the log is not there yet or is off.
void PrintError(const std::string& program, const std::string& text) {
  std::fprintf(stderr, "%s: %s\n", program.c_str(), text.c_str());
}

}  // namespace

void AddOptions(CLI::App& app, Options& options) {
  app.set_version_flag("--version", CLEARWAY_VERSION);
  app.add_option("--config", options.config_path, "XML file of the whole graph")
      ->required()
      ->type_name("FILE");
  app.add_option("--set", options.overrides, "Overrides element.attribute=value; may be repeated")
      ->type_name("NAME=VALUE")
      ->expected(1)
      ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll);
  app.add_option("--lcm-url", options.lcm_url, "Puts both buses on udpm://GROUP:PORT")
      ->type_name("URL");
  app.add_option("--channel-prefix", options.channel_prefix, "Put before every channel name")
      ->type_name("TEXT");
  app.add_option("--log-level", options.log_level, "trace, debug, info, warn, error or off")
      ->check(CLI::IsMember({"trace", "debug", "info", "warn", "error", "off"}));
  app.add_flag("--check-config", options.check_config, "Check the configuration and stop");
  app.add_flag(
      "--print-config", options.print_config, "Print the effective configuration and stop");
}

void ServeMap(const std::filesystem::path& map, Options& options) {
  const std::string file = std::filesystem::absolute(map).string();
  options.overrides.insert(options.overrides.begin(),
                           {"map_server.file=" + file, "preprocessor.map_filter.enabled=true"});
}

config::LoadResult<GraphConfig> LoadConfig(const Options& options) {
  std::vector<std::string> overrides = options.overrides;
  if (!options.lcm_url.empty()) {
    overrides.push_back("buses.local.url=" + options.lcm_url);
    overrides.push_back("buses.shared.url=" + options.lcm_url);
  }
  config::LoadResult<GraphConfig> config =
      config::Load<GraphConfig>(options.config_path, overrides);
  config.root.folder = options.config_path.parent_path();
  return config;
}

bool AnsweredByConfig(const Options& options, const config::LoadResult<GraphConfig>& config) {
  if (options.print_config) std::fputs(config::Print(config).c_str(), stdout);
  return options.print_config || options.check_config;
}

int GuardedMain(CLI::App& app,
                const Options& options,
                int argc,
                char** argv,
                const std::function<int()>& body) {
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? kExitOk : kExitUsage;
  }
  try {
    process::SetUpLog(app.get_name(), options.log_level);
    return body();
  } catch (const config::ConfigError& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return kExitConfig;
  } catch (const std::exception& error) {
    PrintError(app.get_name(), error.what());
    return kExitFailure;
  }
}

}  // namespace clearway::graph
