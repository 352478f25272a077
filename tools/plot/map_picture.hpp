// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

#include "common/core/mapping/occupancy_grid.hpp"

namespace clearway::plot {

/// The cells of a grid by kind.
struct CellCounts {
  std::size_t free = 0;
  std::size_t occupied = 0;
  std::size_t between = 0;  ///< Neither free nor occupied, but known: 1..99.
  std::size_t unknown = 0;
};

[[nodiscard]] CellCounts CountCells(const core::OccupancyGrid& grid);

/// What stands beside a map's picture.
struct MapPictureText {
  std::string title;
  std::vector<std::string> lines;  ///< About 40 characters each; what does not fit is cut.
};

/// Writes a picture of a grid as a PNG: in the frame `map`, x to the right and y up, so that a grid
/// with a yaw lies turned in it. Ticks and a scale bar in m; the grid's origin with its axes, and
/// the frame's where it is in view; a legend with the size, the resolution and the counts. Free is
/// white, occupied black, unknown bluish grey, and what is between the darker the more occupied.
/// Where several cells share a pixel the most occupied one shows, so that no occupied cell is lost.
/// Same grid, same bytes. O(cells). @pre the geometry is valid and the cells fit it.
/// Throws std::runtime_error when the file cannot be written (what was there may then be gone), and
/// when the resolution is below 0.1 mm or the map beyond 100,000 km.
void WriteMapPng(const core::OccupancyGrid& grid,
                 const MapPictureText& text,
                 const std::filesystem::path& path);

}  // namespace clearway::plot
