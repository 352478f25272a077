// SPDX-License-Identifier: BSD-3-Clause
#include <cstdio>

#include <CLI/CLI.hpp>

#include "common/graph/options.hpp"
#include "tools/livox_load/load_run.hpp"

namespace clearway::livox_load {
namespace {

constexpr const char* kDescription =
    "Emulates all sensors of a configuration on this host, 127.0.0.2 and so on, for a running\n"
    "clearway-livox-driver with the same configuration, and compares what was sent with what the\n"
    "driver counts. Sensors are to be named sensor1, sensor2, ...; tools/load_driver does it all.";

void Print(const LoadResult& result) {
  const auto count = [&result](const char* name) {
    const auto found = result.driver.find(name);
    return static_cast<long long>(found == result.driver.end() ? -1 : found->second);
  };
  const auto missing = static_cast<long long>(result.sent) - count("packets");
  std::printf("driver: %s\n", result.driver_text.c_str());
  std::printf("sent %lld packets, not taken by the network %lld, not made in time %lld\n",
              static_cast<long long>(result.sent),
              static_cast<long long>(result.refused),
              static_cast<long long>(result.skipped));
  std::printf(
      "driver took %lld, missing %lld; lost by stamps %lld, late %lld, kernel drops %lld, "
      "receive buffer %lld bytes\n",
      count("packets"),
      missing,
      count("lost_packets"),
      count("late_packets"),
      count("kernel_drops"),
      count("data_buffer_bytes"));
  std::printf("driver used %.1f %% of a processor over %.1f s\n",
              100.0 * result.driver_cpu,
              result.seconds);
}

int Run(int argc, char** argv) {
  CLI::App app(kDescription, "clearway-livox-load");
  graph::Options options;
  graph::AddOptions(app, options);
  double seconds = 30.0;
  app.add_option("--seconds", seconds, "How long to measure")
      ->check(CLI::Range(1.0, 86400.0))
      ->type_name("SECONDS");
  return graph::GuardedMain(app, options, argc, argv, [&] {
    const config::LoadResult<graph::GraphConfig> config = graph::LoadConfig(options);
    if (graph::AnsweredByConfig(options, config)) return graph::kExitOk;
    process::LiveRuntime runtime(config.root.buses, options.channel_prefix);
    LoadRun run(config.root, runtime);
    const LoadResult result = run.Measure(seconds);
    Print(result);
    return result.driver.at("packets") == result.sent ? graph::kExitOk : graph::kExitFailure;
  });
}

}  // namespace
}  // namespace clearway::livox_load

int main(int argc, char** argv) {
  return clearway::livox_load::Run(argc, argv);
}
