// SPDX-License-Identifier: BSD-3-Clause
#include "common/core/mapping/distance_field.hpp"

#include <algorithm>
#include <cstddef>
#include <span>

namespace clearway::core {
namespace {

// Distance along a column, in cells, of all that is too far to matter: 256 * 256 > kFar.
constexpr std::uint16_t kFarColumn = 256;

// A column of the row that is nearest to some cells of the row, with the first of them: the
// paper's s[q] and t[q].
struct Region {
  std::int64_t column;
  std::int64_t first;
};

// The second phase of the paper, for one row: `row` holds distances along the columns (the paper's
// g) and gets the squared distances.
class RowTransform {
 public:
  explicit RowTransform(std::size_t width) : squared_g_(width) { regions_.reserve(width); }

  void Apply(std::span<std::uint16_t> row) {
    regions_.clear();
    for (std::size_t u = 0; u < row.size(); ++u) {
      squared_g_[u] = std::int32_t{row[u]} * row[u];
      if (row[u] < kFarColumn) AddColumn(static_cast<std::int64_t>(u), row.size());
    }
    if (regions_.empty()) {
      std::fill(row.begin(), row.end(), DistanceField::kFar);
      return;
    }
    std::size_t q = regions_.size() - 1;
    for (std::size_t u = row.size(); u-- > 0;) {
      row[u] = static_cast<std::uint16_t>(std::min<std::int64_t>(
          SquaredDistance(static_cast<std::int64_t>(u), regions_[q].column), DistanceField::kFar));
      if (static_cast<std::int64_t>(u) == regions_[q].first && q > 0) --q;
    }
  }

 private:
  // The paper's f(x, i).
  [[nodiscard]] std::int64_t SquaredDistance(std::int64_t x, std::int64_t i) const {
    return (x - i) * (x - i) + squared_g_[static_cast<std::size_t>(i)];
  }

  // The paper's Sep(i, u): the last cell that is at least as near to column i as to column u > i.
  [[nodiscard]] std::int64_t LastOf(std::int64_t i, std::int64_t u) const {
    const std::int64_t difference =
        squared_g_[static_cast<std::size_t>(u)] - squared_g_[static_cast<std::size_t>(i)];
    return ((u - i) * (u + i) + difference) / (2 * (u - i));
  }

  void AddColumn(std::int64_t u, std::size_t width) {
    while (!regions_.empty() && SquaredDistance(regions_.back().first, regions_.back().column) >
                                    SquaredDistance(regions_.back().first, u)) {
      regions_.pop_back();
    }
    // After the loop the last region keeps its first cell, so that LastOf() is not negative.
    const std::int64_t first = regions_.empty() ? 0 : LastOf(regions_.back().column, u) + 1;
    if (first < static_cast<std::int64_t>(width)) regions_.push_back({u, first});
  }

  std::vector<std::int32_t> squared_g_;
  std::vector<Region> regions_;
};

bool IsOccupied(std::uint8_t value, std::uint8_t occupied_from) {
  return value >= occupied_from && value != OccupancyGrid::kUnknown;
}

// The first phase: of each cell, the distance to the nearest occupied cell of its column.
std::vector<std::uint16_t> ColumnDistances(const OccupancyGrid& grid, std::uint8_t occupied_from) {
  const auto width = static_cast<std::size_t>(grid.geometry.width);
  std::vector<std::uint16_t> distances(grid.cells.size());
  const auto next = [](std::uint16_t distance) {
    return static_cast<std::uint16_t>(std::min<int>(distance + 1, kFarColumn));
  };
  for (std::size_t i = 0; i < distances.size(); ++i) {
    const std::uint16_t below = i < width ? kFarColumn : distances[i - width];
    distances[i] = IsOccupied(grid.cells[i], occupied_from) ? std::uint16_t{0} : next(below);
  }
  for (std::size_t i = distances.size(); i-- > width;) {
    distances[i - width] = std::min(distances[i - width], next(distances[i]));
  }
  return distances;
}

}  // namespace

DistanceField::DistanceField(const OccupancyGrid& grid, std::uint8_t occupied_from)
    : geometry_(grid.geometry), squared_cells_(ColumnDistances(grid, occupied_from)) {
  const auto width = static_cast<std::size_t>(geometry_.width);
  RowTransform transform(width);
  const std::span<std::uint16_t> cells(squared_cells_);
  for (std::size_t first = 0; first < cells.size(); first += width) {
    transform.Apply(cells.subspan(first, width));
  }
}

}  // namespace clearway::core
