// SPDX-License-Identifier: BSD-3-Clause
#include <filesystem>
#include <memory>
#include <stdexcept>

#include <CLI/CLI.hpp>

#include "common/graph/finite_check.hpp"
#include "common/graph/output_files.hpp"
#include "common/graph/process_main.hpp"
#include "common/net/udp_network.hpp"
#include "processes/livox_driver/livox_driver_process.hpp"
#include "processes/livox_driver/lvx_recorder.hpp"
#include "processes/livox_driver/lvx_replay.hpp"

namespace clearway {
namespace {

struct Arguments {
  LvxReplaySettings replay;
  std::filesystem::path record;
};

void AddArguments(CLI::App& app, Arguments& arguments) {
  auto* const replay =
      app.add_option("--replay", arguments.replay.file, "Play this LVX file instead of listening")
          ->check(CLI::ExistingFile)
          ->type_name("FILE");
  app.add_option("--speed", arguments.replay.speed, "Times real time; 0: as fast as it goes")
      ->check(graph::Finite())
      ->check(CLI::Range(0.0, 1000.0))
      ->needs(replay)
      ->type_name("FACTOR");
  app.add_flag("--loop", arguments.replay.loop, "Begin again at the end")->needs(replay);
  app.add_option("--record", arguments.record, "Write all packets into this LVX file")
      ->excludes(replay)
      ->type_name("FILE");
}

// A driver with the network and the recorder that it needs.
struct LiveDriver {
  LiveDriver(const graph::GraphConfig& config,
             const std::filesystem::path& record,
             process::Node& node,
             process::LiveRuntime& runtime)
      : network(runtime), driver(config.livox_driver, config.vehicle, node, network) {
    if (record.empty()) return;
    recorder = std::make_unique<LvxRecorder>(record, config.livox_driver, config.vehicle);
    driver.SetPacketTap([this](std::size_t lidar, const net::Datagram& datagram) {
      recorder->Add(lidar, datagram);
    });
    runtime.Every(1'000'000, [this, &node] {
      node.SetCounter("recorded_packets", recorder->packages());
      node.SetCounter("recording_failed", recorder->problem().empty() ? 0 : 1);
    });
  }
  ~LiveDriver() {
    if (recorder) recorder->Close();
  }
  LiveDriver(const LiveDriver&) = delete;
  LiveDriver& operator=(const LiveDriver&) = delete;

  net::UdpNetwork network;
  std::unique_ptr<LvxRecorder> recorder;  // Outlives the driver's tap.
  LivoxDriverProcess driver;
};

}  // namespace
}  // namespace clearway

int main(int argc, char** argv) {
  using namespace clearway;
  Arguments arguments;
  return graph::ProcessMain(
      argc,
      argv,
      {.name = "livox_driver",
       .description = "Speaks to Livox MID-70 sensors and publishes their points as LIDAR_POINTS",
       .status_channel = messages::channels::kLivoxDriverStatus,
       .add_options = [&](CLI::App& app) { AddArguments(app, arguments); }},
      [&](const graph::GraphConfig& config,
          process::Node& node,
          process::LiveRuntime& runtime) -> std::shared_ptr<void> {
        if (arguments.replay.file.empty()) {
          return std::make_shared<LiveDriver>(config, arguments.record, node, runtime);
        }
        return std::make_shared<LvxReplay>(
            config.livox_driver, config.vehicle, arguments.replay, node, [&runtime] {
              runtime.Stop();
            });
      });
}
