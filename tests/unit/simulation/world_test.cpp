// SPDX-License-Identifier: BSD-3-Clause
#include "common/core/simulation/world.hpp"

#include <cmath>
#include <numbers>
#include <random>

#include <gtest/gtest.h>

#include "common/core/simulation/scene_geometry.hpp"

namespace clearway::core {
namespace {

using Eigen::Vector3d;

constexpr double kFov_rad = 0.62;

// A room full of all kinds of things, by chance.
SceneConfig RandomScene(std::mt19937& random) {
  const auto in = [&random](double lo, double hi) {
    return std::uniform_real_distribution<double>(lo, hi)(random);
  };
  SceneConfig scene;
  scene.rooms.push_back({.name = "room", .x_min_m = -5, .x_max_m = 5, .y_min_m = -4, .y_max_m = 4});
  const auto place = [&](SceneObject& object, int i) {
    object.name = "o" + std::to_string(i);
    object.x_m = in(-4, 4);
    object.y_m = in(-3, 3);
    object.z_m = in(0.0, 0.5);
    object.yaw_rad = in(-3, 3);
  };
  for (int i = 0; i < 5; ++i) {
    place(scene.boxes.emplace_back().object, i);
    place(scene.cylinders.emplace_back().object, 100 + i);
    place(scene.tables.emplace_back().object, 200 + i);
    place(scene.ramps.emplace_back().object, 300 + i);
    place(scene.persons.emplace_back().object, 400 + i);
    place(scene.shelves.emplace_back().object, 500 + i);
  }
  return scene;
}

Vector3d WithinCone(const Vector3d& axis, double half_angle_rad, std::mt19937& random) {
  std::uniform_real_distribution<double> unit(-1.0, 1.0);
  while (true) {
    const Vector3d direction =
        (axis + std::sin(half_angle_rad) * Vector3d(unit(random), unit(random), unit(random)))
            .normalized();
    if (direction.dot(axis) >= std::cos(half_angle_rad)) return direction;
  }
}

TEST(WorldTest, ARayMeetsWhatTheExactCasterMeetsForRandomScenesAndRays) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> unit(-1.0, 1.0);
  int hits = 0;
  for (int scene_number = 0; scene_number < 20; ++scene_number) {
    const SceneConfig scene = RandomScene(random);
    World world(scene);
    for (int place = 0; place < 10; ++place) {
      const Vector3d origin(4 * unit(random), 3 * unit(random), 0.8 + 0.5 * unit(random));
      const Vector3d axis = Vector3d(unit(random), unit(random), 0.3 * unit(random)).normalized();
      world.Aim(origin, {.axis_map = axis, .half_angle_rad = kFov_rad});
      const RayCaster oracle(GeometryAt(scene, 0), origin);
      for (int ray = 0; ray < 100; ++ray) {
        const Vector3d direction = WithinCone(axis, kFov_rad, random);

        const auto found = world.Cast(direction);

        const auto expected = oracle.Cast(direction);
        ASSERT_EQ(found.has_value(), expected.has_value());
        if (!found) continue;
        ++hits;
        ASSERT_NEAR(found->range_m, expected->range_m, 1e-9);
        ASSERT_EQ(found->object, expected->object);
      }
    }
  }
  EXPECT_GT(hits, 15000);
}

OccupancyGrid RandomWalls(double yaw_rad, std::mt19937& random) {
  OccupancyGrid grid;
  grid.geometry = {.width = 40,
                   .height = 30,
                   .resolution_m = 0.2,
                   .origin_x_m = -4.1,
                   .origin_y_m = -2.9,
                   .origin_yaw_rad = yaw_rad};
  std::uniform_int_distribution<int> die(0, 19);
  for (std::size_t i = 0; i < grid.geometry.num_cells(); ++i) {
    const int thrown = die(random);
    grid.cells.push_back(thrown == 0   ? OccupancyGrid::kOccupied
                         : thrown == 1 ? OccupancyGrid::kUnknown
                                       : OccupancyGrid::kFree);
  }
  return grid;
}

// The walls as the boxes that they are meant to be.
SceneGeometry BoxesOf(const MapWalls& walls) {
  SceneGeometry geometry;
  geometry.floor.present = false;
  const GridGeometry& grid = walls.grid.geometry;
  for (int row = 0; row < grid.height; ++row) {
    for (int column = 0; column < grid.width; ++column) {
      if (walls.grid.At({column, row}) != OccupancyGrid::kOccupied) continue;
      const Eigen::Vector2d center = grid.CenterOf({column, row});
      Primitive box;
      box.T_map_local = Eigen::Translation3d(center.x(), center.y(), 0.5 * walls.height_m) *
                        Eigen::AngleAxisd(grid.origin_yaw_rad, Vector3d::UnitZ());
      box.half_extents = 0.5 * Vector3d(grid.resolution_m, grid.resolution_m, walls.height_m);
      box.reflectivity = walls.reflectivity;
      box.object = kMapObject;
      geometry.primitives.push_back(box);
    }
  }
  return geometry;
}

class MapWallsTest : public testing::TestWithParam<double> {};

TEST_P(MapWallsTest, ARayMeetsTheBoxOfTheFirstOccupiedCell) {
  std::mt19937 random(11);
  std::uniform_real_distribution<double> unit(-1.0, 1.0);
  int hits = 0;
  for (int trial = 0; trial < 10; ++trial) {
    const MapWalls walls{.grid = RandomWalls(GetParam(), random), .height_m = 1.5};
    const MapWallCaster caster(walls);
    const SceneGeometry boxes = BoxesOf(walls);
    for (int ray = 0; ray < 300; ++ray) {
      // On the map and around it.
      const CellIndex place{static_cast<int>(20 + 30 * unit(random)),
                            static_cast<int>(15 + 25 * unit(random))};
      const Eigen::Vector2d center = walls.grid.geometry.CenterOf(place);
      const Vector3d origin(
          center.x() + 0.09 * unit(random), center.y() + 0.09 * unit(random), 1.2 + unit(random));
      const auto cell = walls.grid.geometry.CellAt(origin.head<2>());
      if (cell && walls.grid.At(*cell) == OccupancyGrid::kOccupied) continue;
      const Vector3d direction =
          Vector3d(unit(random), unit(random), 0.5 * unit(random)).normalized();

      const auto found = caster.Cast(origin, direction, 100.0);

      const auto expected = RayCaster(boxes, origin).Cast(direction);
      // From below the floor's level a wall's underside would be met: rays do not come from there.
      if (expected && (origin + expected->range_m * direction).z() < 1e-9) continue;
      ASSERT_EQ(found.has_value(), expected.has_value()) << origin << '\n' << direction;
      if (!found) continue;
      ++hits;
      ASSERT_NEAR(found->range_m, expected->range_m, 1e-6);
      // Where two cells' faces meet, either cosine is right.
      if (std::abs(found->incidence_cos - expected->incidence_cos) > 1e-6) continue;
      ASSERT_EQ(found->object, kMapObject);
    }
  }
  EXPECT_GT(hits, 300);
}

INSTANTIATE_TEST_SUITE_P(TurnedMaps, MapWallsTest, testing::Values(0.0, 0.4, 1.0, -2.5));

TEST(WorldTest, TheNearerOfSceneAndMapIsMet) {
  SceneConfig scene;
  SceneBox& box = scene.boxes.emplace_back();
  box.object.name = "box";
  box.object.x_m = 2.0;
  box.length_m = box.width_m = box.height_m = 1.0;
  MapWalls walls;
  walls.grid.geometry = {.width = 10, .height = 1, .resolution_m = 1.0, .origin_y_m = -0.5};
  walls.grid.cells.assign(10, OccupancyGrid::kFree);
  walls.grid.cells[5] = OccupancyGrid::kOccupied;
  World world(scene, walls);
  const Vector3d origin(0.5, 0.0, 0.5);
  const ViewCone ahead{.axis_map = Vector3d::UnitX(), .half_angle_rad = 0.6};

  world.Aim(origin, ahead);

  EXPECT_EQ(world.Cast(Vector3d::UnitX())->object, 0);
  EXPECT_EQ(world.CastFrom({3.0, 0.0, 0.5}, Vector3d::UnitX())->object, kMapObject);
  EXPECT_NEAR(world.CastFrom({3.0, 0.0, 0.5}, Vector3d::UnitX())->range_m, 2.0, 1e-9);
}

TEST(WorldTest, ThingsAppearAndVanishAndComeBackWhenTimeGoesBack) {
  SceneConfig scene;
  SceneBox& box = scene.boxes.emplace_back();
  box.object.name = "sudden";
  box.object.x_m = 2.0;
  box.object.appear_s = 1.0;
  box.object.vanish_s = 2.0;
  World world(scene);
  const Vector3d origin(0.0, 0.0, 0.1);
  const auto sees = [&](std::int64_t time_us) {
    world.MoveTo(time_us);
    world.Aim(origin, {.axis_map = Vector3d::UnitX(), .half_angle_rad = 0.6});
    return world.Cast(Vector3d::UnitX()).has_value();
  };

  EXPECT_FALSE(sees(999'999));
  EXPECT_TRUE(sees(1'000'000));
  EXPECT_FALSE(sees(2'000'000));
  EXPECT_TRUE(sees(1'500'000));
}

TEST(WorldTest, TheNormalOfAFacePointsTowardsTheRay) {
  SceneConfig scene;
  SceneBox& box = scene.boxes.emplace_back();
  box.object.name = "box";
  box.object.x_m = 2.0;
  box.object.yaw_rad = 0.5;
  const World world(scene);
  const Vector3d face = Eigen::AngleAxisd(0.5, Vector3d::UnitZ()) * Vector3d::UnitX();
  const Vector3d on_face = Vector3d(2.0, 0.0, 0.15) - 0.15 * face;

  const Vector3d normal = world.NormalAt(on_face, Vector3d::UnitX(), 0);

  EXPECT_NEAR((normal + face).norm(), 0.0, 1e-9);
}

}  // namespace
}  // namespace clearway::core
