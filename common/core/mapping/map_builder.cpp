// SPDX-License-Identifier: BSD-3-Clause
#include "common/core/mapping/map_builder.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>

namespace clearway::core {
namespace {

constexpr double kAlignmentTolerance = 1e-6;   // Of a cell.
constexpr double kResolutionTolerance = 1e-9;  // Relative.
constexpr double kMaxColumn = 1e9;             // From map's origin, so that an int holds it.

// Rounded down.
int BlockOf(int cell, int block) {
  return cell >= 0 ? cell / block : -((block - 1 - cell) / block);
}

std::uint64_t KeyOf(int block_column, int block_row) {
  return (std::uint64_t{static_cast<std::uint32_t>(block_row)} << 32U) |
         static_cast<std::uint32_t>(block_column);
}

bool IsAligned(double cells) {
  return std::abs(cells - std::round(cells)) <= kAlignmentTolerance;
}

// Calls visit(column, row, value) for each seen cell of a grid whose first cell is `first`.
template <typename Visit>
void ForEachSeen(const OccupancyGrid& grid, const CellIndex& first, const Visit& visit) {
  std::size_t i = 0;
  for (int row = 0; row < grid.geometry.height; ++row) {
    for (int column = 0; column < grid.geometry.width; ++column, ++i) {
      if (grid.cells[i] == OccupancyGrid::kUnknown) continue;
      visit(first.column + column, first.row + row, grid.cells[i]);
    }
  }
}

std::uint8_t ValueOf(std::uint32_t seen, std::uint32_t hit, const MapBuilderConfig& config) {
  if (seen == 0 || static_cast<double>(seen) < config.min_scans) return OccupancyGrid::kUnknown;
  // A share of 0.3 of 10 scans is 3 of them, although 0.3 is not exact in binary.
  const double least = config.min_share * seen * (1.0 - 1e-9);
  return hit > 0 && hit >= least ? OccupancyGrid::kOccupied : OccupancyGrid::kFree;
}

}  // namespace

void MapBuilder::Bounds::Extend(int column, int row) {
  left = std::min(left, column);
  right = std::max(right, column);
  bottom = std::min(bottom, row);
  top = std::max(top, row);
}

std::int64_t MapBuilder::Bounds::num_cells() const {
  if (right < left) return 0;
  return (std::int64_t{right} - left + 1) * (std::int64_t{top} - bottom + 1);
}

MapBuilder::Outcome MapBuilder::Add(const OccupancyGrid& local) {
  const GridGeometry& geometry = local.geometry;
  if (geometry.width == 0 && geometry.height == 0 && local.cells.empty()) return Outcome::kAdded;
  if (!geometry.IsValid() || local.cells.size() != geometry.num_cells() ||
      geometry.origin_yaw_rad != 0.0) {
    return Outcome::kInvalid;
  }
  const double column = geometry.origin_x_m / geometry.resolution_m;
  const double row = geometry.origin_y_m / geometry.resolution_m;
  if (!(std::abs(column) <= kMaxColumn && std::abs(row) <= kMaxColumn)) return Outcome::kTooLarge;
  if (!IsAligned(column) || !IsAligned(row) || !HasResolution(geometry.resolution_m)) {
    return Outcome::kOtherGrid;
  }
  const CellIndex first{static_cast<int>(std::lround(column)), static_cast<int>(std::lround(row))};
  return AddCells(local, first);
}

bool MapBuilder::HasResolution(double resolution_m) const {
  return blocks_.empty() ||
         std::abs(resolution_m - resolution_m_) <= kResolutionTolerance * resolution_m_;
}

MapBuilder::Outcome MapBuilder::AddCells(const OccupancyGrid& local, const CellIndex& first) {
  Bounds bounds = bounds_;
  std::unordered_set<std::uint64_t> new_blocks;
  std::uint64_t last_key = 0;
  bool is_first = true;
  ForEachSeen(local, first, [&](int column, int row, std::uint8_t) {
    bounds.Extend(column, row);
    const std::uint64_t key = KeyOf(BlockOf(column, kBlock), BlockOf(row, kBlock));
    if (key == last_key && !is_first) return;
    last_key = key;
    is_first = false;
    if (!blocks_.contains(key)) new_blocks.insert(key);
  });
  // A long and thin map has far more cells in its blocks than within its bounds.
  const auto num_block_cells =
      static_cast<std::int64_t>((blocks_.size() + new_blocks.size()) * kBlock * kBlock);
  if (bounds.num_cells() > GridGeometry::kMaxCells ||
      num_block_cells > 2 * GridGeometry::kMaxCells) {
    return Outcome::kTooLarge;
  }
  if (blocks_.empty()) resolution_m_ = local.geometry.resolution_m;
  bounds_ = bounds;
  Block* block = nullptr;
  ForEachSeen(local, first, [&](int column, int row, std::uint8_t value) {
    const int block_column = BlockOf(column, kBlock);
    const int block_row = BlockOf(row, kBlock);
    const std::uint64_t key = KeyOf(block_column, block_row);
    if (block == nullptr || key != last_key) block = &blocks_[key];
    last_key = key;
    const int i = (row - block_row * kBlock) * kBlock + (column - block_column * kBlock);
    Evidence& evidence = block->cells[static_cast<std::size_t>(i)];
    ++evidence.seen;
    if (value >= kOccupiedFrom) ++evidence.hit;
  });
  return Outcome::kAdded;
}

OccupancyGrid MapBuilder::Build(const MapBuilderConfig& config) const {
  assert(has_cells());
  OccupancyGrid grid;
  grid.geometry.width = bounds_.right - bounds_.left + 1;
  grid.geometry.height = bounds_.top - bounds_.bottom + 1;
  grid.geometry.resolution_m = resolution_m_;
  grid.geometry.origin_x_m = resolution_m_ * bounds_.left;
  grid.geometry.origin_y_m = resolution_m_ * bounds_.bottom;
  grid.cells.assign(grid.geometry.num_cells(), OccupancyGrid::kUnknown);
  // Each block writes its own cells: their order does not matter.
  for (const auto& [key, block] : blocks_) {
    const int left = static_cast<std::int32_t>(static_cast<std::uint32_t>(key)) * kBlock;
    const int bottom = static_cast<std::int32_t>(static_cast<std::uint32_t>(key >> 32U)) * kBlock;
    for (int i = 0; i < kBlock * kBlock; ++i) {
      const Evidence& evidence = block.cells[static_cast<std::size_t>(i)];
      if (evidence.seen == 0) continue;
      const CellIndex cell{left + i % kBlock - bounds_.left, bottom + i / kBlock - bounds_.bottom};
      grid.cells[grid.geometry.IndexOf(cell)] = ValueOf(evidence.seen, evidence.hit, config);
    }
  }
  return grid;
}

}  // namespace clearway::core
