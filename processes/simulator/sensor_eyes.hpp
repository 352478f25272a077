// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <span>

#include <Eigen/Geometry>

#include "common/core/simulation/simulated_lidar.hpp"
#include "common/core/simulation/truth_tally.hpp"
#include "processes/simulator/simulated_base.hpp"

namespace clearway {

/// What one sensor on the robot sees of the world, shot by shot.
class SensorEyes {
 public:
  /// World, base and tally must outlive it. `seed` is its own.
  SensorEyes(const core::SimulatedLidarConfig& config,
             std::uint64_t seed,
             const Eigen::Isometry3d& T_vehicle_sensor,
             core::World& world,
             SimulatedBase& base,
             core::TruthTally& tally)
      : lidar_(config, seed),
        T_body_sensor_(T_vehicle_sensor),
        world_(world),
        base_(base),
        tally_(tally) {}

  /// Fires the shots of a packet, all from where the sensor is at `begin_us` of the world.
  void Fire(std::int64_t first_shot,
            std::int64_t begin_us,
            core::livox::ReturnMode mode,
            std::span<core::SimulatedShot> shots) {
    const Eigen::Isometry3d T_map_sensor = PlaceAt(begin_us);
    lidar_.Fire(world_, begin_us, T_map_sensor, first_shot, mode, shots);
    tally_.Add(T_map_sensor, begin_us, shots);
  }

  /// T_map_sensor; the body may dive.
  [[nodiscard]] Eigen::Isometry3d PlaceAt(std::int64_t time_us) {
    return base_.StateAt(time_us).T_map_body() * T_body_sensor_;
  }

 private:
  core::SimulatedLidar lidar_;
  Eigen::Isometry3d T_body_sensor_;
  core::World& world_;
  SimulatedBase& base_;
  core::TruthTally& tally_;
};

}  // namespace clearway
