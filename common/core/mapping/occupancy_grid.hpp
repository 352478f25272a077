// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include <Eigen/Core>

namespace clearway::core {

/// A column and a row of a grid, counted from the lower left.
struct CellIndex {
  int column = 0;
  int row = 0;
  friend bool operator==(const CellIndex&, const CellIndex&) = default;
};

/// Where the cells of a grid lie. Cell (0, 0) is the lower left one; columns run along the grid's
/// x axis, rows along its y axis. The grid is turned by the yaw about the lower left corner of cell
/// (0, 0), which lies at the origin. As in Nav2's maps, where an image's last line is row 0.
struct GridGeometry {
  /// Grids with more cells are refused wherever they come from outside (10,000 x 10,000).
  static constexpr std::int64_t kMaxCells = 100'000'000;

  int width = 0;                ///< Columns.
  int height = 0;               ///< Rows.
  double resolution_m = 0.05;   ///< Side of a cell [m].
  double origin_x_m = 0.0;      ///< Lower left corner of cell (0, 0), in map [m].
  double origin_y_m = 0.0;      ///< Likewise [m].
  double origin_yaw_rad = 0.0;  ///< From map's x axis to the direction of the columns' numbering.

  friend bool operator==(const GridGeometry&, const GridGeometry&) = default;

  [[nodiscard]] std::size_t num_cells() const {
    return static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
  }

  /// Positive sizes, at most kMaxCells, a positive finite resolution and a finite origin.
  [[nodiscard]] bool IsValid() const;

  /// Position of a cell in OccupancyGrid::cells. @pre Contains(cell).
  [[nodiscard]] std::size_t IndexOf(const CellIndex& cell) const {
    return static_cast<std::size_t>(cell.row) * static_cast<std::size_t>(width) +
           static_cast<std::size_t>(cell.column);
  }
  [[nodiscard]] bool Contains(const CellIndex& cell) const {
    return cell.column >= 0 && cell.column < width && cell.row >= 0 && cell.row < height;
  }

  /// The cell that a point of `map` lies in; nothing off the grid or for NaN. O(1).
  [[nodiscard]] std::optional<CellIndex> CellAt(const Eigen::Vector2d& point_map) const;

  /// The middle of a cell in `map`, also of one beyond the grid.
  [[nodiscard]] Eigen::Vector2d CenterOf(const CellIndex& cell) const;
};

/// An occupancy grid as Nav2 means it: 0 free .. 100 occupied, or unknown.
struct OccupancyGrid {
  static constexpr std::uint8_t kFree = 0;
  static constexpr std::uint8_t kOccupied = 100;
  static constexpr std::uint8_t kUnknown = 255;

  GridGeometry geometry;
  std::vector<std::uint8_t> cells;  ///< Row by row from the lowest; num_cells() of them.

  [[nodiscard]] std::uint8_t At(const CellIndex& cell) const {
    return cells[geometry.IndexOf(cell)];
  }
  friend bool operator==(const OccupancyGrid&, const OccupancyGrid&) = default;
};

/// A rectangle of cells of a grid.
struct CellRectangle {
  int column = 0;  ///< First column.
  int row = 0;     ///< First row, counted upwards.
  int width = 0;   ///< Columns.
  int height = 0;  ///< Rows.

  [[nodiscard]] std::int64_t num_cells() const { return std::int64_t{1} * width * height; }
  friend bool operator==(const CellRectangle&, const CellRectangle&) = default;
};

/// What two rectangles have in common; 0 x 0 when nothing.
[[nodiscard]] CellRectangle Intersection(const CellRectangle& a, const CellRectangle& b);

/// The least rectangle of cells that holds the part of an axis-parallel window of `map` that lies
/// on the grid (a turned grid: of the window's bounding box in the grid's axes); 0 x 0 when nothing
/// of it does. Any two opposite corners will do; corners that are not finite give 0 x 0.
[[nodiscard]] CellRectangle CellsInWindow(const GridGeometry& geometry,
                                          const Eigen::Vector2d& min_map,
                                          const Eigen::Vector2d& max_map);

/// The cells of a rectangle, row by row. @pre the rectangle lies on the grid.
[[nodiscard]] std::vector<std::uint8_t> CellsOf(const OccupancyGrid& grid,
                                                const CellRectangle& rectangle);

}  // namespace clearway::core
