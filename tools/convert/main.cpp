// SPDX-License-Identifier: BSD-3-Clause
#include <cstdio>
#include <unistd.h>

#include <CLI/CLI.hpp>

#include "common/graph/finite_check.hpp"
#include "common/graph/options.hpp"
#include "tools/convert/convert.hpp"

namespace clearway::convert {
namespace {

struct Arguments {
  Settings settings;
  double period_ms = 100.0;
};

void AddArguments(CLI::App& app, Arguments& arguments) {
  SourceSettings& source = arguments.settings.source;
  app.set_version_flag("--version", CLEARWAY_VERSION);
  app.add_option("input", source.input, "LVX file, folder of .pcd and .bin, or LCM log")
      ->required()
      ->type_name("INPUT");
  app.add_option("output",
                 arguments.settings.output,
                 "FILE.lvx, a folder for .pcd files, or FILE.lcm for a log of LIDAR_POINTS; of "
                 "another kind than the input")
      ->required()
      ->type_name("OUTPUT");
  app.add_option("--period",
                 arguments.period_ms,
                 "Time of a scan [ms]: packets are cut into scans on this grid, scans of a folder "
                 "last so long. Scans of a log stay as they are")
      ->check(graph::Finite())
      ->check(CLI::Range(10.0, 10000.0))
      ->capture_default_str();
  app.add_option("--start",
                 source.start_utime,
                 "When the recording began [us since the epoch]. Without: its PTP or GPS stamps, "
                 "or the names of its files, where they say so; else 2001-09-09")
      ->check(CLI::Range(std::int64_t{0}, std::int64_t{7'258'118'400'000'000}))
      ->type_name("UTIME");
  app.add_option("--sensor",
                 source.sensors,
                 "Name in LIDAR_POINTS; for an LVX file once for each device, in its order")
      ->expected(1)
      ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll)
      ->type_name("NAME");
  app.add_option("--floats-per-point",
                 source.floats_per_point,
                 "Of a folder's .bin files: 3 (x y z) or 4 (x y z intensity)")
      ->check(CLI::IsMember({3, 4}))
      ->capture_default_str();
  app.add_option("--intensity-scale",
                 source.intensity_scale,
                 "Intensities of a folder's files times this are 0..255")
      ->check(graph::Finite())
      ->check(CLI::Range(0.0, 100000.0));
  app.add_option(
         "--channel-prefix", source.channel_prefix, "Put before every channel name of a log")
      ->type_name("TEXT");
}

int Run(Arguments& arguments) {
  arguments.settings.source.scan_period_us =
      static_cast<std::int64_t>(arguments.period_ms * 1000.0 + 0.5);
  const bool shows_progress = isatty(STDERR_FILENO) != 0;
  int shown_percent = -1;
  const Report report = Convert(arguments.settings, [&](double share) {
    const int percent = static_cast<int>(100.0 * share);
    if (!shows_progress || percent == shown_percent) return;
    shown_percent = percent;
    std::fprintf(stderr, "\r%d %%", percent);
  });
  if (shows_progress) std::fputs("\r", stderr);
  for (const std::string& remark : report.read.remarks)
    std::fprintf(stderr, "%s\n", remark.c_str());
  for (const std::string& problem : report.read.problems) {
    std::fprintf(stderr, "%s\n", problem.c_str());
  }
  std::printf("%s: %s\n", arguments.settings.output.c_str(), Describe(report).c_str());
  return report.read.problems.empty() ? graph::kExitOk : graph::kExitFailure;
}

int Main(int argc, char** argv) {
  CLI::App app("Converts recordings between LVX files, folders of .pcd and LCM logs",
               "clearway-convert");
  Arguments arguments;
  AddArguments(app, arguments);
  return graph::GuardedMain(app, {}, argc, argv, [&] { return Run(arguments); });
}

}  // namespace
}  // namespace clearway::convert

int main(int argc, char** argv) {
  return clearway::convert::Main(argc, argv);
}
