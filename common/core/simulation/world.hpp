// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <optional>

#include <Eigen/Core>

#include "common/core/mapping/occupancy_grid.hpp"
#include "common/core/simulation/ray_caster.hpp"
#include "common/core/simulation/scene.hpp"

namespace clearway::core {

/// Object index of a return from the walls of a map.
inline constexpr std::int32_t kMapObject = -3;

/// What is extruded from a map.
struct MapWalls {
  OccupancyGrid grid;     ///< Its occupied cells become walls.
  double height_m = 2.5;  ///< From the floor up.
  double reflectivity = 0.6;
};

/// A scene and the walls of a map, ready to be met by rays, at one moment after the other.
/// Thread safety: none.
class World {
 public:
  explicit World(const SceneConfig& scene, std::optional<MapWalls> walls = std::nullopt);

  [[nodiscard]] const SceneConfig& scene() const { return scene_; }

  /// Takes the world to a moment after the scene's start. Any moment, in any order.
  void MoveTo(std::int64_t time_us) { geometry_ = GeometryAt(scene_, time_us); }

  /// Nearest hit of a ray along a unit vector; nothing where the ray meets nothing.
  [[nodiscard]] std::optional<RayHit> Cast(const Eigen::Vector3d& origin_map,
                                           const Eigen::Vector3d& direction_map) const {
    return RayCaster(geometry_, origin_map).Cast(direction_map);
  }

 private:
  SceneConfig scene_;
  SceneGeometry geometry_;
};

}  // namespace clearway::core
