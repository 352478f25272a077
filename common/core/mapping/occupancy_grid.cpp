// SPDX-License-Identifier: BSD-3-Clause
#include "common/core/mapping/occupancy_grid.hpp"

#include <algorithm>

namespace clearway::core {
namespace {

// A point of `map` in units of cells along the grid's axes.
Eigen::Vector2d ToCells(const GridGeometry& geometry, const Eigen::Vector2d& point_map) {
  const double dx = point_map.x() - geometry.origin_x_m;
  const double dy = point_map.y() - geometry.origin_y_m;
  const double cosine = std::cos(geometry.origin_yaw_rad);
  const double sine = std::sin(geometry.origin_yaw_rad);
  return Eigen::Vector2d(cosine * dx + sine * dy, cosine * dy - sine * dx) / geometry.resolution_m;
}

// Rounded down and kept in 0 .. limit; 0 for NaN, which huge corners can give.
int Clamped(double cells, int limit) {
  if (!(cells > 0.0)) return 0;
  return cells >= limit ? limit : static_cast<int>(cells);
}

}  // namespace

bool GridGeometry::IsValid() const {
  return width > 0 && height > 0 && std::int64_t{1} * width * height <= kMaxCells &&
         std::isfinite(resolution_m) && resolution_m > 0.0 && std::isfinite(origin_x_m) &&
         std::isfinite(origin_y_m) && std::isfinite(origin_yaw_rad);
}

std::optional<CellIndex> GridGeometry::CellAt(const Eigen::Vector2d& point_map) const {
  const Eigen::Vector2d cells = ToCells(*this, point_map);
  // A comparison with NaN is false.
  if (!(cells.x() >= 0.0 && cells.x() < width && cells.y() >= 0.0 && cells.y() < height)) {
    return std::nullopt;
  }
  return CellIndex{static_cast<int>(cells.x()), static_cast<int>(cells.y())};
}

Eigen::Vector2d GridGeometry::CenterOf(const CellIndex& cell) const {
  const double x_m = resolution_m * (cell.column + 0.5);
  const double y_m = resolution_m * (cell.row + 0.5);
  const double cosine = std::cos(origin_yaw_rad);
  const double sine = std::sin(origin_yaw_rad);
  return {origin_x_m + cosine * x_m - sine * y_m, origin_y_m + sine * x_m + cosine * y_m};
}

CellRectangle Intersection(const CellRectangle& a, const CellRectangle& b) {
  const int left = std::max(a.column, b.column);
  const int bottom = std::max(a.row, b.row);
  const auto end = [](int first, int size) { return std::int64_t{first} + size; };
  const std::int64_t right = std::min(end(a.column, a.width), end(b.column, b.width));
  const std::int64_t top = std::min(end(a.row, a.height), end(b.row, b.height));
  if (right <= left || top <= bottom) return {};
  return {left, bottom, static_cast<int>(right - left), static_cast<int>(top - bottom)};
}

CellRectangle CellsInWindow(const GridGeometry& geometry,
                            const Eigen::Vector2d& min_map,
                            const Eigen::Vector2d& max_map) {
  if (!min_map.allFinite() || !max_map.allFinite()) return {};
  Eigen::Vector2d low = ToCells(geometry, min_map);
  Eigen::Vector2d high = low;
  for (const Eigen::Vector2d& corner : {Eigen::Vector2d(min_map.x(), max_map.y()),
                                        Eigen::Vector2d(max_map.x(), min_map.y()),
                                        max_map}) {
    low = low.cwiseMin(ToCells(geometry, corner));
    high = high.cwiseMax(ToCells(geometry, corner));
  }
  const int left = Clamped(low.x(), geometry.width);
  const int bottom = Clamped(low.y(), geometry.height);
  const int right = high.x() < 0.0 ? 0 : Clamped(high.x() + 1.0, geometry.width);
  const int top = high.y() < 0.0 ? 0 : Clamped(high.y() + 1.0, geometry.height);
  if (right <= left || top <= bottom) return {};
  return {left, bottom, right - left, top - bottom};
}

std::vector<std::uint8_t> CellsOf(const OccupancyGrid& grid, const CellRectangle& rectangle) {
  std::vector<std::uint8_t> cells;
  cells.reserve(static_cast<std::size_t>(rectangle.num_cells()));
  for (int row = rectangle.row; row < rectangle.row + rectangle.height; ++row) {
    const auto first = grid.cells.begin() +
                       static_cast<std::ptrdiff_t>(grid.geometry.IndexOf({rectangle.column, row}));
    cells.insert(cells.end(), first, first + rectangle.width);
  }
  return cells;
}

}  // namespace clearway::core
