// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <span>
#include <vector>

#include <Eigen/Geometry>

#include "common/core/simulation/simulated_lidar.hpp"

namespace clearway::core {

/// How the rays of a scan are counted.
struct TallyConfig {
  std::int64_t period_us = 100'000;
  /// When some scan begins, in the world's time [us]; may lie before it.
  std::int64_t first_begin_us = 0;
  /// Rays count that end further from the floor's level than this, above or below it [m].
  double floor_tolerance_m = 0.05;
};

/// The rays on one object.
struct RayTally {
  std::int32_t points = 0;         ///< In the scan, of all sensors.
  std::int64_t first_ray_us = -1;  ///< The first one ever, in the world's time; -1: none yet.
};

/// Counts, for each object of a scene, the rays that showed it in each scan: what a detector could
/// have known. Points are taken where they are without noise only as far as the echo tells, that is
/// with it; what a mirror shows is no ray on the object. O(echoes) a packet. Thread safety: none.
class TruthTally {
 public:
  TruthTally(std::size_t num_objects, const TallyConfig& config);

  /// Takes the shots of a packet that were fired from T_map_sensor at `time_us`.
  void Add(const Eigen::Isometry3d& T_map_sensor,
           std::int64_t time_us,
           std::span<const SimulatedShot> shots);

  /// What the scan that begins at `begin_us` came to, by object; it and older ones are forgotten.
  [[nodiscard]] std::vector<RayTally> TakeScan(std::int64_t begin_us);

 private:
  [[nodiscard]] std::int64_t ScanOf(std::int64_t time_us) const;

  TallyConfig config_;
  std::vector<std::int64_t> first_ray_us_;
  std::map<std::int64_t, std::vector<std::int32_t>> points_;  // By scan, by object.
};

}  // namespace clearway::core
