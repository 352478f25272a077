// SPDX-License-Identifier: BSD-3-Clause
#include <array>
#include <chrono>
#include <cstdio>
#include <fstream>
#include <unistd.h>

#include <CLI/CLI.hpp>

#include "common/graph/finite_check.hpp"
#include "common/graph/options.hpp"
#include "common/graph/output_files.hpp"
#include "common/process/log.hpp"
#include "tools/replay/batch.hpp"
#include "tools/run_graph/graph_run.hpp"
#include "tools/run_graph/picture.hpp"
#include "tools/run_graph/report.hpp"

namespace clearway::run_graph {
namespace {

namespace fs = std::filesystem;

constexpr char kPicture[] = "last_scan.png";
constexpr double kSimulated_s = 30.0;  // A simulation has no end of its own.

struct Arguments {
  graph::Options common;
  std::string input;
  fs::path output = "clearway_run";
  fs::path json;
  fs::path log;
  fs::path map;
  std::optional<double> stop_after_s;
  bool headless = false;
  bool batch = false;
  bool without_graph = false;
};

void AddArguments(CLI::App& app, Arguments& arguments) {
  graph::AddOptions(app, arguments.common);
  app.get_option("--config")->required(false);
  app.add_option(
         "--input",
         arguments.input,
         "Folder, list (.txt), .pcd, .bin, .lvx, LCM log, scene (.xml: simulated, or played "
         "where the vehicle is stationary), or \"live\"; without it the simulated lab")
      ->type_name("PATH");
  app.add_option("--output", arguments.output, "Folder for the picture and the processes' logs")
      ->take_last()
      ->type_name("FOLDER");
  app.add_option("--json", arguments.json, "Write the figures to this file")->type_name("FILE");
  app.add_option("--log", arguments.log, "Write all messages to this LCM log")->type_name("FILE");
  app.add_option("--map", arguments.map, "Serve this Nav2 map, and filter with it")
      ->type_name("FILE");
  app.add_option("--for", arguments.stop_after_s, "Stop after this time")
      ->check(graph::Finite())
      ->check(CLI::Range(0.001, 1e6))
      ->type_name("SECONDS");
  app.add_flag("--headless", arguments.headless, "No progress line");
  CLI::Option* const batch = app.add_flag(
      "--batch",
      arguments.batch,
      "Simulate in memory and virtual time, as fast as it goes; same seed, same messages");
  app.add_flag("--without-graph", arguments.without_graph, "Simulator and driver alone")
      ->needs(batch);
}

fs::path ProgramFolder() {
  return fs::read_symlink("/proc/self/exe").parent_path();
}

// The shipped configurations: installed beside the programs, else those of the sources.
fs::path ConfigFolder() {
  const fs::path installed = ProgramFolder().parent_path() / "share" / "clearway" / "config";
  return fs::exists(installed) ? installed : fs::path(CLEARWAY_SOURCE_CONFIG);
}

bool IsLcmLog(const fs::path& path) {
  if (!fs::is_regular_file(path)) return false;
  constexpr std::array<unsigned char, 4> kSync{0xED, 0xA1, 0xDA, 0x01};
  std::array<char, 4> head{};
  std::ifstream(path, std::ios::binary).read(head.data(), head.size());
  return std::equal(head.begin(), head.end(), kSync.begin(), [](char a, unsigned char b) {
    return static_cast<unsigned char>(a) == b;
  });
}

InputKind KindOf(const std::string& input, const graph::GraphConfig& config) {
  if (input == "live") return InputKind::kLive;
  const fs::path extension = fs::path(input).extension();
  if (extension == ".lvx") return InputKind::kLvx;
  if (extension == ".xml" && !config.vehicle.stationary) return InputKind::kSimulated;
  return IsLcmLog(input) ? InputKind::kLog : InputKind::kPlayed;
}

// Without an input the lab is driven through, and only then there is a configuration to start from.
void FillIn(Arguments& arguments) {
  if (arguments.common.config_path.empty()) {
    if (!arguments.input.empty()) {
      throw std::runtime_error("--input needs --config: the shipped ones are in " +
                               ConfigFolder().string());
    }
    arguments.common.config_path = ConfigFolder() / "lab.xml";
  }
  if (arguments.input.empty()) arguments.input = ConfigFolder() / "lab_scene.xml";
  if (arguments.input != "live" && !fs::exists(arguments.input)) {
    throw std::runtime_error("--input " + arguments.input + ": no such file or folder");
  }
  if (fs::path(arguments.input).extension() == ".xml") {
    arguments.common.overrides.push_back("simulator.scene=" +
                                         fs::absolute(arguments.input).string());
  }
  if (!arguments.map.empty()) {
    graph::ServeMap(arguments.map, arguments.common);
  }
}

std::vector<std::string> ChildArguments(const graph::Options& options) {
  std::vector<std::string> arguments{"--config", options.config_path};
  for (const std::string& set : options.overrides) {
    arguments.insert(arguments.end(), {"--set", set});
  }
  if (!options.lcm_url.empty()) arguments.insert(arguments.end(), {"--lcm-url", options.lcm_url});
  if (!options.channel_prefix.empty()) {
    arguments.insert(arguments.end(), {"--channel-prefix", options.channel_prefix});
  }
  return arguments;
}

RunSettings SettingsOf(const Arguments& arguments, const graph::GraphConfig& config) {
  RunSettings settings;
  settings.kind = KindOf(arguments.input, config);
  settings.input = arguments.input;
  settings.program_folder = ProgramFolder();
  settings.output_folder = arguments.output;
  settings.child_arguments = ChildArguments(arguments.common);
  settings.buses = config.buses;
  settings.channel_prefix = arguments.common.channel_prefix;
  settings.with_map_server = !config.map_server.file.empty();
  settings.wait_for_map = settings.with_map_server && config.preprocessor.map_filter.enabled;
  settings.with_pose_source = config.pose_source.mode != core::PoseSourceMode::kOff;
  settings.stop_after_s = arguments.stop_after_s;
  if (settings.kind == InputKind::kSimulated && !settings.stop_after_s) {
    settings.stop_after_s = kSimulated_s;
  }
  settings.log = arguments.log;
  settings.show_progress = !arguments.headless && isatty(STDERR_FILENO) != 0;
  return settings;
}

// NAME.log, and NAME.log.1 and so on, which were full.
bool IsLogOf(const std::string& process, const std::string& file) {
  const std::string log = process + ".log";
  return file == log || (file.starts_with(log + '.') &&
                         file.find_first_not_of("0123456789", log.size() + 1) == file.npos);
}

// Those of an earlier run: deputies append to logs.
void RemoveResults(const fs::path& folder) {
  fs::remove(folder / kPicture);
  std::vector<fs::path> logs;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder)) {
    for (const char* process : {"preprocessor",
                                "clusterer",
                                "stop_guard",
                                "map_server",
                                "pose_source",
                                "livox_driver",
                                "simulator",
                                "play"}) {
      if (IsLogOf(process, entry.path().filename())) logs.push_back(entry.path());
    }
  }
  for (const fs::path& log : logs) fs::remove(log);
}

void Report(const Arguments& arguments, const graph::GraphConfig& config, const GraphRun& run) {
  const RunSummary summary = run.statistics().Summarise();
  std::fputs(FormatTable(summary, run.machine_use()).c_str(), stdout);
  if (run.statistics().LastDetectedScan() != nullptr) {
    const fs::path picture = arguments.output / kPicture;
    plot::WritePng(MakePicture(run.statistics(), config), picture);
    std::printf("\npicture of the last scan: %s\n", picture.c_str());
  }
  if (!arguments.json.empty()) {
    graph::WriteFile(arguments.json, FormatJson(summary, run.machine_use()));
  }
}

int RunAndReport(const Arguments& arguments, const graph::GraphConfig& config) {
  graph::RefuseToOverwrite({arguments.log, arguments.json},
                           {arguments.input, arguments.map, arguments.common.config_path});
  fs::create_directories(arguments.output);
  RemoveResults(arguments.output);
  process::LiveRuntime runtime(config.buses, arguments.common.channel_prefix);
  process::Node node(
      runtime, {"run", CLEARWAY_VERSION, config::Digest(config)}, messages::channels::kRunStatus);
  GraphRun run(runtime, node, SettingsOf(arguments, config));
  run.Run();
  Report(arguments, config, run);
  if (run.statistics().num_detected() == 0) {
    throw std::runtime_error("no scan went through the whole graph; what the processes say is in " +
                             arguments.output.string());
  }
  if (run.input_problem().empty()) return graph::kExitOk;
  std::fprintf(stderr, "clearway-run: %s", run.input_problem().c_str());
  return graph::kExitFailure;
}

int RunBatchAndReport(const Arguments& arguments, const graph::GraphConfig& config) {
  if (KindOf(arguments.input, config) != InputKind::kSimulated) {
    throw std::runtime_error(
        "--batch simulates: it needs a scene (.xml) and a vehicle that is not "
        "stationary");
  }
  graph::RefuseToOverwrite({arguments.log, arguments.json},
                           {arguments.input, arguments.map, arguments.common.config_path});
  const bool shows_progress = !arguments.headless && isatty(STDERR_FILENO) != 0;
  const auto begin = std::chrono::steady_clock::now();
  const auto wall_s = [begin] {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  };
  replay::BatchSettings settings{.duration_s = arguments.stop_after_s.value_or(kSimulated_s),
                                 .with_graph = !arguments.without_graph,
                                 .log = arguments.log,
                                 .channel_prefix = arguments.common.channel_prefix,
                                 .version = CLEARWAY_VERSION};
  if (shows_progress) {
    settings.on_progress = [&](double done_s) {
      std::fprintf(stderr, "\rsimulated %.1f s, %.1f times real time ", done_s, done_s / wall_s());
    };
  }
  const RunSummary summary = replay::RunBatch(config, settings);
  const double took_s = wall_s();
  if (shows_progress) std::fputc('\n', stderr);
  std::fputs(FormatTable(summary, std::nullopt).c_str(), stdout);
  std::printf("\n%-24s %8.1f\n", "times real time", settings.duration_s / took_s);
  if (!arguments.json.empty()) {
    graph::WriteFile(arguments.json, FormatJson(summary, std::nullopt));
  }
  return graph::kExitOk;
}

int Main(int argc, char** argv) {
  CLI::App app("Starts the whole graph over LCM, plays an input through it and sums up",
               "clearway-run");
  Arguments arguments;
  AddArguments(app, arguments);
  return graph::GuardedMain(app, arguments.common, argc, argv, [&] {
    // What the processes say in virtual time is in the log's statuses.
    if (arguments.batch && app.get_option("--log-level")->empty()) {
      process::SetUpLog(app.get_name(), "warn");
    }
    FillIn(arguments);
    const auto config = graph::LoadConfig(arguments.common);
    if (graph::AnsweredByConfig(arguments.common, config)) return graph::kExitOk;
    return arguments.batch ? RunBatchAndReport(arguments, config.root)
                           : RunAndReport(arguments, config.root);
  });
}

}  // namespace
}  // namespace clearway::run_graph

int main(int argc, char** argv) {
  return clearway::run_graph::Main(argc, argv);
}
