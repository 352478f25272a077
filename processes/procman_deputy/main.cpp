// SPDX-License-Identifier: BSD-3-Clause
#include <cerrno>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include <CLI/CLI.hpp>

#include "common/graph/options.hpp"
#include "common/process/live_runtime.hpp"
#include "common/process/log.hpp"
#include "processes/procman_deputy/child_set.hpp"
#include "processes/procman_deputy/config_digest.hpp"
#include "processes/procman_deputy/deputy_options.hpp"
#include "processes/procman_deputy/deputy_process.hpp"
#include "processes/procman_deputy/self_start.hpp"

namespace clearway {
namespace {

constexpr int kExitNotPermitted = 77;

void AddDeputyOptions(CLI::App& app, DeputyOptions& options) {
  app.set_version_flag("--version", CLEARWAY_VERSION);
  app.add_option("--config", options.config_path, "This host's own file: what may run here")
      ->type_name("FILE")
      ->default_str(kHostFile);
  app.add_option("--set", options.overrides, "Overrides element.attribute=value; may be repeated")
      ->type_name("NAME=VALUE")
      ->expected(1)
      ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll);
  app.add_option("-i,--id", options.id, "Name of this deputy; without it the host's name")
      ->type_name("ID");
  app.add_option("-u,--lcm-url,--lcmurl", options.lcm_url, "udpm://GROUP:PORT?ttl=N")
      ->type_name("URL");
  app.add_option("--channel-prefix", options.channel_prefix, "Put before every channel name")
      ->type_name("TEXT");
  app.add_option("-l,--log", options.log_file, "The deputy's own messages go to this file")
      ->type_name("FILE");
  app.add_option("--log-level", options.log_level, "trace, debug, info, warn, error or off")
      ->check(CLI::IsMember({"trace", "debug", "info", "warn", "error", "off"}));
  app.add_flag("-v,--verbose", options.is_verbose, "The same as --log-level debug");
  app.add_flag("--allow-any", options.allow_any, "Run whatever a sheriff on the bus asks for");
  app.add_flag("--allow-root", options.allow_root, "Run commands as root");
  app.add_flag("--check-config", options.check_config, "Check the host's file and stop");
  app.add_flag("--print-config", options.print_config, "Print what is in force and stop");
}

// One deputy a state folder; the lock goes with the process, however it ends.
void LockFolder(const std::filesystem::path& folder) {
  std::filesystem::create_directories(folder);
  const std::filesystem::path file = folder / "lock";
  const int fd = open(file.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0600);
  if (fd < 0 || flock(fd, LOCK_EX | LOCK_NB) != 0) {
    throw std::runtime_error(file.string() +
                             ": another deputy uses this folder, or it cannot be "
                             "written: " +
                             std::strerror(errno));
  }
}

void OpenLogFile(const std::filesystem::path& path) {
  if (path.empty()) return;
  const int fd = open(path.c_str(), O_WRONLY | O_CREAT | O_APPEND | O_CLOEXEC, 0644);
  if (fd < 0) throw std::runtime_error(path.string() + ": cannot write: " + std::strerror(errno));
  dup2(fd, STDERR_FILENO);
  close(fd);
}

bool MayRun(const DeputyOptions& options, const DeputyFile& file) {
  if (geteuid() == 0 && !options.allow_root) {
    std::fputs(
        "clearway-deputy: started as root, and commands would run as root: start it as another "
        "user, or say --allow-root\n",
        stderr);
    return false;
  }
  if (!options.allow_any && file.allow.empty()) {
    process::LogWarning(std::string("nothing may run here: there is no <allow> in ") +
                        (options.config_path.empty() ? kHostFile : options.config_path.c_str()) +
                        " (or say --allow-any)");
  }
  return true;
}

// What is not kept apart by a folder of its own has no earlier life.
std::string MarkOf(const DeputySettings& settings) {
  return settings.id + ':' +
         (settings.orders_file.empty() ? std::to_string(getpid())
                                       : std::filesystem::absolute(settings.orders_file).string());
}

void KillLeftovers(ChildSet& children) {
  const int count = children.KillLeftovers();
  if (count == 0) return;
  process::LogWarning(std::to_string(count) +
                      " processes of an earlier life of this deputy were still there: killed");
}

// What command lines call ${CLEARWAY_CONFIG}, where the host's file says what that is.
void NameGraphConfig(const DeputyConfig& config) {
  if (!config.graph_config.empty()) {
    setenv("CLEARWAY_CONFIG", std::filesystem::absolute(config.graph_config).c_str(), 1);
  }
}

// A limit of the file size and a reader of stderr that is gone are errors of a write, no reason to
// end. Children have all signals at their defaults.
void IgnoreSignalsOfWrites() {
  std::signal(SIGPIPE, SIG_IGN);
  std::signal(SIGXFSZ, SIG_IGN);
}

int Serve(const DeputyOptions& options, const config::LoadResult<DeputyFile>& file) {
  DeputySettings settings = SettingsOf(options, file.root.deputy);
  if (!settings.orders_file.empty()) LockFolder(settings.orders_file.parent_path());
  NameGraphConfig(file.root.deputy);
  ConfigDigest digest(file.root.deputy.graph_config);
  settings.config_digest = [&digest] { return digest.Get(); };
  const process::BusConfig bus = BusOf(options, file);
  process::LiveRuntime runtime({bus, bus}, options.channel_prefix, process::MissingNetwork::kWait);
  std::optional<core::procman::AllowList> allowed;
  if (!options.allow_any) allowed.emplace(file.root.allow);
  ChildSet children(runtime, std::move(allowed), MarkOf(settings));
  int status = graph::kExitOk;
  DeputyProcess deputy(runtime, settings, children, [&](int end) {
    status = end;
    runtime.Stop();
  });
  if (!settings.orders_file.empty()) deputy.BeforeFirstStart([&] { KillLeftovers(children); });
  const SelfStart self_start(runtime, deputy, file.root.deputy.by_itself);
  runtime.OnSignal([&](int signal) {
    if (signal == SIGCHLD) {
      children.Reap();
    } else if (signal != SIGWINCH) {
      deputy.ShutDown();
    }
  });
  process::LogInfo("started as \"" + settings.id + "\" on " + bus.url);
  runtime.Run();
  process::LogInfo("stopped");
  return status;
}

int Main(int argc, char** argv) {
  CLI::App app("Runs and watches the commands of one host for procman's sheriffs",
               "clearway-deputy");
  DeputyOptions options;
  AddDeputyOptions(app, options);
  graph::Options wall;  // Of which GuardedMain reads the log level.
  app.parse_complete_callback(
      [&] { wall.log_level = options.is_verbose ? "debug" : options.log_level; });
  return graph::GuardedMain(app, wall, argc, argv, [&] {
    const config::LoadResult<DeputyFile> file = LoadDeputyFile(options);
    if (options.print_config) std::fputs(config::Print(file).c_str(), stdout);
    if (options.print_config || options.check_config) return graph::kExitOk;
    if (!MayRun(options, file.root)) return kExitNotPermitted;
    OpenLogFile(options.log_file);
    IgnoreSignalsOfWrites();
    return Serve(options, file);
  });
}

}  // namespace
}  // namespace clearway

int main(int argc, char** argv) {
  return clearway::Main(argc, argv);
}
