// SPDX-License-Identifier: BSD-3-Clause
#include "tools/plot/map_underlay.hpp"

#include <vector>

#include "common/core/mapping/occupancy_grid.hpp"
#include "tools/plot/palette.hpp"

namespace clearway::plot {
namespace {

using core::OccupancyGrid;
using Eigen::Vector2d;

constexpr int kHatch_px = 7;
constexpr std::uint8_t kOccupiedFrom = 65;  // As core::DistanceField has it.

bool IsOccupied(std::uint8_t cell) {
  return cell >= kOccupiedFrom && cell != OccupancyGrid::kUnknown;
}

Vector2d ToMap(const PictureMap& map, const Vector2d& point) {
  return (map.T_map_vehicle * Eigen::Vector3d(point.x(), point.y(), 0.0)).head<2>();
}

// Dots of one pixel, by their colour.
struct Pixels {
  std::vector<Eigen::Vector2f> occupied;
  std::vector<Eigen::Vector2f> between;
  std::vector<Eigen::Vector2f> unknown;
  std::vector<Eigen::Vector2f> hatch;
};

void AddPixel(const PictureMap& map, const FloorView& view, int u, int v, Pixels& pixels) {
  const Vector2d pixel(u + 0.5, v + 0.5);
  const std::optional<Vector2d> point = view.floor_at(pixel);
  if (!point) return;
  switch (GroundAt(map, *point)) {
    case MapGround::kOccupied:
      pixels.occupied.push_back(pixel.cast<float>());
      break;
    case MapGround::kBetween:
      pixels.between.push_back(pixel.cast<float>());
      break;
    case MapGround::kUnknown:
      ((u + v) % kHatch_px == 0 ? pixels.hatch : pixels.unknown).push_back(pixel.cast<float>());
      break;
    case MapGround::kFree:
      break;
  }
}

// Cells that are smaller than a pixel would be lost between the pixels.
void AddOccupiedCells(const PictureMap& map, const FloorView& view, Pixels& pixels) {
  const core::GridGeometry& geometry = map.grid->geometry;
  Vector2d low_map = ToMap(map, view.low);
  Vector2d high_map = low_map;
  for (const Vector2d& corner :
       {Vector2d(view.low.x(), view.high.y()), Vector2d(view.high.x(), view.low.y()), view.high}) {
    low_map = low_map.cwiseMin(ToMap(map, corner));
    high_map = high_map.cwiseMax(ToMap(map, corner));
  }
  const core::CellRectangle in_view = core::CellsInWindow(geometry, low_map, high_map);
  const Eigen::Isometry3d T_vehicle_map = map.T_map_vehicle.inverse();
  for (int row = in_view.row; row < in_view.row + in_view.height; ++row) {
    for (int column = in_view.column; column < in_view.column + in_view.width; ++column) {
      if (!IsOccupied(map.grid->At({column, row}))) continue;
      const Vector2d center = geometry.CenterOf({column, row});
      const Vector2d point =
          (T_vehicle_map *
           Eigen::Vector3d(center.x(), center.y(), map.T_map_vehicle.translation().z()))
              .head<2>();
      const std::optional<Vector2d> pixel = view.pixel_at(point);
      if (pixel && view.floor_at(*pixel)) pixels.occupied.push_back(pixel->cast<float>());
    }
  }
}

}  // namespace

MapGround GroundAt(const PictureMap& map, const Vector2d& point) {
  const std::optional<core::CellIndex> cell = map.grid->geometry.CellAt(ToMap(map, point));
  if (!cell) return MapGround::kUnknown;
  const std::uint8_t value = map.grid->At(*cell);
  if (value == OccupancyGrid::kUnknown) return MapGround::kUnknown;
  if (value == OccupancyGrid::kFree) return MapGround::kFree;
  return IsOccupied(value) ? MapGround::kOccupied : MapGround::kBetween;
}

void DrawMap(Canvas& canvas, const Rect& area, const PictureMap& map, const FloorView& view) {
  Pixels pixels;
  const auto right = static_cast<int>(area.x + area.width);
  const auto bottom = static_cast<int>(area.y + area.height);
  for (int v = static_cast<int>(area.y); v < bottom; ++v) {
    for (int u = static_cast<int>(area.x); u < right; ++u) AddPixel(map, view, u, v, pixels);
  }
  AddOccupiedCells(map, view, pixels);
  canvas.Dots(pixels.unknown, kUnknownTint, 1, area);
  canvas.Dots(pixels.hatch, kUnknownHatch, 1, area);
  canvas.Dots(pixels.between, kBetweenGrey, 1, area);
  canvas.Dots(pixels.occupied, kOccupiedGrey, 1, area);
}

}  // namespace clearway::plot
