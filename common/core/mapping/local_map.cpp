// SPDX-License-Identifier: BSD-3-Clause
#include "common/core/mapping/local_map.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <cstddef>
#include <limits>
#include <optional>
#include <utility>

namespace clearway::core {
namespace {

// Obstacle points below this are not floor and not on it [m above the floor]: what lies between
// them and the sensor is not known well enough to be called free.
constexpr double kBelowFloor_m = -0.05;

constexpr double kMaxColumn = 1e9;  // From map's origin, so that an int holds it.

constexpr float kNoRay = std::numeric_limits<float>::infinity();

// The part of a segment, as shares of its length, that lies in [0, width] x [0, height]. Nothing
// when none of it does. Source: Liang and Barsky 1984, "A new concept and method for line
// clipping".
struct Part {
  double from = 0.0;
  double to = 1.0;
};
std::optional<Part> Clip(const Eigen::Vector2d& from,
                         const Eigen::Vector2d& to,
                         const Eigen::Vector2d& size) {
  Part part;
  for (int axis = 0; axis < 2; ++axis) {
    const double step = to[axis] - from[axis];
    if (step == 0.0) {
      if (!(from[axis] >= 0.0 && from[axis] <= size[axis])) return std::nullopt;
      continue;
    }
    const double at_low = -from[axis] / step;
    const double at_high = (size[axis] - from[axis]) / step;
    part.from = std::max(part.from, std::min(at_low, at_high));
    part.to = std::min(part.to, std::max(at_low, at_high));
  }
  if (!(part.from <= part.to)) return std::nullopt;
  return part;
}

// One axis of a segment that lies on the grid and ends in the middle of a cell, from there on in
// whole numbers of a millionth of a cell. Products of two lengths take 53 bits at 4001 cells.
struct Axis {
  Axis(double from, double to, int num_cells) {
    const auto to_units = [&](double cells) {
      return std::int64_t{std::llround(std::clamp(cells, 0.0, 1.0 * num_cells) * kCell)};
    };
    const std::int64_t from_units = to_units(from);
    const std::int64_t end_units = to_units(to);
    first = static_cast<int>(std::min<std::int64_t>(from_units / kCell, num_cells - 1));
    num_borders = std::abs(static_cast<int>(end_units / kCell) - first);
    step = end_units > from_units ? 1 : -1;
    to_border = step > 0 ? (first + 1) * kCell - from_units : from_units - first * kCell;
    length = std::abs(end_units - from_units);
  }

  static constexpr std::int64_t kCell = std::int64_t{1} << 20U;

  int first;               // Cell that it starts in.
  int num_borders;         // Between cells, crossed on its way.
  int step;                // 1 or -1.
  std::int64_t to_border;  // From the start to the first border.
  std::int64_t length;     // Of the segment.
};

// The grid of a local map while it is drawn. Lengths in the plane are in cells, from the lower left
// corner; heights in metres above the floor.
class Drawing {
 public:
  Drawing(const LocalMapConfig& config, const LocalMapBuilder::Scan& scan)
      : config_(config),
        // Less a trifle: a radius of whole cells does not take one more.
        reach_(static_cast<int>(std::ceil(config.radius_m / config.resolution_m - 1e-9))),
        first_((scan.T_map_vehicle.translation().head<2>() / config.resolution_m).array().floor() -
               reach_),
        T_map_vehicle_(scan.T_map_vehicle) {
    geometry_.width = geometry_.height = 2 * reach_ + 1;
    geometry_.resolution_m = config.resolution_m;
    geometry_.origin_x_m = first_.x() * config.resolution_m;
    geometry_.origin_y_m = first_.y() * config.resolution_m;
    cells_.assign(geometry_.num_cells(), OccupancyGrid::kUnknown);
    for (const Eigen::Vector3d& origin_vehicle : scan.sensor_origins_vehicle) {
      const Eigen::Vector2d position = ToCells(origin_vehicle);
      // From one that is not finite or absurdly far there is no telling what it saw.
      if (!position.allFinite() || position.cwiseAbs().maxCoeff() > kMaxColumn) continue;
      sensors_.push_back({position, origin_vehicle.z(), {}});
      sensors_.back().lowest_m.assign(cells_.size(), kNoRay);
    }
  }

  void AddObstacles(const PointCloud& cloud_vehicle) {
    for (std::size_t i = 0; i < cloud_vehicle.size(); ++i) {
      if (!IsFinite(cloud_vehicle, i)) continue;
      const Eigen::Vector3d point_vehicle = cloud_vehicle.Point(i).cast<double>();
      if (point_vehicle.z() < kBelowFloor_m || point_vehicle.z() > config_.z_max_m) continue;
      const Eigen::Vector2d point = ToCells(point_vehicle);
      AddTarget(point, point_vehicle.z());
      if (point_vehicle.z() < config_.z_min_m) continue;
      if (const auto cell = CellAt(point)) occupied_.push_back(geometry_.IndexOf(*cell));
    }
  }

  void AddFloor(const PointCloud& cloud_vehicle) {
    for (std::size_t i = 0; i < cloud_vehicle.size(); ++i) {
      if (!IsFinite(cloud_vehicle, i)) continue;
      const Eigen::Vector3d point_vehicle = cloud_vehicle.Point(i).cast<double>();
      if (point_vehicle.z() > config_.z_max_m) continue;
      const Eigen::Vector2d point = ToCells(point_vehicle);
      AddTarget(point, point_vehicle.z());
      if (const auto cell = CellAt(point)) Free(*cell);
    }
  }

  OccupancyGrid Finish() {
    for (const Sensor& sensor : sensors_) {
      std::size_t i = 0;
      for (int row = 0; row < geometry_.height; ++row) {
        for (int column = 0; column < geometry_.width; ++column, ++i) {
          if (sensor.lowest_m[i] < kNoRay) DrawRay(sensor, {column, row}, sensor.lowest_m[i]);
        }
      }
    }
    for (const std::size_t i : occupied_) cells_[i] = OccupancyGrid::kOccupied;
    const bool has_seen = std::any_of(cells_.begin(), cells_.end(), [](std::uint8_t value) {
      return value != OccupancyGrid::kUnknown;
    });
    if (!has_seen) return EmptyGrid(config_.resolution_m);
    return {geometry_, std::move(cells_)};
  }

  static OccupancyGrid EmptyGrid(double resolution_m) {
    OccupancyGrid grid;
    grid.geometry.resolution_m = resolution_m;
    return grid;
  }

 private:
  struct Sensor {
    Eigen::Vector2d position;
    double height_m;
    // For each cell, where the lowest of the rays that end in it ends; kNoRay without one. The
    // lowest one comes down into the band first.
    std::vector<float> lowest_m;
  };

  [[nodiscard]] Eigen::Vector2d ToCells(const Eigen::Vector3d& point_vehicle) const {
    return (T_map_vehicle_ * point_vehicle).head<2>() / config_.resolution_m - first_;
  }

  [[nodiscard]] std::optional<CellIndex> CellAt(const Eigen::Vector2d& point) const {
    if (!(point.x() >= 0.0 && point.x() < geometry_.width && point.y() >= 0.0 &&
          point.y() < geometry_.height)) {
      return std::nullopt;
    }
    return CellIndex{static_cast<int>(point.x()), static_cast<int>(point.y())};
  }

  // The cell of a point that lies on the grid or, for rounding, next to it.
  [[nodiscard]] CellIndex NearestCell(const Eigen::Vector2d& point) const {
    return {static_cast<int>(std::clamp(point.x(), 0.0, geometry_.width - 1.0)),
            static_cast<int>(std::clamp(point.y(), 0.0, geometry_.height - 1.0))};
  }

  [[nodiscard]] Eigen::Vector2d size() const {
    return {static_cast<double>(geometry_.width), static_cast<double>(geometry_.height)};
  }

  void Free(const CellIndex& cell) { cells_[geometry_.IndexOf(cell)] = OccupancyGrid::kFree; }

  // Nothing without a sensor.
  Sensor* NearestSensor(const Eigen::Vector2d& point) {
    Sensor* nearest = nullptr;
    double least = std::numeric_limits<double>::infinity();
    for (Sensor& sensor : sensors_) {
      const double squared = (sensor.position - point).squaredNorm();
      if (!(squared < least)) continue;
      least = squared;
      nearest = &sensor;
    }
    return nearest;
  }

  // Notes the cell in which the ray to a point ends: the point's, or the last one on the grid.
  void AddTarget(const Eigen::Vector2d& point, double z_m) {
    Sensor* const sensor = NearestSensor(point);
    if (sensor == nullptr) return;
    std::optional<CellIndex> cell = CellAt(point);
    if (!cell) {
      const auto part = Clip(sensor->position, point, size());
      if (!part) return;
      cell = NearestCell(sensor->position + part->to * (point - sensor->position));
      z_m = sensor->height_m + part->to * (z_m - sensor->height_m);
      if (z_m > config_.z_max_m) return;
    }
    float& lowest_m = sensor->lowest_m[geometry_.IndexOf(*cell)];
    lowest_m = std::min(lowest_m, static_cast<float>(z_m));
  }

  // Frees the cells from where the ray is on the grid and not above the band, to its end.
  void DrawRay(const Sensor& sensor, const CellIndex& end, double end_z_m) {
    const Eigen::Vector2d target(end.column + 0.5, end.row + 0.5);
    const auto part = Clip(sensor.position, target, size());
    if (!part) return;
    double from = part->from;
    if (sensor.height_m > config_.z_max_m) {
      const double fall_m = sensor.height_m - end_z_m;
      from = std::max(from, std::min(1.0, (sensor.height_m - config_.z_max_m) / fall_m));
    }
    DrawSegment(sensor.position + from * (target - sensor.position), target);
  }

  // Frees the cells that a segment on the grid crosses, which ends in the middle of one.
  // Source: Amanatides and Woo 1987, "A fast voxel traversal algorithm for ray tracing"; instead of
  // comparing tMaxX with tMaxY, the sign of their difference is kept, in whole numbers, so that
  // rounding cannot lead past the end.
  void DrawSegment(const Eigen::Vector2d& from, const Eigen::Vector2d& to) {
    const Axis x(from.x(), to.x(), geometry_.width);
    const Axis y(from.y(), to.y(), geometry_.height);
    const std::ptrdiff_t step_x = x.step;
    const std::ptrdiff_t step_y = std::ptrdiff_t{y.step} * geometry_.width;
    const std::int64_t border_x = Axis::kCell * y.length;
    const std::int64_t border_y = -Axis::kCell * x.length;
    std::int64_t difference = x.to_border * y.length - y.to_border * x.length;
    std::uint8_t* cell = &cells_[geometry_.IndexOf({x.first, y.first})];
    *cell = OccupancyGrid::kFree;
    for (int left = x.num_borders + y.num_borders; left > 0; --left) {
      const bool is_along_x = difference < 0;
      cell += is_along_x ? step_x : step_y;
      difference += is_along_x ? border_x : border_y;
      *cell = OccupancyGrid::kFree;
    }
  }

  const LocalMapConfig& config_;
  int reach_;              // Columns and rows on each side of the vehicle's.
  Eigen::Vector2d first_;  // The grid's origin, from map's; whole numbers.
  const Eigen::Isometry3d& T_map_vehicle_;
  GridGeometry geometry_;
  std::vector<std::uint8_t> cells_;
  std::vector<Sensor> sensors_;
  std::vector<std::size_t> occupied_;
};

}  // namespace

LocalMap LocalMapBuilder::Build(const Scan& scan) const {
  assert(!scan.sensor_origins_vehicle.empty());
  LocalMap map;
  for (const Eigen::Vector3d& origin_vehicle : scan.sensor_origins_vehicle) {
    map.sensor_origins_map.emplace_back((scan.T_map_vehicle * origin_vehicle).head<2>());
  }
  const Eigen::Vector2d vehicle = scan.T_map_vehicle.translation().head<2>() / config_.resolution_m;
  if (!scan.T_map_vehicle.matrix().allFinite() || vehicle.cwiseAbs().maxCoeff() > kMaxColumn) {
    map.grid = Drawing::EmptyGrid(config_.resolution_m);
    return map;
  }
  Drawing drawing(config_, scan);
  drawing.AddObstacles(scan.obstacles_vehicle);
  drawing.AddFloor(scan.floor_vehicle);
  map.grid = drawing.Finish();
  return map;
}

}  // namespace clearway::core
