// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "common/core/simulation/emulated_sensor_config.hpp"
#include "common/core/simulation/lidar_scan.hpp"
#include "common/core/simulation/render_map.hpp"
#include "common/core/simulation/robot_config.hpp"

namespace clearway::core {

/// Settings of the simulator. XML element: <simulator>.
struct SimulatorConfig {
  std::string scene;
  std::string walls;
  double wall_height_m = 2.5;
  double wall_reflectivity = 0.6;
  int seed = 1;
  MapErrorConfig map_error;
  RobotConfig robot;
  SimulatedLidarConfig lidar;
  std::vector<EmulatedSensorConfig> sensors = {EmulatedSensorConfig{}};

  template <typename Self, typename Visitor>
  static void Visit(Self& self, Visitor& visitor) {
    visitor.Text("scene",
                 self.scene,
                 "The XML file of a scene: what stands, moves, appears and vanishes. A relative "
                 "path starts at this configuration's folder.");
    visitor.Text("walls",
                 self.walls,
                 "The YAML file of a Nav2 map whose occupied cells become walls; likewise. Empty: "
                 "none but the scene's own.");
    visitor.Number("wall_height_m", self.wall_height_m, 0.05, 100.0, "Of the map's walls [m].");
    visitor.Number("wall_reflectivity", self.wall_reflectivity, 0.0, 1.0, "Of the map's walls.");
    visitor.Integer("seed", self.seed, 0, 2147483647, "Of all that is random.");
    visitor.Group("map_error", self.map_error, "What --write-map gets wrong.");
    visitor.Group("robot", self.robot, "The robot that carries the sensors.");
    visitor.Group("lidar", self.lidar, "What its sensors can see.");
    visitor.List("mid70", self.sensors, "Sensors that it is, on the network.");
  }
};

}  // namespace clearway::core
