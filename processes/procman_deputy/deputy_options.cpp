// SPDX-License-Identifier: BSD-3-Clause
#include "processes/procman_deputy/deputy_options.hpp"

#include <array>
#include <cstdlib>
#include <unistd.h>

namespace clearway {
namespace {

namespace fs = std::filesystem;

std::string Variable(const char* name) {
  const char* const value = std::getenv(name);
  return value == nullptr ? std::string() : std::string(value);
}

// systemd names several folders with ':' between them; the first is ours.
fs::path FirstFolder(const char* variable) {
  const std::string folders = Variable(variable);
  return folders.substr(0, folders.find(':'));
}

fs::path HomeState() {
  const std::string state = Variable("XDG_STATE_HOME");
  if (!state.empty()) return fs::path(state) / "clearway";
  const std::string home = Variable("HOME");
  return fs::path(home.empty() ? "/tmp" : home) / ".local" / "state" / "clearway";
}

std::string HostName() {
  std::array<char, 256> name{};
  gethostname(name.data(), name.size() - 1);
  return name.data();
}

}  // namespace

config::LoadResult<DeputyFile> LoadDeputyFile(const DeputyOptions& options) {
  if (!options.config_path.empty()) {
    return config::Load<DeputyFile>(options.config_path, options.overrides);
  }
  if (fs::exists(kHostFile)) return config::Load<DeputyFile>(kHostFile, options.overrides);
  return config::Parse<DeputyFile>("<clearway version=\"1\"/>", "no file", options.overrides);
}

process::BusConfig BusOf(const DeputyOptions& options, const config::LoadResult<DeputyFile>& file) {
  const process::BusConfig& configured = file.root.deputy.bus;
  if (!options.lcm_url.empty()) return process::BusFromUrl(options.lcm_url, configured);
  const std::string from_environment = Variable("LCM_DEFAULT_URL");
  if (options.config_path.empty() && !fs::exists(kHostFile) && !from_environment.empty()) {
    return process::BusFromUrl(from_environment, configured);
  }
  return configured;
}

DeputySettings SettingsOf(const DeputyOptions& options, const DeputyConfig& config) {
  DeputySettings settings;
  settings.id = !options.id.empty() ? options.id : !config.id.empty() ? config.id : HostName();
  settings.version = CLEARWAY_VERSION;
  settings.respawn = config.respawn;
  settings.health = config.health;
  settings.output = config.output;
  settings.logs = config.logs;
  if (settings.logs.folder.empty()) {
    const fs::path given = FirstFolder("LOGS_DIRECTORY");
    settings.logs.folder = given.empty() ? HomeState() / "logs" / settings.id : given;
  }
  fs::path state =
      config.state_folder.empty() ? FirstFolder("STATE_DIRECTORY") : fs::path(config.state_folder);
  if (!state.empty()) settings.orders_file = state / "orders";
  return settings;
}

}  // namespace clearway
