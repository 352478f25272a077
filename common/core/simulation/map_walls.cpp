// SPDX-License-Identifier: BSD-3-Clause
#include "common/core/simulation/map_walls.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace clearway::core {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr std::uint8_t kFar = 255;

// One axis of a walk through cells: where the ray is, and when it crosses the next border.
struct Axis {
  double origin = 0.0;  // In cells.
  double speed = 0.0;   // Cells for each metre of the ray.
  int cell = 0;
  int step = 0;

  [[nodiscard]] double NextBorder() const {
    if (step == 0) return kInfinity;
    return (static_cast<double>(step > 0 ? cell + 1 : cell) - origin) / speed;
  }
  void GoTo(double range_m) { cell = static_cast<int>(std::floor(origin + speed * range_m)); }
};

// The part of the ray for which 0 <= origin + speed * range <= size.
void Clip(double origin, double speed, double size, double& from_m, double& to_m) {
  if (speed == 0.0) {
    if (origin < 0.0 || origin > size) to_m = -kInfinity;
    return;
  }
  const double a = -origin / speed;
  const double b = (size - origin) / speed;
  from_m = std::max(from_m, std::min(a, b));
  to_m = std::min(to_m, std::max(a, b));
}

}  // namespace

MapWallCaster::MapWallCaster(const MapWalls& walls)
    : geometry_(walls.grid.geometry),
      cosine_(std::cos(walls.grid.geometry.origin_yaw_rad)),
      sine_(std::sin(walls.grid.geometry.origin_yaw_rad)),
      height_m_(walls.height_m),
      reflectivity_(walls.reflectivity) {
  MeasureClearance(walls.grid);
}

// Two sweeps give the exact distance in the maximum norm.
void MapWallCaster::MeasureClearance(const OccupancyGrid& grid) {
  const int width = geometry_.width;
  const int height = geometry_.height;
  clearance_.resize(grid.cells.size());
  std::transform(grid.cells.begin(), grid.cells.end(), clearance_.begin(), [](std::uint8_t cell) {
    const bool is_wall = cell >= MapWalls::kLeastWall && cell != OccupancyGrid::kUnknown;
    return is_wall ? std::uint8_t{0} : kFar;
  });
  const auto relax = [&](int column, int row, int d_column, int d_row) {
    const CellIndex other{column + d_column, row + d_row};
    if (!geometry_.Contains(other)) return;
    const std::uint8_t near = clearance_[geometry_.IndexOf(other)];
    std::uint8_t& here = clearance_[geometry_.IndexOf({column, row})];
    if (near < kFar - 1 && near + 1 < here) here = static_cast<std::uint8_t>(near + 1);
  };
  for (int row = 0; row < height; ++row) {
    for (int column = 0; column < width; ++column) {
      for (const int d : {-1, 0, 1}) relax(column, row, d, -1);
      relax(column, row, -1, 0);
    }
  }
  for (int row = height - 1; row >= 0; --row) {
    for (int column = width - 1; column >= 0; --column) {
      for (const int d : {-1, 0, 1}) relax(column, row, d, 1);
      relax(column, row, 1, 0);
    }
  }
}

std::optional<RayHit> MapWallCaster::Cast(const Eigen::Vector3d& origin_map,
                                          const Eigen::Vector3d& direction_map,
                                          double max_range_m) const {
  const double x_m = origin_map.x() - geometry_.origin_x_m;
  const double y_m = origin_map.y() - geometry_.origin_y_m;
  const double scale = 1.0 / geometry_.resolution_m;
  const auto make_axis = [&](double origin_m, double direction) {
    return Axis{.origin = origin_m * scale,
                .speed = direction * scale,
                .cell = 0,
                .step = direction > 0.0 ? 1 : (direction < 0.0 ? -1 : 0)};
  };
  Axis column = make_axis(cosine_ * x_m + sine_ * y_m,
                          cosine_ * direction_map.x() + sine_ * direction_map.y());
  Axis row = make_axis(cosine_ * y_m - sine_ * x_m,
                       cosine_ * direction_map.y() - sine_ * direction_map.x());
  double range_m = 0.0;
  double last_m = max_range_m;
  Clip(column.origin, column.speed, geometry_.width, range_m, last_m);
  Clip(row.origin, row.speed, geometry_.height, range_m, last_m);
  Clip(origin_map.z(), direction_map.z(), height_m_, range_m, last_m);
  if (range_m > last_m) return std::nullopt;

  const double fastest = std::max(std::abs(column.speed), std::abs(row.speed));
  double face_cos = std::abs(direction_map.z());  // Where it comes in from above.
  bool is_inside_wall = range_m == 0.0;           // What holds the origin is not seen.
  column.GoTo(range_m);
  row.GoTo(range_m);
  // On the far border of the grid, rounding may have gone one too far.
  column.cell = std::clamp(column.cell, 0, geometry_.width - 1);
  row.cell = std::clamp(row.cell, 0, geometry_.height - 1);
  while (geometry_.Contains({column.cell, row.cell})) {
    const std::uint8_t clearance = clearance_[geometry_.IndexOf({column.cell, row.cell})];
    if (clearance == 0 && !is_inside_wall) {
      return RayHit{range_m, face_cos, reflectivity_, kMapObject, Material::kDiffuse};
    }
    if (clearance > 0) is_inside_wall = false;
    if (clearance > 1 && fastest > 0.0) {
      range_m += (static_cast<double>(clearance - 1) - 1e-9) / fastest;
      if (range_m > last_m) return std::nullopt;
      column.GoTo(range_m);
      row.GoTo(range_m);
      continue;
    }
    const double column_m = column.NextBorder();
    const double row_m = row.NextBorder();
    Axis& next = column_m < row_m ? column : row;
    range_m = std::min(column_m, row_m);
    if (!(range_m <= last_m)) return std::nullopt;
    face_cos = std::abs(next.speed) * geometry_.resolution_m;
    next.cell += next.step;
  }
  return std::nullopt;
}

}  // namespace clearway::core
