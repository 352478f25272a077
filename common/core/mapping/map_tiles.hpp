// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include <Eigen/Core>

#include "common/core/mapping/occupancy_grid.hpp"

namespace clearway::core {

/// What makes one state of a map layer different from all others.
struct MapVersion {
  std::int64_t session = 0;  ///< Of the server's life.
  std::int64_t epoch = 0;    ///< Grows when the layer is loaded or replaced; above 0.
  friend bool operator==(const MapVersion&, const MapVersion&) = default;
};

/// A rectangle of a map's cells on its way. The tiles of one version cover the layer without
/// overlap and are numbered once, whatever window somebody asks for.
struct MapTile {
  MapVersion version;
  GridGeometry geometry;  ///< Of the whole layer.
  int index = 0;          ///< 0 .. count - 1.
  int count = 0;          ///< Tiles of the whole layer.
  CellRectangle rectangle;
  std::vector<std::uint8_t> cells;  ///< Of the rectangle, row by row.
  std::uint32_t map_checksum = 0;   ///< Checksum() of all cells of the layer.
};

/// Cuts a layer so that EncodeRuns() of each tile takes at most `max_encoded_bytes`: bands of whole
/// rows, as many as fit; a row that does not fit by itself is cut into pieces. In order of rows,
/// then columns; deterministic. O(cells).
/// @pre max_encoded_bytes >= 2 and the grid is valid.
[[nodiscard]] std::vector<CellRectangle> CutTiles(const OccupancyGrid& grid,
                                                  std::size_t max_encoded_bytes);

/// Puts the tiles of a map together, in any order, with repetitions. Starts anew when another
/// version comes. Old versions are refused, so that late tiles do not bring them back: those of a
/// known session with an epoch below one that was seen, and the last 16 that gave way. Sessions
/// have no order: whichever comes last is taken for the new one.
/// Memory: nine bits a cell of the layer and one bit a tile. Add() is O(cells of the tile), the
/// first and the last of a version O(cells of the layer). Thread safety: none.
class MapAssembler {
 public:
  enum class Outcome : std::int8_t {
    kAccepted,
    kNewVersion,    ///< Accepted, as the first of another version.
    kDuplicate,     ///< Already there; ignored.
    kOldVersion,    ///< Of a version that gave way to another, or older than one; ignored.
    kInconsistent,  ///< Contradicts what this version said before, or overlaps a tile that is
                    ///< there (then IsCorrupt()); ignored.
    kInvalid,  ///< Breaks a rule of the type: sizes, indices, rectangle off the layer; ignored.
  };

  Outcome Add(const MapTile& tile);

  /// The version being put together; nothing before the first tile.
  [[nodiscard]] std::optional<MapVersion> version() const;

  /// True when all tiles are there and the cells have the checksum that they were announced with.
  [[nodiscard]] bool IsComplete() const;

  /// True when the tiles cannot become the layer, since they were mixed or damaged: two of them
  /// overlapped, or all have come and they leave cells out or do not have the announced checksum.
  /// Clear() and ask again.
  [[nodiscard]] bool IsCorrupt() const;

  /// True when all cells of a window of `map` are there (complete or not); also when the window
  /// lies off the layer. False before the first tile and for corners that are not finite.
  /// O(cells of the window), O(1) when complete.
  [[nodiscard]] bool Covers(const Eigen::Vector2d& min_map, const Eigen::Vector2d& max_map) const;

  /// Indices of the tiles that have not come, ascending; at most `limit`. Empty before the first.
  [[nodiscard]] std::vector<int> Missing(std::size_t limit) const;

  [[nodiscard]] int received() const { return num_received_; }
  [[nodiscard]] int count() const { return static_cast<int>(received_.size()); }

  /// The layer; cells that have not come are unknown.
  [[nodiscard]] const OccupancyGrid& grid() const { return grid_; }

  /// Forgets the assembly: its version may come again (asked for once more after damage). Older
  /// versions and those that gave way stay refused; a new MapAssembler forgets those too.
  void Clear();

 private:
  [[nodiscard]] const std::optional<MapVersion>& last_version() const {
    return version_ ? version_ : cleared_;
  }
  [[nodiscard]] bool GaveWay(const MapVersion& version) const;
  [[nodiscard]] bool Contradicts(const MapTile& tile) const;
  [[nodiscard]] bool HasAny(const CellRectangle& rectangle) const;
  [[nodiscard]] bool HasAll(const CellRectangle& rectangle) const;
  [[nodiscard]] std::int64_t CountReceived(const CellRectangle& rectangle) const;
  void Begin(const MapTile& tile);
  void Take(const MapTile& tile);

  std::optional<MapVersion> version_;
  std::optional<MapVersion> cleared_;  // The last one that Clear() forgot.
  std::vector<MapVersion> former_;     // The last few.
  OccupancyGrid grid_;
  std::vector<bool> is_cell_received_;
  std::vector<bool> received_;  // Tiles by index.
  int num_received_ = 0;
  std::int64_t num_cells_received_ = 0;
  std::uint32_t map_checksum_ = 0;
  bool has_overlap_ = false;
  bool is_complete_ = false;
};

}  // namespace clearway::core
