// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "common/core/mapping/occupancy_grid.hpp"
#include "common/core/simulation/scene.hpp"

namespace clearway::core {

/// How wrong a map of a scene is. XML element: <simulator><map_error>.
struct MapErrorConfig {
  double shift_x_m = 0.0;
  double shift_y_m = 0.0;
  double turn_rad = 0.0;

  template <typename Self, typename Visitor>
  static void Visit(Self& self, Visitor& visitor) {
    visitor.Number(
        "shift_x_m", self.shift_x_m, -100.0, 100.0, "All of the map lies so far off [m].");
    visitor.Number("shift_y_m", self.shift_y_m, -100.0, 100.0, "Likewise [m].");
    visitor.Degrees("turn_deg",
                    self.turn_rad,
                    -180.0,
                    180.0,
                    "It is turned by so much about the map's origin, before it is shifted [deg].");
  }
};

/// What of a scene a map shows.
struct RenderMapConfig {
  double resolution_m = 0.05;
  double min_height_m = 0.1;  ///< What is lower, ...
  double max_height_m = 0.6;  ///< ...or begins higher, is not on the map.
  MapErrorConfig error;
};

/// The map that a robot would have of a scene: all objects with on_map, where they stand at the
/// start, whether they are there or not (a stale map shows what has vanished), and nothing else. A
/// cell is occupied where a solid covers a part of it, free where the start can be reached from it,
/// unknown elsewhere; holes are not seen by who makes maps. Empty (0 x 0) when no object is on the
/// map. Throws std::invalid_argument when it would have more than GridGeometry::kMaxCells cells.
/// O(cells * solids).
/// @pre config is sensible: positive resolution, min_height_m < max_height_m.
[[nodiscard]] OccupancyGrid RenderMap(const SceneConfig& scene, const RenderMapConfig& config);

}  // namespace clearway::core
