// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdint>
#include <span>

#include <Eigen/Geometry>

#include "common/core/livox/commands.hpp"
#include "common/core/livox/data_packet.hpp"
#include "common/core/simulation/lidar_scan.hpp"
#include "common/core/simulation/world.hpp"

namespace clearway::core {

/// An echo of a shot as the sensor measures it; all zero when there was none.
struct SimulatedEcho {
  livox::WirePoint point_sensor;    ///< Frame sensor.
  std::int32_t object = kNoObject;  ///< What it lies on: an object, kFloorObject or kNoObject.
};

/// The echoes of a shot. In dual return the first and the strongest of the later ones; else the one
/// that the return mode asks for, and the second is all zero.
struct SimulatedShot {
  std::array<SimulatedEcho, 2> echoes;
};

/// A MID-70 in a world. Same seed, world, poses and shots: same echoes.
class SimulatedLidar {
 public:
  SimulatedLidar(const SimulatedLidarConfig& config, std::uint64_t seed);

  /// Fires shots first_shot, first_shot + 1, ... (their directions: Mid70Direction()), one for each
  /// element of `shots`, all from T_map_sensor into the world as it is at `time_us` after the
  /// scene's start. Allocates nothing once sizes have settled.
  /// @pre first_shot >= 0, time_us >= 0.
  void Fire(World& world,
            std::int64_t time_us,
            const Eigen::Isometry3d& T_map_sensor,
            std::int64_t first_shot,
            std::span<SimulatedShot> shots,
            livox::ReturnMode mode = livox::ReturnMode::kDual);

 private:
  SimulatedLidarConfig config_;
  std::uint64_t seed_;
};

}  // namespace clearway::core
