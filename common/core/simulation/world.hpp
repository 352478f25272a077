// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <optional>

#include <Eigen/Core>

#include "common/core/mapping/occupancy_grid.hpp"
#include "common/core/simulation/ray_caster.hpp"
#include "common/core/simulation/scene.hpp"

namespace clearway::core {

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

 private:
  SceneConfig scene_;
};

}  // namespace clearway::core
