// SPDX-License-Identifier: BSD-3-Clause
#include "common/core/mapping/wall_depth.hpp"

#include <algorithm>
#include <cmath>

#include "common/core/mapping/distance_field.hpp"

namespace clearway::core {
namespace {

// Of the depth, so that 0.15 m is three cells of 0.05 m.
constexpr double kRounding = 1e-9;

// The map with `border` more columns and rows of unknown cells on each side.
OccupancyGrid Padded(const OccupancyGrid& map, int border) {
  OccupancyGrid padded{map.geometry, {}};
  padded.geometry.width += 2 * border;
  padded.geometry.height += 2 * border;
  const Eigen::Vector2d shift =
      map.geometry.CenterOf({-border, -border}) - map.geometry.CenterOf({0, 0});
  padded.geometry.origin_x_m += shift.x();
  padded.geometry.origin_y_m += shift.y();
  if (!padded.geometry.IsValid()) return map;
  padded.cells.assign(padded.geometry.num_cells(), OccupancyGrid::kUnknown);
  for (int row = 0; row < map.geometry.height; ++row) {
    const auto from =
        map.cells.begin() + static_cast<std::ptrdiff_t>(map.geometry.IndexOf({0, row}));
    const auto to = padded.cells.begin() +
                    static_cast<std::ptrdiff_t>(padded.geometry.IndexOf({border, row + border}));
    std::copy(from, from + map.geometry.width, to);
  }
  return padded;
}

}  // namespace

OccupancyGrid WithWallDepth(const OccupancyGrid& map, double depth_m) {
  const double depth_cells =
      std::min(255.0, depth_m / map.geometry.resolution_m * (1.0 + kRounding));
  OccupancyGrid deep = Padded(map, static_cast<int>(std::floor(depth_cells)));
  const DistanceField distance(deep);
  const double most = std::min(depth_cells * depth_cells, DistanceField::kFar - 1.0);
  for (int row = 0; row < deep.geometry.height; ++row) {
    for (int column = 0; column < deep.geometry.width; ++column) {
      std::uint8_t& cell = deep.cells[deep.geometry.IndexOf({column, row})];
      if (cell == OccupancyGrid::kUnknown && distance.SquaredCells({column, row}) <= most) {
        cell = OccupancyGrid::kOccupied;
      }
    }
  }
  return deep;
}

}  // namespace clearway::core
