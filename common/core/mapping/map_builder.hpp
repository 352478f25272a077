// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <unordered_map>
#include <unordered_set>
#include <vector>

#include "common/core/mapping/occupancy_grid.hpp"

namespace clearway::core {

/// When a cell of a built map counts as what.
struct MapBuilderConfig {
  double min_share = 0.6;  ///< Occupied: hit in at least this share of the scans that saw it.
  int min_scans = 2;       ///< Seen by fewer scans: unknown.
};

/// A map from many local maps: a cell is occupied when it was hit in at least a stated share of the
/// scans that saw it, so that people who walk leave no trace; free when it was seen often enough
/// and is not occupied; unknown otherwise.
/// Memory: 8 bytes a cell of blocks that were touched. Thread safety: none.
class MapBuilder {
 public:
  enum class Outcome : std::int8_t {
    kAdded,
    kOtherGrid,  ///< Resolution or alignment differ from the first local map's; ignored.
    kTooLarge,   ///< The map would grow beyond GridGeometry::kMaxCells, its blocks beyond twice
                 ///< that, or its cells lie 10^9 cells or more from map's origin; ignored.
    kInvalid,    ///< Not a valid grid, or turned; ignored.
  };

  /// Adds what one scan saw: any grid aligned as LocalMap's, unknown = not seen, 65 and above =
  /// hit. One of 0 x 0 adds nothing. Either all of it is added or none. O(cells).
  Outcome Add(const OccupancyGrid& local);

  /// The map so far, cut to the cells that were seen. @pre at least one local map with a seen cell
  /// was added (has_cells()).
  [[nodiscard]] OccupancyGrid Build(const MapBuilderConfig& config) const;

  [[nodiscard]] bool has_cells() const { return !blocks_.empty(); }

 private:
  static constexpr int kBlock = 64;                  // Cells along a side of a block.
  static constexpr std::uint8_t kOccupiedFrom = 65;  // As in DistanceField.
  struct Evidence {
    std::uint32_t seen = 0;
    std::uint32_t hit = 0;
  };
  struct Block {
    std::vector<Evidence> cells = std::vector<Evidence>(std::size_t{kBlock} * kBlock);
  };

  // The cells that were seen, counted from map's origin; nothing while right < left.
  struct Bounds {
    int left = std::numeric_limits<int>::max();
    int bottom = std::numeric_limits<int>::max();
    int right = std::numeric_limits<int>::min();
    int top = std::numeric_limits<int>::min();
    void Extend(int column, int row);
    [[nodiscard]] std::int64_t num_cells() const;
  };

  [[nodiscard]] bool HasResolution(double resolution_m) const;
  Outcome AddCells(const OccupancyGrid& local, const CellIndex& first);

  double resolution_m_ = 0.0;
  Bounds bounds_;
  // By block column and row, packed into one key.
  std::unordered_map<std::uint64_t, Block> blocks_;
};

}  // namespace clearway::core
