// SPDX-License-Identifier: BSD-3-Clause
#include "common/core/mapping/map_tiles.hpp"

#include <algorithm>
#include <cassert>
#include <span>
#include <utility>

#include "common/core/mapping/run_length.hpp"

namespace clearway::core {
namespace {

constexpr std::size_t kMaxFormer = 16;

// The size of EncodeRuns() of cells that come one after the other.
class RunCounter {
 public:
  void Add(std::uint8_t value) {
    if (length_ > 0 && value == value_ && length_ < 255) {
      ++length_;
      return;
    }
    bytes_ += 2;
    length_ = 1;
    value_ = value;
  }

  // Adds cells until the size would exceed `max_bytes`; how many were added.
  std::size_t AddWhileFits(std::span<const std::uint8_t> cells, std::size_t max_bytes) {
    for (std::size_t i = 0; i < cells.size(); ++i) {
      RunCounter after = *this;
      after.Add(cells[i]);
      if (after.bytes_ > max_bytes) return i;
      *this = after;
    }
    return cells.size();
  }

 private:
  std::size_t bytes_ = 0;
  int length_ = 0;
  std::uint8_t value_ = 0;
};

// Takes the rows of a grid one after the other.
class TileCutter {
 public:
  TileCutter(int width, std::size_t max_bytes) : width_(width), max_bytes_(max_bytes) {}

  void AddRow(int row, std::span<const std::uint8_t> cells) {
    RunCounter after = counter_;
    if (after.AddWhileFits(cells, max_bytes_) == cells.size()) {
      counter_ = after;
      return;
    }
    FinishBand(row);
    first_row_ = row;
    if (counter_.AddWhileFits(cells, max_bytes_) == cells.size()) return;
    AddPieces(row, cells);
    first_row_ = row + 1;
    counter_ = {};
  }

  std::vector<CellRectangle> Finish(int height) {
    FinishBand(height);
    return std::move(tiles_);
  }

 private:
  void FinishBand(int end_row) {
    if (end_row > first_row_) tiles_.push_back({0, first_row_, width_, end_row - first_row_});
    counter_ = {};
  }

  void AddPieces(int row, std::span<const std::uint8_t> cells) {
    int column = 0;
    while (column < width_) {
      const std::size_t fits =
          RunCounter().AddWhileFits(cells.subspan(static_cast<std::size_t>(column)), max_bytes_);
      tiles_.push_back({column, row, static_cast<int>(fits), 1});
      column += static_cast<int>(fits);
    }
  }

  int width_;
  std::size_t max_bytes_;
  int first_row_ = 0;   // Of the band that is open.
  RunCounter counter_;  // Of the band that is open.
  std::vector<CellRectangle> tiles_;
};

bool LiesOn(const CellRectangle& rectangle, const GridGeometry& geometry) {
  return rectangle.width > 0 && rectangle.height > 0 && rectangle.column >= 0 &&
         rectangle.row >= 0 && rectangle.width <= geometry.width &&
         rectangle.height <= geometry.height &&
         rectangle.column <= geometry.width - rectangle.width &&
         rectangle.row <= geometry.height - rectangle.height;
}

bool KeepsTheRules(const MapTile& tile) {
  return tile.version.epoch > 0 && tile.geometry.IsValid() && tile.count > 0 &&
         tile.count <= static_cast<std::int64_t>(tile.geometry.num_cells()) && tile.index >= 0 &&
         tile.index < tile.count && LiesOn(tile.rectangle, tile.geometry) &&
         tile.cells.size() == static_cast<std::size_t>(tile.rectangle.num_cells());
}

bool IsOlder(const MapVersion& version, const MapVersion& than) {
  return version.session == than.session && version.epoch < than.epoch;
}

}  // namespace

std::vector<CellRectangle> CutTiles(const OccupancyGrid& grid, std::size_t max_encoded_bytes) {
  assert(max_encoded_bytes >= 2);
  const auto width = static_cast<std::size_t>(grid.geometry.width);
  // A piece of at least one cell, whatever is asked for.
  TileCutter cutter(grid.geometry.width, std::max<std::size_t>(max_encoded_bytes, 2));
  const std::span<const std::uint8_t> cells(grid.cells);
  for (int row = 0; row < grid.geometry.height; ++row) {
    cutter.AddRow(row, cells.subspan(grid.geometry.IndexOf({0, row}), width));
  }
  return cutter.Finish(grid.geometry.height);
}

MapAssembler::Outcome MapAssembler::Add(const MapTile& tile) {
  if (!KeepsTheRules(tile)) return Outcome::kInvalid;
  if (GaveWay(tile.version)) return Outcome::kOldVersion;
  const bool is_new = version_ != tile.version;
  if (is_new) {
    Begin(tile);
  } else {
    if (Contradicts(tile)) return Outcome::kInconsistent;
    if (received_[static_cast<std::size_t>(tile.index)]) return Outcome::kDuplicate;
    if (HasAny(tile.rectangle)) {
      has_overlap_ = true;
      return Outcome::kInconsistent;
    }
  }
  Take(tile);
  return is_new ? Outcome::kNewVersion : Outcome::kAccepted;
}

std::optional<MapVersion> MapAssembler::version() const {
  return version_;
}

bool MapAssembler::IsComplete() const {
  return is_complete_;
}

bool MapAssembler::IsCorrupt() const {
  return has_overlap_ || (version_ && num_received_ == count() && !is_complete_);
}

bool MapAssembler::Covers(const Eigen::Vector2d& min_map, const Eigen::Vector2d& max_map) const {
  if (!version_ || !min_map.allFinite() || !max_map.allFinite()) return false;
  return HasAll(CellsInWindow(grid_.geometry, min_map, max_map));
}

std::vector<int> MapAssembler::Missing(std::size_t limit) const {
  std::vector<int> missing;
  for (int i = 0; i < count() && missing.size() < limit; ++i) {
    if (!received_[static_cast<std::size_t>(i)]) missing.push_back(i);
  }
  return missing;
}

void MapAssembler::Clear() {
  std::vector<MapVersion> former = std::move(former_);
  const std::optional<MapVersion> cleared = last_version();
  *this = MapAssembler();
  former_ = std::move(former);
  cleared_ = cleared;
}

bool MapAssembler::GaveWay(const MapVersion& version) const {
  if (last_version() && IsOlder(version, *last_version())) return true;
  return std::any_of(former_.begin(), former_.end(), [&](const MapVersion& former) {
    return version == former || IsOlder(version, former);
  });
}

bool MapAssembler::Contradicts(const MapTile& tile) const {
  return tile.geometry != grid_.geometry || tile.count != count() ||
         tile.map_checksum != map_checksum_;
}

bool MapAssembler::HasAny(const CellRectangle& rectangle) const {
  return CountReceived(rectangle) > 0;
}

bool MapAssembler::HasAll(const CellRectangle& rectangle) const {
  return is_complete_ || CountReceived(rectangle) == rectangle.num_cells();
}

std::int64_t MapAssembler::CountReceived(const CellRectangle& rectangle) const {
  std::int64_t num = 0;
  for (int row = rectangle.row; row < rectangle.row + rectangle.height; ++row) {
    const auto first = is_cell_received_.begin() +
                       static_cast<std::ptrdiff_t>(grid_.geometry.IndexOf({rectangle.column, row}));
    num += std::count(first, first + rectangle.width, true);
  }
  return num;
}

void MapAssembler::Begin(const MapTile& tile) {
  if (last_version() && *last_version() != tile.version) former_.push_back(*last_version());
  if (former_.size() > kMaxFormer) former_.erase(former_.begin());
  Clear();
  version_ = tile.version;
  map_checksum_ = tile.map_checksum;
  grid_.geometry = tile.geometry;
  grid_.cells.assign(tile.geometry.num_cells(), OccupancyGrid::kUnknown);
  is_cell_received_.assign(tile.geometry.num_cells(), false);
  received_.assign(static_cast<std::size_t>(tile.count), false);
}

void MapAssembler::Take(const MapTile& tile) {
  auto from = tile.cells.begin();
  for (int row = 0; row < tile.rectangle.height; ++row, from += tile.rectangle.width) {
    const auto to = static_cast<std::ptrdiff_t>(
        grid_.geometry.IndexOf({tile.rectangle.column, tile.rectangle.row + row}));
    std::copy_n(from, tile.rectangle.width, grid_.cells.begin() + to);
    std::fill_n(is_cell_received_.begin() + to, tile.rectangle.width, true);
  }
  received_[static_cast<std::size_t>(tile.index)] = true;
  ++num_received_;
  num_cells_received_ += tile.rectangle.num_cells();
  is_complete_ = num_received_ == count() &&
                 num_cells_received_ == static_cast<std::int64_t>(grid_.cells.size()) &&
                 Checksum(grid_.cells) == map_checksum_;
}

}  // namespace clearway::core
