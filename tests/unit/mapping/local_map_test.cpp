// SPDX-License-Identifier: BSD-3-Clause
#include "common/core/mapping/local_map.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <numeric>
#include <random>
#include <set>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace clearway::core {
namespace {

constexpr std::uint8_t kFree = OccupancyGrid::kFree;
constexpr std::uint8_t kOccupied = OccupancyGrid::kOccupied;
constexpr std::uint8_t kUnknown = OccupancyGrid::kUnknown;

Eigen::Isometry3d MakePose(double x_m, double y_m, double yaw_rad, double tilt_rad = 0.0) {
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.translate(Eigen::Vector3d(x_m, y_m, 0.0));
  pose.rotate(Eigen::AngleAxisd(yaw_rad, Eigen::Vector3d::UnitZ()));
  pose.rotate(Eigen::AngleAxisd(tilt_rad, Eigen::Vector3d(0.6, 0.8, 0.0)));
  return pose;
}

// What LocalMapBuilder::Scan refers to.
struct Scene {
  PointCloud obstacles;
  PointCloud floor;
  std::vector<Eigen::Vector3d> sensors = {{0.0, 0.0, 0.4}};
  Eigen::Isometry3d T_map_vehicle = MakePose(0.513, -0.277, 0.0);

  [[nodiscard]] LocalMap Build(const LocalMapConfig& config = {.radius_m = 3.0}) const {
    return LocalMapBuilder(config).Build({obstacles, floor, sensors, T_map_vehicle});
  }
};

Scene MakeRandomScene(std::mt19937& random, int num_points = 300) {
  std::uniform_real_distribution<float> along(-4.0F, 4.0F);
  std::uniform_real_distribution<float> height(-0.4F, 2.6F);
  std::uniform_real_distribution<double> place(-5.0, 5.0);
  Scene scene;
  for (int i = 0; i < num_points; ++i) {
    scene.obstacles.Add({along(random), along(random), height(random)});
    scene.floor.Add({along(random), along(random), 0.02F * height(random)});
  }
  scene.sensors.emplace_back(0.31, -0.17, 0.6);
  scene.T_map_vehicle = MakePose(place(random), place(random), place(random), 0.05);
  return scene;
}

// The value at a point of the vehicle's frame; unknown off the grid.
std::uint8_t ValueAt(const Scene& scene, const LocalMap& map, double x_m, double y_m) {
  const auto cell =
      map.grid.geometry.CellAt((scene.T_map_vehicle * Eigen::Vector3d(x_m, y_m, 0.0)).head<2>());
  return cell ? map.grid.At(*cell) : kUnknown;
}

PointCloud Shuffled(const PointCloud& cloud, std::mt19937& random) {
  std::vector<std::size_t> order(cloud.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::shuffle(order.begin(), order.end(), random);
  PointCloud shuffled;
  for (const std::size_t i : order) shuffled.AddFrom(cloud, i);
  return shuffled;
}

bool TouchesCell(const Eigen::Vector2d& from, const Eigen::Vector2d& to, const CellIndex& cell) {
  constexpr double kSlack = 1e-3;  // Of a cell.
  const Eigen::AlignedBox2d box(
      Eigen::Vector2d(cell.column - kSlack, cell.row - kSlack),
      Eigen::Vector2d(cell.column + 1.0 + kSlack, cell.row + 1.0 + kSlack));
  const Eigen::AlignedBox2d around(from.cwiseMin(to), from.cwiseMax(to));
  if (!box.intersects(around)) return false;
  bool is_left = false;
  bool is_right = false;
  for (const double x : {box.min().x(), box.max().x()}) {
    for (const double y : {box.min().y(), box.max().y()}) {
      const double side =
          (to.x() - from.x()) * (y - from.y()) - (to.y() - from.y()) * (x - from.x());
      (side >= 0.0 ? is_left : is_right) = true;
    }
  }
  return is_left && is_right;
}

TEST(LocalMap, ARayFreesTheCellsThatItCrossesAndNoOthers) {
  std::mt19937 random(61);
  std::uniform_real_distribution<float> along(-2.0F, 2.0F);
  for (int run = 0; run < 40; ++run) {
    Scene scene;
    scene.sensors = {{0.3 * along(random), 0.3 * along(random), 0.4}};
    scene.T_map_vehicle = MakePose(along(random), along(random), along(random));
    scene.floor.Add({along(random), along(random), 0.0F});

    const OccupancyGrid grid = scene.Build().grid;

    // The ray in cells, to the middle of the point's cell.
    const auto to_cells = [&](const Eigen::Vector3d& point_vehicle) -> Eigen::Vector2d {
      const Eigen::Vector2d origin(grid.geometry.origin_x_m, grid.geometry.origin_y_m);
      return ((scene.T_map_vehicle * point_vehicle).head<2>() - origin) / 0.05;
    };
    const Eigen::Vector2d from = to_cells(scene.sensors[0]);
    const Eigen::Vector2d to = to_cells(scene.floor.Point(0).cast<double>()).array().floor() + 0.5;
    for (int i = 0; i <= 5'000; ++i) {
      const Eigen::Vector2d sample = from + (i / 5'000.0) * (to - from);
      const Eigen::Vector2d inside = sample.array() - sample.array().floor();
      if (inside.minCoeff() < 1e-3 || inside.maxCoeff() > 1.0 - 1e-3) continue;
      ASSERT_EQ(grid.At({static_cast<int>(sample.x()), static_cast<int>(sample.y())}), kFree);
    }
    for (int row = 0; row < grid.geometry.height; ++row) {
      for (int column = 0; column < grid.geometry.width; ++column) {
        if (grid.At({column, row}) == kUnknown) continue;
        ASSERT_TRUE(TouchesCell(from, to, {column, row}));
      }
    }
  }
}

TEST(LocalMap, TheOccupiedCellsAreThoseWithAnObstaclePointInTheBand) {
  std::mt19937 random(62);
  const LocalMapConfig config{.radius_m = 3.0};
  for (int run = 0; run < 10; ++run) {
    const Scene scene = MakeRandomScene(random);

    const OccupancyGrid grid = scene.Build(config).grid;

    std::set<std::size_t> expected;
    for (std::size_t i = 0; i < scene.obstacles.size(); ++i) {
      const Eigen::Vector3d point = scene.obstacles.Point(i).cast<double>();
      if (point.z() < config.z_min_m || point.z() > config.z_max_m) continue;
      const auto cell = grid.geometry.CellAt((scene.T_map_vehicle * point).head<2>());
      if (cell) expected.insert(grid.geometry.IndexOf(*cell));
    }
    std::set<std::size_t> occupied;
    for (std::size_t i = 0; i < grid.cells.size(); ++i) {
      if (grid.cells[i] == kOccupied) occupied.insert(i);
    }
    EXPECT_EQ(occupied, expected);
  }
}

TEST(LocalMap, TheOrderOfPointsAndRepetitionsDoNotMatter) {
  std::mt19937 random(63);
  Scene scene = MakeRandomScene(random);
  scene.sensors[1].z() = 2.5;  // Above the band, where heights of rays matter.
  const OccupancyGrid grid = scene.Build().grid;

  Scene other = scene;
  other.obstacles.Append(scene.obstacles);
  other.obstacles = Shuffled(other.obstacles, random);
  other.floor = Shuffled(other.floor, random);
  std::swap(other.sensors[0], other.sensors[1]);

  EXPECT_EQ(other.Build().grid, grid);
}

TEST(LocalMap, APoseShiftedByWholeCellsShiftsTheGrid) {
  std::mt19937 random(64);
  const LocalMapConfig config{.resolution_m = 0.125, .radius_m = 3.0};  // Exact in binary.
  for (int run = 0; run < 10; ++run) {
    const Scene scene = MakeRandomScene(random);
    Scene shifted = scene;
    shifted.T_map_vehicle.pretranslate(Eigen::Vector3d(-40 * 0.125, 17 * 0.125, 0.0));

    const OccupancyGrid grid = scene.Build(config).grid;
    const OccupancyGrid moved = shifted.Build(config).grid;

    EXPECT_EQ(moved.cells, grid.cells);
    EXPECT_EQ(moved.geometry.origin_x_m, grid.geometry.origin_x_m - 5.0);
    EXPECT_EQ(moved.geometry.origin_y_m, grid.geometry.origin_y_m + 2.125);
  }
}

TEST(LocalMap, TheOriginIsAWholeNumberOfCellsFromThatOfMap) {
  std::mt19937 random(65);
  for (int run = 0; run < 20; ++run) {
    const GridGeometry geometry = MakeRandomScene(random, 5).Build().grid.geometry;

    const double column = geometry.origin_x_m / 0.05;
    const double row = geometry.origin_y_m / 0.05;
    EXPECT_NEAR(column, std::round(column), 1e-9);
    EXPECT_NEAR(row, std::round(row), 1e-9);
    EXPECT_EQ(geometry.origin_yaw_rad, 0.0);
  }
}

TEST(LocalMap, ReachesAsFarAsTheRadiusAlongBothAxes) {
  Scene scene;
  scene.floor.Add({1.0F, 0.0F, 0.0F});

  const GridGeometry geometry = scene.Build().grid.geometry;

  const Eigen::Vector2d vehicle = scene.T_map_vehicle.translation().head<2>();
  for (const double x : {-2.999, 2.999}) {
    for (const double y : {-2.999, 2.999}) {
      EXPECT_TRUE(geometry.CellAt(vehicle + Eigen::Vector2d(x, y)));
    }
  }
  EXPECT_FALSE(geometry.CellAt(vehicle + Eigen::Vector2d(3.051, 0.0)));
  EXPECT_EQ(geometry.width, 121);
  EXPECT_EQ(scene.Build({.resolution_m = 0.1, .radius_m = 1.1}).grid.geometry.width, 23);
}

TEST(LocalMap, ACellIsFreeBeforeAndOccupiedAtAnObstacleAndUnknownBehind) {
  Scene scene;
  scene.obstacles.Add({1.5F, 0.0F, 0.5F});

  const LocalMap map = scene.Build();

  EXPECT_EQ(ValueAt(scene, map, 0.0, 0.0), kFree);
  EXPECT_EQ(ValueAt(scene, map, 1.4, 0.0), kFree);
  EXPECT_EQ(ValueAt(scene, map, 1.5, 0.0), kOccupied);
  EXPECT_EQ(ValueAt(scene, map, 1.6, 0.0), kUnknown);
}

TEST(LocalMap, OccupiedWinsOverARayThatPassesAboveAndOverTheFloor) {
  Scene scene;
  scene.obstacles.Add({1.0F, 0.0F, 0.2F});
  scene.obstacles.Add({2.0F, 0.0F, 1.5F});
  scene.floor.Add({1.0F, 0.0F, 0.0F});

  const LocalMap map = scene.Build();

  EXPECT_EQ(ValueAt(scene, map, 1.0, 0.0), kOccupied);
  EXPECT_EQ(ValueAt(scene, map, 1.5, 0.0), kFree);
  EXPECT_EQ(ValueAt(scene, map, 2.0, 0.0), kOccupied);
}

TEST(LocalMap, PointsBelowTheBandClearAndDoNotOccupy) {
  Scene scene;
  scene.obstacles.Add({1.0F, 0.0F, 0.07F});

  const LocalMap map = scene.Build({.radius_m = 3.0, .z_min_m = 0.1});

  EXPECT_EQ(ValueAt(scene, map, 0.9, 0.0), kFree);
  EXPECT_EQ(ValueAt(scene, map, 1.0, 0.0), kFree);
}

TEST(LocalMap, PointsAboveTheBandOrBelowTheFloorTellNothing) {
  Scene scene;
  scene.obstacles.Add({1.0F, 0.0F, 2.1F});
  scene.obstacles.Add({0.0F, 1.0F, -0.3F});

  const LocalMap map = scene.Build();

  EXPECT_EQ(map.grid.geometry.width, 0);
  EXPECT_TRUE(map.grid.cells.empty());
}

TEST(LocalMap, ASensorAboveTheBandClearsOnlyWhereItsRaysAreLowEnough) {
  Scene scene;
  scene.sensors = {{0.0, 0.0, 3.0}};
  scene.floor.Add({2.5F, 0.0F, 0.5F});      // Comes below 2 m at x = 1 m.
  scene.floor.Add({2.5F, 0.0F, 1.9F});      // Not before x = 2.3 m, in the same cell.
  scene.obstacles.Add({0.0F, 9.0F, 1.5F});  // Only beyond the radius.

  const LocalMap map = scene.Build();

  EXPECT_EQ(ValueAt(scene, map, 0.0, 0.0), kUnknown);
  EXPECT_EQ(ValueAt(scene, map, 0.9, 0.0), kUnknown);
  EXPECT_EQ(ValueAt(scene, map, 1.1, 0.0), kFree);
  EXPECT_EQ(ValueAt(scene, map, 2.5, 0.0), kFree);
  EXPECT_EQ(ValueAt(scene, map, 0.0, 2.9), kUnknown);
}

TEST(LocalMap, ARayToAPointBeyondTheRadiusClearsUpToTheBorder) {
  Scene scene;
  scene.obstacles.Add({9.0F, 0.0F, 1.0F});
  scene.obstacles.Add({3e38F, 3e38F, 1.0F});

  const LocalMap map = scene.Build();

  EXPECT_EQ(ValueAt(scene, map, 2.99, 0.0), kFree);
  EXPECT_EQ(ValueAt(scene, map, 2.9, 2.9), kFree);
  EXPECT_EQ(std::count(map.grid.cells.begin(), map.grid.cells.end(), kOccupied), 0);
}

TEST(LocalMap, RaysStartAtTheNearestSensor) {
  Scene scene;
  scene.sensors = {{-1.0, 0.0, 0.4}, {1.0, 0.0, 0.4}};
  scene.floor.Add({2.0F, 0.0F, 0.0F});

  const LocalMap map = scene.Build();

  EXPECT_EQ(ValueAt(scene, map, 1.5, 0.0), kFree);
  EXPECT_EQ(ValueAt(scene, map, 0.5, 0.0), kUnknown);
  ASSERT_EQ(map.sensor_origins_map.size(), 2U);
  EXPECT_TRUE(map.sensor_origins_map[1].isApprox(Eigen::Vector2d(1.513, -0.277)));
}

TEST(LocalMap, ASensorBeyondTheRadiusSeesIntoTheGrid) {
  Scene scene;
  scene.sensors = {{-5.0, -3.0, 0.4}};
  scene.obstacles.Add({1.0F, 0.0F, 0.5F});

  const LocalMap map = scene.Build();

  EXPECT_EQ(ValueAt(scene, map, -2.9, -1.95), kFree);
  EXPECT_EQ(ValueAt(scene, map, -2.9, -2.9), kUnknown);
  EXPECT_EQ(ValueAt(scene, map, 1.0, 0.0), kOccupied);
  EXPECT_EQ(ValueAt(scene, map, 1.1, 0.05), kUnknown);
}

TEST(LocalMap, OfAnEmptyScanIsEmpty) {
  const LocalMap map = Scene().Build();

  EXPECT_EQ(map.grid.geometry.width, 0);
  EXPECT_EQ(map.grid.geometry.height, 0);
  EXPECT_TRUE(map.grid.cells.empty());
  EXPECT_EQ(map.grid.geometry.resolution_m, 0.05);
  EXPECT_EQ(map.sensor_origins_map.size(), 1U);
}

TEST(LocalMap, WhatIsNotFiniteIsLeftOut) {
  constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
  constexpr float kInfinity = std::numeric_limits<float>::infinity();
  Scene scene;
  scene.obstacles.Add({kNan, 0.0F, 1.0F});
  scene.obstacles.Add({1.0F, 0.0F, kNan});
  scene.floor.Add({kInfinity, 0.0F, 0.0F});
  EXPECT_TRUE(scene.Build().grid.cells.empty());

  scene.obstacles.Add({1.0F, 0.0F, 1.0F});
  scene.sensors = {{static_cast<double>(kNan), 0.0, 0.4}, {1e300, 1e300, 0.4}};
  const LocalMap map = scene.Build();
  EXPECT_EQ(ValueAt(scene, map, 1.0, 0.0), kOccupied);  // Seen, though it is not known from where.
  EXPECT_EQ(ValueAt(scene, map, 0.5, 0.0), kUnknown);

  for (const double bad : {static_cast<double>(kNan), 1e300}) {
    scene.T_map_vehicle.translation().x() = bad;
    EXPECT_TRUE(scene.Build().grid.cells.empty());
  }
}

}  // namespace
}  // namespace clearway::core
