// SPDX-License-Identifier: BSD-3-Clause
#include <filesystem>
#include <memory>

#include <CLI/CLI.hpp>

#include "common/graph/process_main.hpp"
#include "common/net/udp_network.hpp"
#include "processes/simulator/simulator_process.hpp"
#include "processes/simulator/simulator_setting.hpp"

namespace clearway {
namespace {

// A simulator with the network that it needs.
struct LiveSimulator {
  LiveSimulator(const graph::GraphConfig& config,
                const std::filesystem::path& scene,
                process::Node& node,
                process::LiveRuntime& runtime)
      : network(runtime),
        simulator(config.simulator, config.vehicle, LoadSetting(config, scene), node, network) {}

  net::UdpNetwork network;
  SimulatorProcess simulator;
};

}  // namespace
}  // namespace clearway

int main(int argc, char** argv) {
  using namespace clearway;
  std::filesystem::path scene;
  return graph::ProcessMain(
      argc,
      argv,
      {.name = "simulator",
       .description = "Is a lab, a robot and MID-70 sensors on the network, all simulated",
       .status_channel = messages::channels::kSimulatorStatus,
       .add_options =
           [&](CLI::App& app) {
             app.add_option("--scene", scene, "Scene file instead of the configured one")
                 ->check(CLI::ExistingFile)
                 ->type_name("FILE");
           }},
      [&](const graph::GraphConfig& config, process::Node& node, process::LiveRuntime& runtime) {
        return std::make_shared<LiveSimulator>(config, scene, node, runtime);
      });
}
