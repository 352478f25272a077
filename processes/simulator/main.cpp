// SPDX-License-Identifier: BSD-3-Clause
#include <filesystem>
#include <memory>
#include <stdexcept>

#include <CLI/CLI.hpp>

#include "common/core/simulation/render_map.hpp"
#include "common/graph/process_main.hpp"
#include "common/io/map/map_writer.hpp"
#include "common/net/udp_network.hpp"
#include "common/process/log.hpp"
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

void WriteMap(const graph::GraphConfig& config,
              const std::filesystem::path& scene,
              const std::filesystem::path& map) {
  const core::OccupancyGrid grid =
      core::RenderMap(LoadSetting(config, scene).scene, {.error = config.simulator.map_error});
  if (grid.cells.empty()) throw std::runtime_error("the scene has no object with on_map=\"true\"");
  io::SaveMap(grid, map);
  process::LogInfo("wrote " + map.string() + ", " + std::to_string(grid.geometry.width) + " x " +
                   std::to_string(grid.geometry.height) + " cells");
}

}  // namespace
}  // namespace clearway

int main(int argc, char** argv) {
  using namespace clearway;
  std::filesystem::path scene;
  std::filesystem::path map;
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
             app.add_option("--write-map",
                            map,
                            "Write the map that a robot would have of the scene, with "
                            "simulator.map_error, and end")
                 ->type_name("YAML");
           },
       .answer =
           [&](const graph::GraphConfig& config) {
             if (map.empty()) return false;
             WriteMap(config, scene, map);
             return true;
           }},
      [&](const graph::GraphConfig& config,
          process::Node& node,
          process::LiveRuntime& runtime) -> std::shared_ptr<void> {
        if (!map.empty()) {
          WriteMap(config, scene, map);
          runtime.Stop();
          return nullptr;
        }
        return std::make_shared<LiveSimulator>(config, scene, node, runtime);
      });
}
