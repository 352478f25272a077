// SPDX-License-Identifier: BSD-3-Clause
#include <cstdio>
#include <optional>
#include <unistd.h>

#include <CLI/CLI.hpp>

#include "common/graph/finite_check.hpp"
#include "common/graph/options.hpp"
#include "common/graph/output_files.hpp"
#include "common/io/lcm_log.hpp"
#include "common/io/read_error.hpp"
#include "common/process/live_runtime.hpp"
#include "common/process/log.hpp"
#include "common/process/simulated_runtime.hpp"
#include "tools/play/player.hpp"

namespace clearway::play {
namespace {

struct Arguments {
  graph::Options common;
  std::filesystem::path input;
  std::filesystem::path to_log;
  std::optional<double> rate_hz;
  double scene_s = 10.0;
  PlayerSettings player;
  bool headless = false;
};

void AddArguments(CLI::App& app, Arguments& arguments) {
  graph::AddOptions(app, arguments.common);
  app.add_option("--input",
                 arguments.input,
                 "Folder (searched recursively for .pcd and .bin), list (.txt), one .pcd or .bin, "
                 "or scene (.xml)")
      ->required()
      ->type_name("PATH");
  app.add_option("--to-log", arguments.to_log, "Write an LCM log at once instead of playing")
      ->type_name("FILE");
  app.add_option("--rate", arguments.rate_hz, "Scans per second instead of the recording's own")
      ->check(graph::Finite())
      ->type_name("HZ");
  app.add_option("--scene-seconds", arguments.scene_s, "How long a scene is played")
      ->check(graph::Finite())
      ->check(CLI::Range(0.1, 86400.0))
      ->type_name("S");
  app.add_option("--settle", arguments.player.settle_s, "Wait before the first scan")
      ->check(graph::Finite())
      ->check(CLI::Range(0.0, 60.0))
      ->type_name("S");
  app.add_flag("--loop", arguments.player.loop, "Begin again at the end");
  app.add_flag("--headless", arguments.headless, "No progress line");
}

// On a terminal only: in a file, one line at the end says as much.
bool ShowsProgress(const Arguments& arguments) {
  return !arguments.headless && isatty(STDERR_FILENO) != 0;
}

void ShowProgress(const Arguments& arguments, const Player& player, const ScanSource& source) {
  if (!ShowsProgress(arguments)) return;
  std::fprintf(stderr,
               "\rplayed %zu of %zu scans%s",
               player.progress().played,
               source.size(),
               player.progress().unreadable > 0 ? " (some unreadable)" : "");
}

int ExitStatus(const Arguments& arguments, const Player& player) {
  const Player::Progress& progress = player.progress();
  std::fprintf(stderr,
               "%splayed %zu scans, %zu could not be read\n",
               ShowsProgress(arguments) ? "\n" : "",
               progress.played,
               progress.unreadable);
  return progress.unreadable == 0 ? graph::kExitOk : graph::kExitFailure;
}

int PlayLive(const Arguments& arguments, const graph::GraphConfig& config, ScanSource& source) {
  process::LiveRuntime runtime(config.buses, arguments.common.channel_prefix);
  process::Node node(
      runtime, {"play", CLEARWAY_VERSION, config::Digest(config)}, messages::channels::kPlayStatus);
  const Player player(node, source, arguments.player, [&runtime] { runtime.Stop(); });
  runtime.Every(200'000, [&] { ShowProgress(arguments, player, source); });
  runtime.Run();
  node.RefreshAndPublishStatus();
  ShowProgress(arguments, player, source);
  return ExitStatus(arguments, player);
}

int WriteLog(const Arguments& arguments, const graph::GraphConfig& config, ScanSource& source) {
  graph::RefuseToOverwrite({arguments.to_log}, {arguments.input, arguments.common.config_path});
  io::LcmLogWriter log(arguments.to_log);
  process::SimulatedRuntime runtime(
      source.utime(0),
      {.max_message_bytes = static_cast<std::size_t>(config.buses.local.max_message_bytes)});
  runtime.SetTap(
      [&](messages::BusId, const std::string& channel, std::span<const std::byte> bytes) {
        log.Write(runtime.UtimeNow(), arguments.common.channel_prefix + channel, bytes);
      });
  process::Node node(
      runtime, {"play", CLEARWAY_VERSION, config::Digest(config)}, messages::channels::kPlayStatus);
  bool done = false;
  const Player player(node, source, arguments.player, [&done] { done = true; });
  while (!done) {
    runtime.RunUntil(runtime.MonotonicUs() + source.period_us());
    ShowProgress(arguments, player, source);
  }
  return ExitStatus(arguments, player);
}

int Main(int argc, char** argv) {
  CLI::App app("Plays recorded or generated scans as LIDAR_POINTS", "clearway-play");
  Arguments arguments;
  AddArguments(app, arguments);
  return graph::GuardedMain(app, arguments.common, argc, argv, [&] {
    if (arguments.rate_hz) {
      arguments.common.overrides.push_back("recording.stamp=rate");
      arguments.common.overrides.push_back("recording.rate_hz=" +
                                           std::to_string(*arguments.rate_hz));
    }
    const auto config = graph::LoadConfig(arguments.common);
    if (graph::AnsweredByConfig(arguments.common, config)) return graph::kExitOk;
    if (!arguments.to_log.empty() && arguments.player.loop) {
      std::fputs("clearway-play: --loop never ends, so it does not go with --to-log\n", stderr);
      return graph::kExitUsage;
    }
    arguments.player.sensor = config.root.vehicle.sensors.front().name;
    const auto source = OpenSource(arguments.input, config.root, arguments.scene_s);
    if (source->size() == 0) throw io::ReadError(arguments.input.string() + ": holds no scan");
    process::LogInfo("playing " + std::to_string(source->size()) + " scans of " +
                     arguments.input.string());
    return arguments.to_log.empty() ? PlayLive(arguments, config.root, *source)
                                    : WriteLog(arguments, config.root, *source);
  });
}

}  // namespace
}  // namespace clearway::play

int main(int argc, char** argv) {
  return clearway::play::Main(argc, argv);
}
