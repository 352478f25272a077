// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "common/graph/graph_config.hpp"

namespace CLI {
class App;
}

namespace clearway::graph {

// Exit statuses of all programs (BSD sysexits).
inline constexpr int kExitOk = 0;
inline constexpr int kExitUsage = 64;
inline constexpr int kExitFailure = 70;
inline constexpr int kExitConfig = 78;

/// What every program of the graph understands.
struct Options {
  std::filesystem::path config_path;
  std::vector<std::string> overrides;  ///< --set element.attribute=value
  std::string lcm_url;                 ///< Instead of the URLs of both buses; empty: as configured.
  std::string channel_prefix;
  std::string log_level = "info";
  bool check_config = false;
  bool print_config = false;
};

/// Adds the common options to `app`, which the caller then parses with GuardedMain().
void AddOptions(CLI::App& app, Options& options);

/// What --map FILE means: serve this map and filter with it, unless --set says otherwise.
void ServeMap(const std::filesystem::path& map, Options& options);

/// The configuration that the options name, with --set and --lcm-url applied. Throws
/// config::ConfigError with all problems.
[[nodiscard]] config::LoadResult<GraphConfig> LoadConfig(const Options& options);

/// Handles --check-config and --print-config: true when one was given and the program is done.
[[nodiscard]] bool AnsweredByConfig(const Options& options,
                                    const config::LoadResult<GraphConfig>& config);

/// The wall round main(): parses the command line, sets up the log, runs `body` and turns what it
/// throws into a message on stderr and an exit status.
int GuardedMain(CLI::App& app,
                const Options& options,
                int argc,
                char** argv,
                const std::function<int()>& body);

}  // namespace clearway::graph
