// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include <Eigen/Geometry>

#include "common/core/cloud.hpp"
#include "common/core/simulation/scene.hpp"

namespace clearway::core {

/// What a simulated MID-70 can see. XML element: <lidar>.
struct SimulatedLidarConfig {
  double noise_sigma_m = 0.02;
  double near_noise_sigma_m = 0.02;
  double min_range_m = 0.05;
  double range_at_10_percent_m = 90.0;

  template <typename Self, typename Visitor>
  static void Visit(Self& self, Visitor& visitor) {
    visitor.Number(
        "noise_sigma_m",
        self.noise_sigma_m,
        0.0,
        1.0,
        "Standard deviation of the range [m]. The vendor states at most 0.02 m at 20 m.");
    visitor.Number("near_noise_sigma_m",
                   self.near_noise_sigma_m,
                   0.0,
                   1.0,
                   "The same below 1 m [m]. The vendor states at most 0.03 m from 0.2 to 1 m.");
    visitor.Number("min_range_m",
                   self.min_range_m,
                   0.0,
                   10.0,
                   "Nearer surfaces return nothing, and hide what is behind them [m].");
    visitor.Number("range_at_10_percent_m",
                   self.range_at_10_percent_m,
                   0.1,
                   1000.0,
                   "Largest range to a surface of reflectivity 0.1 that faces the sensor [m]. "
                   "Elsewhere the range goes with the root of reflectivity times the cosine of "
                   "the angle of incidence (the vendor: 90 m at 10 %, 130 at 20, 260 at 80).");
  }
};

/// Where the sensor is and what it does during a window of time.
struct ScanRequest {
  Eigen::Isometry3d T_map_vehicle = Eigen::Isometry3d::Identity();     ///< At begin_us.
  Eigen::Isometry3d T_vehicle_sensor = Eigen::Isometry3d::Identity();  ///< Sensor: x forward.
  double speed_mps = 0.0;       ///< Of the vehicle along its x axis, for the whole window.
  double yaw_rate_radps = 0.0;  ///< Of the vehicle about its z axis, for the whole window.
  std::int64_t begin_us = 0;    ///< After the scene's start; the cloud's stamp.
  std::int64_t duration_us = 100'000;
  std::uint64_t seed = 1;  ///< Of the noise. One seed a sensor.
};

/// What a sensor saw in a window.
struct SimulatedScan {
  /// One point a shot, in the order of the shots, in the sensor frame at the time of each shot;
  /// (0, 0, 0) where nothing came back. Intensity 150 is a white wall; tags are 0.
  PointCloud cloud_sensor;

  /// The object that each point lies on (DescribeObjects()), kFloorObject or kNoObject.
  std::vector<std::int32_t> objects;

  std::size_t num_returns = 0;
};

/// The shots of a MID-70 whose times (multiples of 10 us after the scene's start) lie in
/// [begin_us, begin_us + duration_us). Shot k = time / 10 us of Mid70Direction().
/// Scene and vehicle stand still within each millisecond (on the scene's clock, not the window's).
/// Noise depends on seed and shot only, so for a vehicle at rest the scans of two adjoining
/// windows are exactly the scan of both together; every call gives the same result on one machine,
/// and machines differ by rounding at most. The beam has no width: no mixed returns at edges.
/// A negative duration counts as 0. O(shots * solids).
/// @pre request.begin_us >= 0.
[[nodiscard]] SimulatedScan GenerateScan(const SceneConfig& scene,
                                         const SimulatedLidarConfig& config,
                                         const ScanRequest& request);

}  // namespace clearway::core
