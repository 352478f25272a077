// SPDX-License-Identifier: BSD-3-Clause
#include "common/core/simulation/floor_plan.hpp"

#include <algorithm>
#include <cmath>

#include "common/core/simulation/scene_geometry.hpp"
#include "common/core/simulation/scene_visit.hpp"

namespace clearway::core {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

bool DoesChange(const SceneConfig& scene) {
  bool does_change = false;
  ForEachObject(scene, [&](const auto& element, ObjectKind, std::int32_t) {
    if constexpr (Placed<std::decay_t<decltype(element)>>) {
      const SceneObject& object = element.object;
      does_change = does_change || object.appear_s >= 0.0 || object.vanish_s >= 0.0 ||
                    (object.speed_mps > 0.0 && !object.waypoints.empty());
    }
  });
  return does_change;
}

std::vector<Vector3d> CornersOf(const Eigen::Isometry3d& T_map_local, const Vector3d& half) {
  std::vector<Vector3d> corners;
  for (const double x : {-1.0, 1.0}) {
    for (const double y : {-1.0, 1.0}) {
      for (const double z : {-1.0, 1.0}) {
        corners.push_back(T_map_local * half.cwiseProduct(Vector3d(x, y, z)));
      }
    }
  }
  return corners;
}

FlatShape FromAbove(const std::vector<Vector3d>& corners) {
  std::vector<Vector2d> flat;
  for (const Vector3d& corner : corners) flat.emplace_back(corner.head<2>());
  return MakePolygon(flat);
}

// What of a solid is in the way of the body; nothing when it is too low or too high.
std::optional<FlatShape> FromAbove(const Primitive& solid, const RobotBody& body) {
  const std::vector<Vector3d> corners = CornersOf(solid.T_map_local, solid.half_extents);
  const auto [low, high] = std::minmax_element(
      corners.begin(), corners.end(), [](const auto& a, const auto& b) { return a.z() < b.z(); });
  if (high->z() <= body.clearance_m || low->z() >= body.height_m) return std::nullopt;
  const bool is_upright = std::abs(solid.T_map_local.linear()(2, 2)) > 1.0 - 1e-9;
  const bool is_disc = solid.shape == Primitive::Shape::kCylinder && is_upright;
  FlatShape shape =
      is_disc ? MakeDisc(solid.T_map_local.translation().head<2>(), solid.half_extents.x())
              : FromAbove(corners);
  shape.object = solid.object;
  return shape;
}

// The square of a cell.
FlatShape CellShape(const GridGeometry& grid, const CellIndex& cell) {
  const double half_m = 0.5 * grid.resolution_m;
  const Eigen::Rotation2Dd turn(grid.origin_yaw_rad);
  std::vector<Vector2d> corners;
  for (const double x : {-half_m, half_m}) {
    for (const double y : {-half_m, half_m}) {
      corners.emplace_back(grid.CenterOf(cell) + turn * Vector2d(x, y));
    }
  }
  return MakePolygon(corners);
}

constexpr std::uint8_t kOccupiedFrom = 65;

}  // namespace

FloorPlan::FloorPlan(const SceneConfig& scene,
                     const std::optional<MapWalls>& walls,
                     const RobotBody& body)
    : scene_(scene), walls_(walls), body_(body), does_change_(DoesChange(scene)) {
  if (walls_ && walls_->height_m <= body_.clearance_m) walls_.reset();
  if (walls_) field_.emplace(walls_->grid, kOccupiedFrom);
  for (const ObjectInfo& info : DescribeObjects(scene)) names_.push_back(info.name);
  MoveTo(0);
}

void FloorPlan::MoveTo(std::int64_t time_us) {
  if (time_us_ && (!does_change_ || *time_us_ == time_us)) return;
  time_us_ = time_us;
  shapes_.clear();
  const SceneGeometry geometry = GeometryAt(scene_, time_us);
  for (const Primitive& solid : geometry.primitives) {
    if (std::optional<FlatShape> shape = FromAbove(solid, body_)) {
      shapes_.push_back(*std::move(shape));
    }
  }
  for (const Pit& pit : geometry.pits) {
    if (2.0 * pit.half_extents.z() <= body_.clearance_m) continue;
    shapes_.push_back(FromAbove(CornersOf(pit.T_map_local, pit.half_extents)));
    shapes_.back().object = pit.object;
  }
}

FlatShape FloorPlan::FootprintAt(const PlanarPose& pose) const {
  const Eigen::Rotation2Dd turn(pose.yaw_rad);
  const Vector2d origin(pose.x_m, pose.y_m);
  FlatShape shape;
  for (const Vector2d& corner : body_.footprint) {
    shape.corners.emplace_back(origin + turn * corner);
    shape.reach_m = std::max(shape.reach_m, corner.norm());
  }
  shape.center = origin;
  return shape;
}

std::optional<std::int32_t> FloorPlan::Touched(const PlanarPose& pose) const {
  const Neighbour nearest = Nearest(pose, 1e-9);
  if (nearest.distance_m > 0.0) return std::nullopt;
  return nearest.object;
}

FloorPlan::Neighbour FloorPlan::Nearest(const PlanarPose& pose, double within_m) const {
  const FlatShape footprint = FootprintAt(pose);
  Neighbour best{within_m, kNoObject};
  for (const FlatShape& shape : shapes_) {
    // No point of the two is nearer than this.
    const double least_m =
        (shape.center - footprint.center).norm() - shape.reach_m - footprint.reach_m;
    if (least_m >= best.distance_m) continue;
    const double distance_m = Distance(footprint, shape);
    if (distance_m < best.distance_m) best = {distance_m, shape.object};
  }
  if (walls_) ImproveByWalls(footprint, best);
  if (best.object == kNoObject) return {};
  return best;
}

void FloorPlan::ImproveByWalls(const FlatShape& footprint, Neighbour& best) const {
  const GridGeometry& grid = walls_->grid.geometry;
  // The field is between middles of cells, the point is anywhere in its cell.
  const double reach_m = footprint.reach_m + best.distance_m;
  if (const std::optional<CellIndex> cell = grid.CellAt(footprint.center)) {
    const double nearest_m =
        grid.resolution_m * (std::sqrt(static_cast<double>(field_->SquaredCells(*cell))) - 1.5);
    if (nearest_m > reach_m) return;
  }
  const Vector2d half(reach_m, reach_m);
  const CellRectangle window =
      CellsInWindow(grid, footprint.center - half, footprint.center + half);
  for (int row = window.row; row < window.row + window.height; ++row) {
    for (int column = window.column; column < window.column + window.width; ++column) {
      const CellIndex cell{column, row};
      const std::uint8_t value = walls_->grid.At(cell);
      if (value < kOccupiedFrom || value == OccupancyGrid::kUnknown) continue;
      const double distance_m = Distance(footprint, CellShape(grid, cell));
      if (distance_m < best.distance_m) best = {distance_m, kMapObject};
    }
  }
}

std::string FloorPlan::NameOf(std::int32_t object) const {
  if (object == kMapObject) return "a wall of the map";
  if (object < 0 || static_cast<std::size_t>(object) >= names_.size()) return "nothing";
  return names_[static_cast<std::size_t>(object)];
}

}  // namespace clearway::core
