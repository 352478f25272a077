// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "common/config/config.hpp"
#include "processes/procman_deputy/deputy_file.hpp"
#include "processes/procman_deputy/deputy_process.hpp"

namespace clearway {

/// The deputy's command line.
struct DeputyOptions {
  std::filesystem::path config_path;  ///< Empty: kHostFile where it is there.
  std::vector<std::string> overrides;
  std::string id;
  std::string lcm_url;
  std::string channel_prefix;
  std::string log_level = "info";
  std::filesystem::path log_file;
  bool allow_any = false;
  bool allow_root = false;
  bool is_verbose = false;
  bool check_config = false;
  bool print_config = false;
};

/// The host's own file, where none is named.
inline constexpr char kHostFile[] = "/etc/clearway/deputy.xml";

/// The host's file with --set applied; defaults where there is none. Throws config::ConfigError.
[[nodiscard]] config::LoadResult<DeputyFile> LoadDeputyFile(const DeputyOptions& options);

/// The bus: --lcm-url, else that of a file, else LCM_DEFAULT_URL, else LCM's default. Throws
/// std::invalid_argument.
[[nodiscard]] process::BusConfig BusOf(const DeputyOptions& options,
                                       const config::LoadResult<DeputyFile>& file);

/// What the process is told, with folders and names filled in from the environment.
[[nodiscard]] DeputySettings SettingsOf(const DeputyOptions& options, const DeputyConfig& config);

}  // namespace clearway
