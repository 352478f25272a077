// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "common/core/simulation/simulator_config.hpp"
#include "common/core/simulation/world.hpp"
#include "common/core/vehicle.hpp"
#include "common/net/datagrams.hpp"
#include "common/process/node.hpp"
#include "processes/simulator/emulated_sensor.hpp"
#include "processes/simulator/sensor_eyes.hpp"
#include "processes/simulator/simulated_base.hpp"
#include "processes/simulator/world_clock.hpp"

namespace clearway {

/// A world with a robot in it and sensors on a network: DRIVE_PERMIT, DRIVE_REQUEST or
/// DRIVE_COMMAND
/// -> ODOMETRY, POSE, POSE_STATUS, TRUTH, and the sensors' datagrams. See README.md beside this
/// file.
class SimulatorProcess {
 public:
  /// What is simulated.
  struct Setting {
    core::SceneConfig scene;
    std::optional<core::MapWalls> walls;
    std::int64_t scan_period_us = 100'000;  ///< Of the driver: TRUTH comes once a scan.
  };

  /// The world's time starts now. Throws std::invalid_argument where a sensor is not on the
  /// vehicle, net::NetworkError where a sensor's address cannot be had.
  SimulatorProcess(const core::SimulatorConfig& config,
                   const core::VehicleConfig& vehicle,
                   Setting setting,
                   process::Node& node,
                   net::Network& network);

  [[nodiscard]] const std::vector<std::unique_ptr<EmulatedSensor>>& sensors() const {
    return sensors_;
  }
  [[nodiscard]] SimulatedBase& base() { return base_; }

 private:
  void AddSensor(std::size_t index, const core::VehicleConfig& vehicle, net::Network& network);
  void ScheduleTruth();
  void PublishTruth(std::int64_t scan_id);
  void SetSensorCounters();
  [[nodiscard]] std::string SensorText() const;
  void Refresh();

  core::SimulatorConfig config_;
  Setting setting_;
  process::Node& node_;
  WorldClock clock_;
  core::World world_;
  core::TruthTally tally_;
  SimulatedBase base_;
  std::vector<std::unique_ptr<SensorEyes>> eyes_;
  std::vector<std::unique_ptr<EmulatedSensor>> sensors_;
};

}  // namespace clearway
