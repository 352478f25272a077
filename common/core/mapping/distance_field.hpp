// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <vector>

#include "common/core/mapping/occupancy_grid.hpp"

namespace clearway::core {

/// For each cell of a grid, how far the nearest occupied cell is: the Euclidean distance between
/// the middles of the two cells, exactly, as a squared number of cells. Two bytes a cell.
/// O(cells) time. Source: Meijster, Roerdink and Hesselink 2000, "A general algorithm for computing
/// distance transforms in linear time".
class DistanceField {
 public:
  /// Squared distances of this and above are all stored as this: at least 255 cells.
  static constexpr std::uint16_t kFar = 65'535;

  /// A cell is occupied when its value is at least `occupied_from` and not unknown.
  /// @pre the grid has num_cells() cells.
  explicit DistanceField(const OccupancyGrid& grid, std::uint8_t occupied_from = 65);

  /// Squared distance in cells; 0 in an occupied cell. @pre the cell is on the grid.
  [[nodiscard]] std::uint16_t SquaredCells(const CellIndex& cell) const {
    return squared_cells_[geometry_.IndexOf(cell)];
  }

 private:
  GridGeometry geometry_;
  std::vector<std::uint16_t> squared_cells_;
};

}  // namespace clearway::core
