// SPDX-License-Identifier: BSD-3-Clause
#include "common/core/simulation/truth_tally.hpp"

#include <cmath>

namespace clearway::core {
namespace {

// Scans that nobody asks for are forgotten beyond this many.
constexpr std::size_t kMaxScans = 100;

}  // namespace

TruthTally::TruthTally(std::size_t num_objects, const TallyConfig& config)
    : config_(config), first_ray_us_(num_objects, -1) {}

std::int64_t TruthTally::ScanOf(std::int64_t time_us) const {
  const std::int64_t since_us = time_us - config_.first_begin_us;
  return since_us / config_.period_us - (since_us % config_.period_us < 0 ? 1 : 0);
}

void TruthTally::Add(const Eigen::Isometry3d& T_map_sensor,
                     std::int64_t time_us,
                     std::span<const SimulatedShot> shots) {
  std::vector<std::int32_t>& points = points_[ScanOf(time_us)];
  if (points.empty()) points.resize(first_ray_us_.size());
  if (points_.size() > kMaxScans) points_.erase(points_.begin());
  const Eigen::Vector3d up_sensor = 0.001 * T_map_sensor.linear().row(2).transpose();
  const double height_m = T_map_sensor.translation().z();
  for (const SimulatedShot& shot : shots) {
    std::int32_t counted = kNoObject;  // Two echoes of one ray are one ray.
    for (const SimulatedEcho& echo : shot.echoes) {
      const bool is_image = (echo.point_sensor.tag & kMirrorTag) != 0;
      if (echo.object < 0 || echo.object == counted || is_image) continue;
      const livox::WirePoint& point = echo.point_sensor;
      const double z_m =
          height_m + up_sensor.dot(Eigen::Vector3d(point.x_mm, point.y_mm, point.z_mm));
      if (std::abs(z_m) <= config_.floor_tolerance_m) continue;
      counted = echo.object;
      const auto object = static_cast<std::size_t>(echo.object);
      ++points[object];
      if (first_ray_us_[object] < 0) first_ray_us_[object] = time_us;
    }
  }
}

std::vector<RayTally> TruthTally::TakeScan(std::int64_t begin_us) {
  const std::int64_t scan = ScanOf(begin_us);
  std::vector<RayTally> tallies(first_ray_us_.size());
  const auto found = points_.find(scan);
  for (std::size_t i = 0; i < tallies.size(); ++i) {
    if (found != points_.end()) tallies[i].points = found->second[i];
    tallies[i].first_ray_us = first_ray_us_[i];
  }
  points_.erase(points_.begin(), points_.upper_bound(scan));
  return tallies;
}

}  // namespace clearway::core
