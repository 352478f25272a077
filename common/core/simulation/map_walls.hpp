// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include <Eigen/Core>

#include "common/core/mapping/occupancy_grid.hpp"
#include "common/core/simulation/ray_caster.hpp"

namespace clearway::core {

/// What is extruded from a map.
struct MapWalls {
  static constexpr std::uint8_t kLeastWall = 65;  ///< As LocalMap takes a cell for a hit.

  OccupancyGrid grid;     ///< Cells from kLeastWall on become walls; unknown ones do not.
  double height_m = 2.5;  ///< From the floor up.
  double reflectivity = 0.6;
};

/// Exact intersections of rays with the occupied cells of a map, each an upright box.
/// A ray goes from cell to cell, and jumps as far as no occupied cell can be near.
/// Source: J. Amanatides, A. Woo, "A fast voxel traversal algorithm for ray tracing" (1987); the
/// jumps: distance of each cell to the nearest occupied one, in the maximum norm.
/// Thread safety: stateless after construction.
class MapWallCaster {
 public:
  /// O(cells). @pre the grid is valid.
  explicit MapWallCaster(const MapWalls& walls);

  /// Nearest hit along a unit vector within max_range_m. Walls that hold the origin are not seen.
  [[nodiscard]] std::optional<RayHit> Cast(const Eigen::Vector3d& origin_map,
                                           const Eigen::Vector3d& direction_map,
                                           double max_range_m) const;

 private:
  void MeasureClearance(const OccupancyGrid& grid);

  GridGeometry geometry_;
  double cosine_;  // Of the grid's yaw.
  double sine_;
  double height_m_;
  double reflectivity_;
  std::vector<std::uint8_t> clearance_;  // Cells to the nearest occupied one, at most 255.
};

}  // namespace clearway::core
