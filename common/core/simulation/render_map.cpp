// SPDX-License-Identifier: BSD-3-Clause
#include "common/core/simulation/render_map.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <string>
#include <vector>

#include "common/core/simulation/scene_geometry.hpp"

namespace clearway::core {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr double kBorder_m = 0.2;  // Round what is on the map.
// Points of a cell that are looked at, along each side.
constexpr std::array<double, 3> kSamples{0.02, 0.5, 0.98};

// The objects of the map, standing where they start for ever.
SceneConfig OnMapOnly(SceneConfig scene) {
  const auto keep = [](auto& list) {
    std::erase_if(list, [](const auto& element) { return !element.object.on_map; });
    for (auto& element : list) {
      element.object.appear_s = -1.0;
      element.object.vanish_s = -1.0;
      element.object.speed_mps = 0.0;
    }
  };
  const auto keep_walls = [](auto& list) {
    std::erase_if(list, [](const auto& element) { return !element.on_map; });
  };
  keep_walls(scene.rooms);
  keep_walls(scene.walls);
  keep(scene.boxes);
  keep(scene.cylinders);
  keep(scene.shelves);
  keep(scene.tables);
  keep(scene.cables);
  keep(scene.ramps);
  keep(scene.holes);
  keep(scene.persons);
  return scene;
}

// The upright shadow of a solid that reaches into the band of heights.
struct Shadow {
  Eigen::Isometry3d T_local_map = Eigen::Isometry3d::Identity();
  Vector3d half_extents = Vector3d::Zero();
  bool is_round = false;
  Vector2d center = Vector2d::Zero();
  double reach_m = 0.0;

  [[nodiscard]] bool Covers(const Vector2d& point) const {
    if ((point - center).squaredNorm() > reach_m * reach_m) return false;
    const Vector3d middle(point.x(), point.y(), -T_local_map.translation().z());
    Vector3d local = T_local_map * middle;
    if (is_round) return local.head<2>().norm() <= half_extents.x();
    return std::abs(local.x()) <= half_extents.x() && std::abs(local.y()) <= half_extents.y();
  }
};

std::vector<Shadow> ShadowsOf(const SceneConfig& scene, const RenderMapConfig& config) {
  std::vector<Shadow> shadows;
  for (const Primitive& primitive : GeometryAt(scene, 0).primitives) {
    const bool is_upright = std::abs(primitive.T_map_local.linear()(2, 2)) > 0.999;
    const double half_z_m = is_upright ? primitive.half_extents.z() : primitive.half_extents.x();
    const double z_m = primitive.T_map_local.translation().z();
    if (z_m + half_z_m < config.min_height_m || z_m - half_z_m > config.max_height_m) continue;
    shadows.push_back({.T_local_map = primitive.T_map_local.inverse(),
                       .half_extents = primitive.half_extents,
                       .is_round = primitive.shape == Primitive::Shape::kCylinder && is_upright,
                       .center = primitive.T_map_local.translation().head<2>(),
                       .reach_m = primitive.half_extents.norm()});
  }
  return shadows;
}

GridGeometry GeometryFor(const std::vector<Shadow>& shadows, double resolution_m) {
  Vector2d least = Vector2d::Constant(std::numeric_limits<double>::infinity());
  Vector2d most = -least;
  for (const Shadow& shadow : shadows) {
    const Eigen::Matrix3d R = shadow.T_local_map.linear().transpose();
    const Vector2d half = (R.cwiseAbs() * shadow.half_extents).head<2>();
    least = least.cwiseMin(shadow.center - half);
    most = most.cwiseMax(shadow.center + half);
  }
  const auto cell = [&](double m) { return std::floor(m / resolution_m); };
  constexpr double kMost = 1e8;  // A count of cells that still fits.
  const Vector2d from(cell(least.x() - kBorder_m), cell(least.y() - kBorder_m));
  const Vector2d to(cell(most.x() + kBorder_m), cell(most.y() + kBorder_m));
  return {.width = static_cast<int>(std::min(to.x() - from.x() + 1.0, kMost)),
          .height = static_cast<int>(std::min(to.y() - from.y() + 1.0, kMost)),
          .resolution_m = resolution_m,
          .origin_x_m = from.x() * resolution_m,
          .origin_y_m = from.y() * resolution_m};
}

bool IsOccupied(const std::vector<Shadow>& shadows, const Vector2d& corner, double resolution_m) {
  for (const double x : kSamples) {
    for (const double y : kSamples) {
      const Vector2d point = corner + resolution_m * Vector2d(x, y);
      const auto covers = [&point](const Shadow& shadow) { return shadow.Covers(point); };
      if (std::any_of(shadows.begin(), shadows.end(), covers)) return true;
    }
  }
  return false;
}

// What can be reached from a point without crossing an occupied cell is free.
void FloodFree(const Vector2d& start, OccupancyGrid& grid) {
  std::vector<CellIndex> waiting;
  if (const auto cell = grid.geometry.CellAt(start)) waiting.push_back(*cell);
  while (!waiting.empty()) {
    const CellIndex cell = waiting.back();
    waiting.pop_back();
    if (!grid.geometry.Contains(cell)) continue;
    std::uint8_t& value = grid.cells[grid.geometry.IndexOf(cell)];
    if (value != OccupancyGrid::kUnknown) continue;
    value = OccupancyGrid::kFree;
    waiting.push_back({cell.column + 1, cell.row});
    waiting.push_back({cell.column - 1, cell.row});
    waiting.push_back({cell.column, cell.row + 1});
    waiting.push_back({cell.column, cell.row - 1});
  }
}

}  // namespace

OccupancyGrid RenderMap(const SceneConfig& scene, const RenderMapConfig& config) {
  const std::vector<Shadow> shadows = ShadowsOf(OnMapOnly(scene), config);
  OccupancyGrid grid;
  grid.geometry.resolution_m = config.resolution_m;
  if (shadows.empty()) return grid;
  grid.geometry = GeometryFor(shadows, config.resolution_m);
  if (!grid.geometry.IsValid()) {
    throw std::invalid_argument("the scene is too large for a map of " +
                                std::to_string(config.resolution_m) + " m cells");
  }
  grid.cells.assign(grid.geometry.num_cells(), OccupancyGrid::kUnknown);
  for (int row = 0; row < grid.geometry.height; ++row) {
    for (int column = 0; column < grid.geometry.width; ++column) {
      const Vector2d corner(grid.geometry.origin_x_m + column * config.resolution_m,
                            grid.geometry.origin_y_m + row * config.resolution_m);
      if (!IsOccupied(shadows, corner, config.resolution_m)) continue;
      grid.cells[grid.geometry.IndexOf({column, row})] = OccupancyGrid::kOccupied;
    }
  }
  FloodFree({scene.start.x_m, scene.start.y_m}, grid);
  // A wrong map is a right one in a wrong place.
  const MapErrorConfig& error = config.error;
  const Vector2d origin = Eigen::Rotation2Dd(error.turn_rad) *
                              Vector2d(grid.geometry.origin_x_m, grid.geometry.origin_y_m) +
                          Vector2d(error.shift_x_m, error.shift_y_m);
  grid.geometry.origin_x_m = origin.x();
  grid.geometry.origin_y_m = origin.y();
  grid.geometry.origin_yaw_rad = error.turn_rad;
  return grid;
}

}  // namespace clearway::core
