// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <optional>

#include <Eigen/Core>

#include "common/core/simulation/map_walls.hpp"
#include "common/core/simulation/ray_caster.hpp"
#include "common/core/simulation/scene.hpp"

namespace clearway::core {

/// A scene and the walls of a map, ready to be met by rays, at one moment after the other.
/// Thread safety: none.
class World {
 public:
  explicit World(const SceneConfig& scene, const std::optional<MapWalls>& walls = std::nullopt);

  [[nodiscard]] const SceneConfig& scene() const { return scene_; }

  /// Takes the world to a moment after the scene's start: any moment, in any order. It stands still
  /// within each millisecond.
  void MoveTo(std::int64_t time_us);

  /// Rays start here from now on and stay within the cone. O(solids), allocates nothing once sizes
  /// have settled.
  void Aim(const Eigen::Vector3d& origin_map, const ViewCone& cone);

  /// Nearest hit along a unit vector from where it was aimed; nothing where the ray meets nothing.
  [[nodiscard]] std::optional<RayHit> Cast(const Eigen::Vector3d& direction_map,
                                           bool glass_too = true) const;

  /// The same from anywhere, in any direction; slower.
  [[nodiscard]] std::optional<RayHit> CastFrom(const Eigen::Vector3d& origin_map,
                                               const Eigen::Vector3d& direction_map,
                                               bool glass_too = true) const;

  /// The unit normal of the surface at a point of it, towards where `direction_map` comes from.
  [[nodiscard]] Eigen::Vector3d NormalAt(const Eigen::Vector3d& point_map,
                                         const Eigen::Vector3d& direction_map,
                                         std::int32_t object) const;

 private:
  [[nodiscard]] std::optional<RayHit> Nearer(const std::optional<RayHit>& hit,
                                             const Eigen::Vector3d& origin_map,
                                             const Eigen::Vector3d& direction_map) const;

  SceneConfig scene_;
  bool changes_;
  std::optional<MapWallCaster> walls_;
  SceneGeometry geometry_;
  std::int64_t time_us_ = 0;
  Eigen::Vector3d origin_map_ = Eigen::Vector3d::Zero();
  RayCaster caster_;
};

}  // namespace clearway::core
