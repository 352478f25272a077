// SPDX-License-Identifier: BSD-3-Clause
#include "common/core/simulation/render_map.hpp"

#include <cmath>

#include <gtest/gtest.h>

namespace clearway::core {
namespace {

std::uint8_t CellAt(const OccupancyGrid& grid, double x_m, double y_m) {
  const auto cell = grid.geometry.CellAt({x_m, y_m});
  return cell ? grid.At(*cell) : OccupancyGrid::kUnknown;
}

SceneConfig Room() {
  SceneConfig scene;
  scene.start = {.x_m = 1.0, .y_m = 1.0, .yaw_rad = 0.0};
  scene.rooms.push_back({.name = "room",
                         .x_min_m = 0,
                         .x_max_m = 6,
                         .y_min_m = 0,
                         .y_max_m = 4,
                         .height_m = 2.5,
                         .ceiling = true,
                         .reflectivity = 0.6,
                         .material = Material::kDiffuse,
                         .on_map = true});
  return scene;
}

SceneBox BoxAt(const char* name, double x_m, bool on_map) {
  SceneBox box;
  box.object.name = name;
  box.object.x_m = x_m;
  box.object.y_m = 2.0;
  box.object.on_map = on_map;
  box.length_m = box.width_m = 0.6;
  box.height_m = 0.5;
  return box;
}

TEST(RenderMapTest, ShowsWallsAndWhatIsOnTheMapAndNothingElse) {
  SceneConfig scene = Room();
  scene.boxes = {BoxAt("known", 3.0, true), BoxAt("new", 4.5, false)};

  const OccupancyGrid grid = RenderMap(scene, {});

  EXPECT_EQ(CellAt(grid, -0.05, 2.0), OccupancyGrid::kOccupied);
  EXPECT_EQ(CellAt(grid, 3.0, 2.0), OccupancyGrid::kOccupied);
  EXPECT_EQ(CellAt(grid, 4.5, 2.0), OccupancyGrid::kFree);
  EXPECT_EQ(CellAt(grid, 1.0, 1.0), OccupancyGrid::kFree);
  EXPECT_EQ(CellAt(grid, -0.2, 2.0), OccupancyGrid::kUnknown);
}

TEST(RenderMapTest, AStaleMapShowsWhatHasVanished) {
  SceneConfig scene = Room();
  scene.boxes = {BoxAt("gone", 3.0, true)};
  scene.boxes[0].object.vanish_s = 0.0;
  ASSERT_TRUE(scene.boxes[0].Validate().empty());

  EXPECT_EQ(CellAt(RenderMap(scene, {}), 3.0, 2.0), OccupancyGrid::kOccupied);
}

TEST(RenderMapTest, AShiftedAndTurnedMapIsTheRightOneInAnotherPlace) {
  SceneConfig scene = Room();
  scene.boxes = {BoxAt("known", 3.0, true)};
  const MapErrorConfig error{.shift_x_m = 0.3, .shift_y_m = -0.2, .turn_rad = 0.1};

  const OccupancyGrid wrong = RenderMap(scene, {.error = error});

  const Eigen::Vector2d box =
      Eigen::Rotation2Dd(0.1) * Eigen::Vector2d(3.0, 2.0) + Eigen::Vector2d(0.3, -0.2);
  EXPECT_EQ(CellAt(wrong, box.x(), box.y()), OccupancyGrid::kOccupied);
  EXPECT_EQ(wrong.cells, RenderMap(scene, {}).cells);
}

TEST(RenderMapTest, WhatHangsAboveOrLiesBelowTheBandIsNotOnTheMap) {
  SceneConfig scene = Room();
  SceneBox lamp = BoxAt("lamp", 3.0, true);
  lamp.object.z_m = 1.5;
  SceneBox mat = BoxAt("mat", 4.5, true);
  mat.height_m = 0.02;
  scene.boxes = {lamp, mat};

  const OccupancyGrid grid = RenderMap(scene, {});

  EXPECT_EQ(CellAt(grid, 3.0, 2.0), OccupancyGrid::kFree);
  EXPECT_EQ(CellAt(grid, 4.5, 2.0), OccupancyGrid::kFree);
}

TEST(RenderMapTest, ASceneWithoutAnythingOnTheMapHasNoMap) {
  EXPECT_TRUE(RenderMap(SceneConfig{}, {}).cells.empty());
}

}  // namespace
}  // namespace clearway::core
