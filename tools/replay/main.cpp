// SPDX-License-Identifier: BSD-3-Clause
#include <chrono>
#include <cstdio>
#include <stdexcept>
#include <unistd.h>

#include <CLI/CLI.hpp>

#include "common/graph/options.hpp"
#include "common/graph/output_files.hpp"
#include "tools/replay/replay.hpp"
#include "tools/replay/report.hpp"

namespace clearway::replay {
namespace {

namespace fs = std::filesystem;
using Clock = std::chrono::steady_clock;

struct Arguments {
  graph::Options common;
  fs::path log;
  fs::path output;
  fs::path compare;
  fs::path map;
  fs::path json;
  bool with_inputs = false;
  bool headless = false;
};

void AddArguments(CLI::App& app, Arguments& arguments) {
  graph::AddOptions(app, arguments.common);
  app.add_option("log", arguments.log, "LCM log with LIDAR_POINTS")->required()->type_name("LOG");
  app.add_option("--output", arguments.output, "Write what the graph publishes to this LCM log")
      ->type_name("FILE");
  app.add_flag("--with-inputs", arguments.with_inputs, "Write what is fed to --output, too")
      ->needs("--output");
  app.add_option("--compare",
                 arguments.compare,
                 "LCM log with DETECTIONS of the same scans, which must be equal bit by bit")
      ->type_name("FILE");
  app.add_option("--map", arguments.map, "Serve this Nav2 map, and filter with it")
      ->type_name("FILE");
  app.add_option("--json", arguments.json, "Write the figures to this file")->type_name("FILE");
  app.add_flag("--headless", arguments.headless, "No progress line");
}

double SecondsSince(Clock::time_point begin) {
  return std::chrono::duration<double>(Clock::now() - begin).count();
}

// A line on the terminal, five times a second at most.
class ProgressLine {
 public:
  void Show(const Progress& progress) {
    const Clock::time_point now = Clock::now();
    if (now - last_ < std::chrono::milliseconds(200)) return;
    last_ = now;
    std::fprintf(stderr,
                 "\rreplayed %3.0f %% of the log, %.1f times real time ",
                 progress.share * 100.0,
                 progress.recorded_s / SecondsSince(begin_));
    is_shown_ = true;
  }

  void End() const {
    if (is_shown_) std::fputc('\n', stderr);
  }

 private:
  Clock::time_point begin_ = Clock::now();
  Clock::time_point last_ = begin_;
  bool is_shown_ = false;
};

int ReplayAndReport(const Arguments& arguments, const graph::GraphConfig& config) {
  graph::RefuseToOverwrite(
      {arguments.output, arguments.json},
      {arguments.log, arguments.compare, arguments.map, arguments.common.config_path});
  ReplaySettings settings{.log = arguments.log,
                          .output = arguments.output,
                          .with_inputs = arguments.with_inputs,
                          .channel_prefix = arguments.common.channel_prefix,
                          .version = CLEARWAY_VERSION};
  ProgressLine line;
  if (!arguments.headless && isatty(STDERR_FILENO) != 0) {
    settings.on_progress = [&line](const Progress& progress) { line.Show(progress); };
  }
  const Clock::time_point begin = Clock::now();
  const ReplayResult result = Replay(config, settings);
  Report report{.result = result, .wall_s = SecondsSince(begin), .comparison = {}};
  line.End();
  if (!arguments.compare.empty()) {
    report.comparison =
        Compare(result.detections, ReadDetections(arguments.compare, settings.channel_prefix));
  }
  std::fputs(FormatTable(report).c_str(), stdout);
  if (!arguments.json.empty()) graph::WriteFile(arguments.json, FormatJson(report));
  const std::string problems = Problems(report);
  std::fputs(problems.c_str(), stderr);
  return problems.empty() ? graph::kExitOk : graph::kExitFailure;
}

int Main(int argc, char** argv) {
  CLI::App app("Replays an LCM log through the whole graph in memory, as fast as it goes",
               "clearway-replay");
  Arguments arguments;
  arguments.common.log_level = "warn";  // What the processes say is in the output's statuses.
  AddArguments(app, arguments);
  return graph::GuardedMain(app, arguments.common, argc, argv, [&] {
    if (!arguments.map.empty()) {
      graph::ServeMap(arguments.map, arguments.common);
    }
    const auto config = graph::LoadConfig(arguments.common);
    if (graph::AnsweredByConfig(arguments.common, config)) return graph::kExitOk;
    return ReplayAndReport(arguments, config.root);
  });
}

}  // namespace
}  // namespace clearway::replay

int main(int argc, char** argv) {
  return clearway::replay::Main(argc, argv);
}
