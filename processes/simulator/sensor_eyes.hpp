// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>

#include <Eigen/Geometry>

#include "common/core/livox/data_packet.hpp"
#include "common/core/simulation/simulated_lidar.hpp"
#include "common/core/simulation/truth_tally.hpp"
#include "processes/simulator/simulated_base.hpp"
#include "processes/simulator/world_clock.hpp"

namespace clearway {

/// What one sensor on the robot sees of the world, shot by shot.
class SensorEyes {
 public:
  /// World, base, tally and clock must outlive it. The tally gets times of day, as scans have them.
  /// `seed` is its own.
  SensorEyes(const core::SimulatedLidarConfig& config,
             std::uint64_t seed,
             const Eigen::Isometry3d& T_vehicle_sensor,
             core::World& world,
             SimulatedBase& base,
             core::TruthTally& tally,
             std::int64_t scan_period_us,
             const WorldClock& clock)
      : lidar_(config, seed),
        T_body_sensor_(T_vehicle_sensor),
        world_(world),
        base_(base),
        tally_(tally),
        scan_period_us_(scan_period_us),
        clock_(clock) {}

  /// Fires the shots of a packet, all from where the sensor is at `begin_us` of the world.
  void Fire(std::int64_t first_shot,
            std::int64_t begin_us,
            core::livox::ReturnMode mode,
            std::span<core::SimulatedShot> shots) {
    const Eigen::Isometry3d T_map_sensor = PlaceAt(begin_us);
    lidar_.Fire(world_, begin_us, T_map_sensor, first_shot, mode, shots);
    Count(T_map_sensor, clock_.UtimeOf(begin_us), shots);
  }

  /// T_map_sensor; the body may dive.
  [[nodiscard]] Eigen::Isometry3d PlaceAt(std::int64_t time_us) {
    return base_.StateAt(time_us).T_map_body() * T_body_sensor_;
  }

 private:
  // A packet may begin in one scan and end in the next.
  void Count(const Eigen::Isometry3d& T_map_sensor,
             std::int64_t utime,
             std::span<const core::SimulatedShot> shots) {
    const std::int64_t left_us = scan_period_us_ - utime % scan_period_us_;
    const auto num_first = static_cast<std::size_t>((left_us + kShot_us - 1) / kShot_us);
    const auto first = shots.first(std::min(num_first, shots.size()));
    tally_.Add(T_map_sensor, utime, first);
    if (first.size() == shots.size()) return;
    const auto first_us = static_cast<std::int64_t>(first.size()) * kShot_us;
    tally_.Add(T_map_sensor, utime + first_us, shots.subspan(first.size()));
  }

  static constexpr std::int64_t kShot_us = core::livox::kShotPeriod_us;

  core::SimulatedLidar lidar_;
  Eigen::Isometry3d T_body_sensor_;
  core::World& world_;
  SimulatedBase& base_;
  core::TruthTally& tally_;
  std::int64_t scan_period_us_;
  const WorldClock& clock_;
};

}  // namespace clearway
