// SPDX-License-Identifier: BSD-3-Clause
#include "common/core/simulation/simulated_lidar.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "common/core/simulation/mid70_pattern.hpp"
#include "common/core/simulation/noise.hpp"

namespace clearway::core {
namespace {

using Eigen::Vector3d;

// Reflectivity 1 on the vendor's scale, where 0..150 are diffuse surfaces.
constexpr double kWhiteIntensity = 150.0;
constexpr double kGlintCos = 0.985;  // Glass is seen within 10 deg of head-on.
constexpr double kGlintBrightness = 0.2;
constexpr double kMirrorShare = 0.5;   // Of the light that comes back by way of a mirror...
constexpr double kSurfaceShare = 0.1;  // ...and from the mirror itself.
constexpr double kLeave_m = 1e-6;      // A mirrored ray starts this far off the surface.
constexpr double kBeamEdge_rad = 0.14 * std::numbers::pi / 180.0;
constexpr double kBeamTop_rad = 0.015 * std::numbers::pi / 180.0;
constexpr double kSecondEcho_m = 0.2;
// A hair more than the pattern's own reach and the beam's edge.
constexpr double kView_rad = kMid70MaxOffAxis_rad + 2.0 * kBeamEdge_rad;

double Uniform(std::uint64_t seed, std::uint64_t counter) {
  return static_cast<double>(SplitMix64(SplitMix64(seed) ^ counter) >> 11U) * 0x1.0p-53;
}

// Way of a ray through an upright cylinder that stands on the floor, up to max_m.
struct Way {
  double from_m = 0.0;
  double to_m = 0.0;
};
Way ThroughDust(const SceneDust& dust, const Vector3d& o, const Vector3d& d, double max_m) {
  Way way{.from_m = 0.0, .to_m = max_m};
  const double x = o.x() - dust.x_m;
  const double y = o.y() - dust.y_m;
  const double a = d.x() * d.x() + d.y() * d.y();
  const double b = x * d.x() + y * d.y();
  const double c = x * x + y * y - dust.radius_m * dust.radius_m;
  const double root2 = b * b - a * c;
  if (root2 <= 0.0 || a == 0.0) return {};
  const double root = std::sqrt(root2);
  way.from_m = std::max(way.from_m, (-b - root) / a);
  way.to_m = std::min(way.to_m, (-b + root) / a);
  if (d.z() != 0.0) {
    const double z0 = -o.z() / d.z();
    const double z1 = (dust.height_m - o.z()) / d.z();
    way.from_m = std::max(way.from_m, std::min(z0, z1));
    way.to_m = std::min(way.to_m, std::max(z0, z1));
  }
  return way.to_m > way.from_m ? way : Way{};
}

}  // namespace

SimulatedLidar::SimulatedLidar(const SimulatedLidarConfig& config, std::uint64_t seed)
    : config_(config), seed_(seed) {}

// Whether enough light comes back.
SimulatedLidar::Return SimulatedLidar::Judged(const RayHit& hit) const {
  const double brightness = hit.reflectivity * hit.incidence_cos;
  const double reach_m = config_.range_at_10_percent_m * std::sqrt(brightness / 0.1);
  if (hit.range_m < config_.min_range_m || hit.range_m > reach_m) return {};
  const bool is_near = hit.range_m < kNearEcho_m;
  return {.range_m = hit.range_m,
          .brightness = hit.reflectivity,
          .object = hit.object,
          .tag = is_near ? std::uint8_t{0} : kFirstEchoTag};
}

SimulatedLidar::Return SimulatedLidar::Trace(const World& world,
                                             const Vector3d& direction_map) const {
  std::optional<RayHit> hit = world.Cast(direction_map);
  if (!hit) return {};
  if (hit->material == Material::kGlass) {
    if (hit->incidence_cos >= kGlintCos) {
      hit->reflectivity = kGlintBrightness;
      const Return glint = Judged(*hit);
      if (glint.range_m > 0.0) return glint;
    }
    hit = world.Cast(direction_map, false);
    if (!hit) return {};
  }
  return hit->material == Material::kGlossy ? Mirrored(world, *hit, direction_map) : Judged(*hit);
}

SimulatedLidar::Return SimulatedLidar::Mirrored(const World& world,
                                                const RayHit& hit,
                                                const Vector3d& direction_map) const {
  const Vector3d point_map = origin_map_ + hit.range_m * direction_map;
  const Vector3d normal = world.NormalAt(point_map, direction_map, hit.object);
  const Vector3d mirrored = direction_map - 2.0 * normal.dot(direction_map) * normal;
  std::optional<RayHit> shown =
      world.CastFrom(point_map + kLeave_m * normal, mirrored.normalized(), false);
  if (shown) {
    shown->range_m += hit.range_m;
    shown->reflectivity *= kMirrorShare;
    Return image = Judged(*shown);
    image.tag = static_cast<std::uint8_t>(image.tag | kMirrorTag);
    if (image.range_m > 0.0) return image;
  }
  RayHit surface = hit;
  surface.reflectivity *= kSurfaceShare;
  return Judged(surface);
}

SimulatedLidar::Return SimulatedLidar::Dusted(const World& world,
                                              const Return& behind,
                                              const Vector3d& direction_map,
                                              std::int64_t shot) const {
  const double max_m = behind.range_m > 0.0 ? behind.range_m : config_.range_at_10_percent_m;
  Return nearest = behind;
  for (std::size_t i = 0; i < world.scene().dust.size(); ++i) {
    const SceneDust& dust = world.scene().dust[i];
    if (time_s_ < dust.from_s || (dust.to_s >= 0.0 && time_s_ >= dust.to_s)) continue;
    const Way way = ThroughDust(dust, origin_map_, direction_map, max_m);
    if (way.to_m <= 0.0 || dust.density_per_m <= 0.0) continue;
    // The way to the first grain is exponential.
    const double u = Uniform(seed_ + 0x9E37U * (i + 1), static_cast<std::uint64_t>(shot));
    const double range_m = way.from_m - std::log1p(-u) / dust.density_per_m;
    const bool is_first = nearest.range_m == 0.0 || range_m < nearest.range_m;
    if (range_m >= way.to_m || range_m < config_.min_range_m || !is_first) continue;
    nearest = {
        .range_m = range_m,
        .brightness = 0.03,
        .object = kDustObject,
        .tag = static_cast<std::uint8_t>(kDustTag | (range_m < kNearEcho_m ? 0 : kFirstEchoTag))};
  }
  return nearest;
}

SimulatedEcho SimulatedLidar::EchoOf(const Return& found,
                                     const Vector3d& direction_sensor,
                                     std::uint64_t noise_counter) const {
  SimulatedEcho echo;
  if (found.range_m <= 0.0) return echo;
  const double sigma_m = found.range_m < 1.0 ? config_.near_noise_sigma_m : config_.noise_sigma_m;
  const double noise_m = sigma_m > 0.0 ? sigma_m * NormalNoise(seed_, noise_counter) : 0.0;
  // A return is never at the origin, which means "no return".
  const Vector3d point_mm = 1000.0 * std::max(found.range_m + noise_m, 0.002) * direction_sensor;
  echo.point_sensor = {static_cast<std::int32_t>(std::lround(point_mm.x())),
                       static_cast<std::int32_t>(std::lround(point_mm.y())),
                       static_cast<std::int32_t>(std::lround(point_mm.z())),
                       static_cast<std::uint8_t>(std::lround(kWhiteIntensity * found.brightness)),
                       found.tag};
  echo.object = found.object;
  return echo;
}

void SimulatedLidar::Fire(World& world,
                          std::int64_t time_us,
                          const Eigen::Isometry3d& T_map_sensor,
                          std::int64_t first_shot,
                          livox::ReturnMode mode,
                          std::span<SimulatedShot> shots) const {
  world.MoveTo(time_us);
  origin_map_ = T_map_sensor.translation();
  time_s_ = static_cast<double>(time_us) * 1e-6;
  world.Aim(origin_map_, {.axis_map = T_map_sensor.linear().col(0), .half_angle_rad = kView_rad});
  const bool has_dust = !world.scene().dust.empty();
  const bool is_dual = mode == livox::ReturnMode::kDual;
  for (std::size_t i = 0; i < shots.size(); ++i) {
    const std::int64_t shot = first_shot + static_cast<std::int64_t>(i);
    const Vector3d direction_sensor = Mid70Direction(shot);
    const Vector3d direction_map = T_map_sensor.linear() * direction_sensor;
    Return found = Trace(world, direction_map);
    if (has_dust) found = Dusted(world, found, direction_map, shot);
    const auto counter = static_cast<std::uint64_t>(shot);
    shots[i].echoes = {EchoOf(found, direction_sensor, counter), {}};
    if (!is_dual || found.range_m <= 0.0) continue;
    // The beam is 0.28 deg wide and 0.03 deg high: its upper corner.
    const Vector3d edge_sensor =
        (direction_sensor +
         kBeamEdge_rad * Vector3d(-direction_sensor.y(), direction_sensor.x(), 0) +
         kBeamTop_rad * Vector3d::UnitZ())
            .normalized();
    Return second = Trace(world, T_map_sensor.linear() * edge_sensor);
    if (second.range_m <= 0.0 || std::abs(second.range_m - found.range_m) <= kSecondEcho_m)
      continue;
    if (second.range_m < found.range_m) {
      std::swap(second, found);
      shots[i].echoes[0] = EchoOf(found, direction_sensor, counter);
    }
    second.tag = static_cast<std::uint8_t>((second.tag & 0x0FU) | kSecondEchoTag);
    shots[i].echoes[1] = EchoOf(second, direction_sensor, counter | (1ULL << 62U));
  }
}

}  // namespace clearway::core
