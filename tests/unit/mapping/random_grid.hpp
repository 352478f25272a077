// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <random>

#include "common/core/mapping/occupancy_grid.hpp"

namespace clearway::core {

/// A grid of one value.
inline OccupancyGrid MakeGrid(int width, int height, std::uint8_t value = OccupancyGrid::kFree) {
  OccupancyGrid grid;
  grid.geometry.width = width;
  grid.geometry.height = height;
  grid.cells.assign(grid.geometry.num_cells(), value);
  return grid;
}

inline void SetCell(OccupancyGrid& grid, const CellIndex& cell, std::uint8_t value) {
  grid.cells[grid.geometry.IndexOf(cell)] = value;
}

/// A free grid in which about the given shares of the cells are occupied and unknown.
inline OccupancyGrid MakeRandomGrid(int width,
                                    int height,
                                    double occupied,
                                    double unknown,
                                    std::mt19937& random) {
  OccupancyGrid grid = MakeGrid(width, height);
  std::uniform_real_distribution<double> share(0.0, 1.0);
  for (std::uint8_t& cell : grid.cells) {
    const double s = share(random);
    if (s < occupied) {
      cell = OccupancyGrid::kOccupied;
    } else if (s < occupied + unknown) {
      cell = OccupancyGrid::kUnknown;
    }
  }
  return grid;
}

}  // namespace clearway::core
