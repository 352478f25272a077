// SPDX-License-Identifier: BSD-3-Clause
#include "common/core/simulation/lidar_scan.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include "common/core/simulation/mid70_pattern.hpp"
#include "common/core/simulation/noise.hpp"
#include "common/core/simulation/ray_caster.hpp"
#include "common/core/simulation/scene_geometry.hpp"

namespace clearway::core {

namespace {

// Scene and vehicle are looked at once in this time.
constexpr std::int64_t kFreeze_us = 1000;

// Reflectivity 1 on the vendor's scale, where 0..150 are diffuse surfaces.
constexpr double kWhiteIntensity = 150.0;

// The vehicle's motion since T_map_vehicle, at constant speed and yaw rate: an arc.
Eigen::Isometry3d AlongArc(const ScanRequest& request, double elapsed_s) {
  const double turn_rad = request.yaw_rate_radps * elapsed_s;
  const double way_m = request.speed_mps * elapsed_s;
  const double half = 0.5 * turn_rad;
  // The chord of the arc: its length and direction.
  const double chord_m = std::abs(half) < 1e-9 ? way_m : way_m * std::sin(half) / half;
  Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
  T.translation() = Eigen::Vector3d(chord_m * std::cos(half), chord_m * std::sin(half), 0.0);
  T.linear() = Eigen::AngleAxisd(turn_rad, Eigen::Vector3d::UnitZ()).toRotationMatrix();
  return T;
}

bool IsSeen(const RayHit& hit, const SimulatedLidarConfig& config) {
  const double brightness = hit.reflectivity * hit.incidence_cos;
  const double max_range_m = config.range_at_10_percent_m * std::sqrt(brightness / 0.1);
  return hit.range_m >= config.min_range_m && hit.range_m <= max_range_m;
}

// Appends one point a shot to a scan.
class ScanWriter {
 public:
  ScanWriter(const SimulatedLidarConfig& config, const ScanRequest& request)
      : config_(config), request_(request) {}

  void Reserve(std::size_t num_shots) {
    scan_.cloud_sensor.Reserve(num_shots);
    scan_.objects.reserve(num_shots);
  }

  void Add(std::int64_t shot, const Eigen::Vector3d& direction, const std::optional<RayHit>& hit) {
    const auto offset_us =
        static_cast<std::int32_t>(shot * kMid70ShotPeriod_us - request_.begin_us);
    if (!hit || !IsSeen(*hit, config_)) {
      scan_.cloud_sensor.Add(Eigen::Vector3f::Zero(), 0, 0, offset_us);
      scan_.objects.push_back(kNoObject);
      return;
    }
    const double noise_m =
        config_.noise_sigma_m * NormalNoise(request_.seed, static_cast<std::uint64_t>(shot));
    // A return is never at the origin, which means "no return".
    const double range_m = std::max(hit->range_m + noise_m, 0.001);
    const auto intensity =
        static_cast<std::uint8_t>(std::lround(kWhiteIntensity * hit->reflectivity));
    scan_.cloud_sensor.Add((direction * range_m).cast<float>(), intensity, 0, offset_us);
    scan_.objects.push_back(hit->object);
    ++scan_.num_returns;
  }

  SimulatedScan Take() { return std::move(scan_); }

 private:
  SimulatedLidarConfig config_;
  ScanRequest request_;
  SimulatedScan scan_;
};

// Number of the first shot at or after a time.
std::int64_t ShotFrom(std::int64_t time_us) {
  return (time_us + kMid70ShotPeriod_us - 1) / kMid70ShotPeriod_us;
}

}  // namespace

SimulatedScan GenerateScan(const SceneConfig& scene,
                           const SimulatedLidarConfig& config,
                           const ScanRequest& request) {
  ScanWriter writer(config, request);
  const std::int64_t end_us = request.begin_us + std::max<std::int64_t>(request.duration_us, 0);
  writer.Reserve(static_cast<std::size_t>(ShotFrom(end_us) - ShotFrom(request.begin_us)));

  std::int64_t from_us = request.begin_us;
  while (from_us < end_us) {
    const std::int64_t frozen_us = from_us / kFreeze_us * kFreeze_us;
    const std::int64_t to_us = std::min(end_us, frozen_us + kFreeze_us);
    const double elapsed_s = static_cast<double>(from_us - request.begin_us) * 1e-6;
    const Eigen::Isometry3d T_map_sensor =
        request.T_map_vehicle * AlongArc(request, elapsed_s) * request.T_vehicle_sensor;
    const RayCaster caster(GeometryAt(scene, frozen_us), T_map_sensor.translation());
    for (std::int64_t shot = ShotFrom(from_us); shot < ShotFrom(to_us); ++shot) {
      const Eigen::Vector3d direction = Mid70Direction(shot);
      writer.Add(shot, direction, caster.Cast(T_map_sensor.linear() * direction));
    }
    from_us = to_us;
  }
  return writer.Take();
}

}  // namespace clearway::core
