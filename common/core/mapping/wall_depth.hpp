// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "common/core/mapping/occupancy_grid.hpp"

namespace clearway::core {

/// Gives the things of a map some depth: a scan sees the face of a wall only, so that behind one
/// row of occupied cells a map that was built from scans is unknown. Unknown cells whose middle is
/// at most `depth_m` from that of an occupied one become occupied; free and occupied cells stay as
/// they are. The grid grows on all sides by as many cells, so that a wall at its edge gets depth,
/// too; where that would be more than GridGeometry::kMaxCells it stays as large as it is.
/// Without it the slightest error of a pose puts a wall's points into unknown cells, where the map
/// filter keeps them. O(cells).
/// @pre the grid is valid and depth_m is not negative.
[[nodiscard]] OccupancyGrid WithWallDepth(const OccupancyGrid& map, double depth_m);

}  // namespace clearway::core
