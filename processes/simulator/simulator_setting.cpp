// SPDX-License-Identifier: BSD-3-Clause
#include "processes/simulator/simulator_setting.hpp"

#include <stdexcept>

#include "common/config/config.hpp"
#include "common/io/map/map_file.hpp"

namespace clearway {

SimulatorProcess::Setting LoadSetting(const graph::GraphConfig& config,
                                      const std::filesystem::path& scene) {
  const core::SimulatorConfig& simulator = config.simulator;
  if (scene.empty() && simulator.scene.empty()) {
    throw std::runtime_error(
        "no scene: set simulator.scene to the XML file of one, or give --scene FILE");
  }
  SimulatorProcess::Setting setting;
  setting.scene =
      config::Load<core::SceneFile>(scene.empty() ? config.folder / simulator.scene : scene)
          .root.scene;
  if (!simulator.walls.empty()) {
    setting.walls = core::MapWalls{.grid = io::LoadMap(config.folder / simulator.walls).grid,
                                   .height_m = simulator.wall_height_m,
                                   .reflectivity = simulator.wall_reflectivity};
  }
  setting.scan_period_us = config.livox_driver.scan_period_us;
  return setting;
}

}  // namespace clearway
