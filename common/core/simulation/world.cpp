// SPDX-License-Identifier: BSD-3-Clause
#include "common/core/simulation/world.hpp"

#include <limits>

namespace clearway::core {
namespace {

using Eigen::Vector3d;

constexpr std::int64_t kFreeze_us = 1000;

std::optional<MapWallCaster> MakeCaster(const std::optional<MapWalls>& walls) {
  if (!walls) return std::nullopt;
  return MapWallCaster(*walls);
}

}  // namespace

World::World(const SceneConfig& scene, const std::optional<MapWalls>& walls)
    : scene_(scene),
      changes_(ChangesWithTime(scene)),
      walls_(MakeCaster(walls)),
      geometry_(GeometryAt(scene, 0)) {}

void World::MoveTo(std::int64_t time_us) {
  const std::int64_t frozen_us = time_us / kFreeze_us * kFreeze_us;
  if (frozen_us == time_us_) return;
  time_us_ = frozen_us;
  if (changes_) geometry_ = GeometryAt(scene_, frozen_us);
}

void World::Aim(const Vector3d& origin_map, const ViewCone& cone) {
  origin_map_ = origin_map;
  caster_.Aim(geometry_, origin_map, cone);
}

std::optional<RayHit> World::Nearer(const std::optional<RayHit>& hit,
                                    const Vector3d& origin_map,
                                    const Vector3d& direction_map) const {
  if (!walls_) return hit;
  const double range_m = hit ? hit->range_m : std::numeric_limits<double>::infinity();
  const std::optional<RayHit> wall = walls_->Cast(origin_map, direction_map, range_m);
  return wall && wall->range_m < range_m ? wall : hit;
}

std::optional<RayHit> World::Cast(const Vector3d& direction_map, bool glass_too) const {
  return Nearer(caster_.Cast(direction_map, glass_too), origin_map_, direction_map);
}

std::optional<RayHit> World::CastFrom(const Vector3d& origin_map,
                                      const Vector3d& direction_map,
                                      bool glass_too) const {
  const RayCaster caster(geometry_, origin_map);
  return Nearer(caster.Cast(direction_map, glass_too), origin_map, direction_map);
}

Vector3d World::NormalAt(const Vector3d& point_map,
                         const Vector3d& direction_map,
                         std::int32_t object) const {
  Vector3d normal = Vector3d::UnitZ();
  double least_m = std::numeric_limits<double>::infinity();
  for (const Primitive& primitive : geometry_.primitives) {
    if (primitive.object != object) continue;
    const Vector3d local = primitive.T_map_local.inverse() * point_map;
    for (Eigen::Index axis = 0; axis < 3; ++axis) {
      const double off_m = std::abs(std::abs(local[axis]) - primitive.half_extents[axis]);
      if (off_m >= least_m) continue;
      least_m = off_m;
      normal = primitive.T_map_local.linear().col(axis);
    }
    if (primitive.shape == Primitive::Shape::kWedge) {
      const Vector3d slope =
          Vector3d(-primitive.half_extents.z(), 0.0, primitive.half_extents.x()).normalized();
      const double off_m = std::abs(slope.dot(local));
      if (off_m > least_m) continue;
      least_m = off_m;
      normal = primitive.T_map_local.linear() * slope;
    }
    if (primitive.shape != Primitive::Shape::kCylinder) continue;
    const double off_m = std::abs(local.head<2>().norm() - primitive.half_extents.x());
    if (off_m > least_m) continue;
    least_m = off_m;
    normal = primitive.T_map_local.linear() * Vector3d(local.x(), local.y(), 0.0).normalized();
  }
  return normal.dot(direction_map) > 0.0 ? Vector3d(-normal) : normal;
}

}  // namespace clearway::core
