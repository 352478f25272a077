// SPDX-License-Identifier: BSD-3-Clause
#include "common/core/simulation/simulated_lidar.hpp"

#include <algorithm>
#include <cmath>

#include "common/core/simulation/mid70_pattern.hpp"
#include "common/core/simulation/noise.hpp"

namespace clearway::core {

SimulatedLidar::SimulatedLidar(const SimulatedLidarConfig& config, std::uint64_t seed)
    : config_(config), seed_(seed) {}

void SimulatedLidar::Fire(World& world,
                          std::int64_t time_us,
                          const Eigen::Isometry3d& T_map_sensor,
                          std::int64_t first_shot,
                          std::span<SimulatedShot> shots,
                          livox::ReturnMode /*mode*/) {
  world.MoveTo(time_us);
  for (std::size_t i = 0; i < shots.size(); ++i) {
    shots[i] = {};
    const std::int64_t shot = first_shot + static_cast<std::int64_t>(i);
    const Eigen::Vector3d direction = Mid70Direction(shot);
    const auto hit = world.Cast(T_map_sensor.translation(), T_map_sensor.linear() * direction);
    if (!hit || hit->range_m < config_.min_range_m) continue;
    const double noise_m =
        config_.noise_sigma_m * NormalNoise(seed_, static_cast<std::uint64_t>(shot));
    const Eigen::Vector3d point_mm = 1000.0 * std::max(hit->range_m + noise_m, 0.001) * direction;
    SimulatedEcho& echo = shots[i].echoes[0];
    echo.point_sensor = {static_cast<std::int32_t>(std::lround(point_mm.x())),
                         static_cast<std::int32_t>(std::lround(point_mm.y())),
                         static_cast<std::int32_t>(std::lround(point_mm.z())),
                         static_cast<std::uint8_t>(std::lround(150.0 * hit->reflectivity)),
                         0x10};
    echo.object = hit->object;
  }
}

}  // namespace clearway::core
