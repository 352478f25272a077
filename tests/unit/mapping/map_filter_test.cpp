// SPDX-License-Identifier: BSD-3-Clause
#include "common/core/mapping/map_filter.hpp"

#include <array>
#include <cmath>
#include <limits>
#include <random>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/unit/mapping/random_grid.hpp"

namespace clearway::core {
namespace {

using testing::Each;
using testing::ElementsAre;

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
constexpr float kInfinity = std::numeric_limits<float>::infinity();

const std::vector<Eigen::Vector2d> kFootprint = {{-0.3, -0.2},
                                                 {0.4, -0.2},
                                                 {0.4, 0.2},
                                                 {-0.3, 0.2}};

// Distance to kFootprint, which is a box.
double DistanceToFootprint(double x_m, double y_m) {
  return std::hypot(std::max({-0.3 - x_m, x_m - 0.4, 0.0}), std::max(std::abs(y_m) - 0.2, 0.0));
}

bool IsExplainedByAnyCell(const OccupancyGrid& grid, const CellIndex& cell, double tolerance_m) {
  for (int row = 0; row < grid.geometry.height; ++row) {
    for (int column = 0; column < grid.geometry.width; ++column) {
      if (grid.At({column, row}) != OccupancyGrid::kOccupied) continue;
      const Eigen::Vector2d difference =
          grid.geometry.CenterOf({column, row}) - grid.geometry.CenterOf(cell);
      if (difference.norm() <= tolerance_m + 1e-9) return true;  // Cells are centimetres apart.
    }
  }
  return false;
}

MapVerdict VerdictByAllCells(const MapFilterConfig& config,
                             const Eigen::Vector3d& point_vehicle,
                             const Eigen::Isometry3d& T_map_vehicle,
                             const OccupancyGrid& grid) {
  if (!point_vehicle.allFinite()) return MapVerdict::kInvalid;
  if (point_vehicle.z() < config.z_min_m || point_vehicle.z() > config.z_max_m) {
    return MapVerdict::kOutOfBand;
  }
  if (DistanceToFootprint(point_vehicle.x(), point_vehicle.y()) <= config.near_zone_m) {
    return MapVerdict::kNear;
  }
  const auto cell = grid.geometry.CellAt((T_map_vehicle * point_vehicle).head<2>());
  if (!cell) return MapVerdict::kOffMap;
  if (grid.At(*cell) == OccupancyGrid::kUnknown) return MapVerdict::kUnknown;
  return IsExplainedByAnyCell(grid, *cell, config.tolerance_m) ? MapVerdict::kExplained
                                                               : MapVerdict::kUnexplained;
}

Eigen::Isometry3d MakePose(double x_m, double y_m, double yaw_rad, double tilt_rad = 0.0) {
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.translate(Eigen::Vector3d(x_m, y_m, 0.1));
  pose.rotate(Eigen::AngleAxisd(yaw_rad, Eigen::Vector3d::UnitZ()));
  pose.rotate(Eigen::AngleAxisd(tilt_rad, Eigen::Vector3d(0.6, 0.8, 0.0)));
  return pose;
}

TEST(MapFilter, JudgesAsASearchOverAllOccupiedCellsDoes) {
  std::mt19937 random(51);
  std::uniform_real_distribution<double> place(-1.0, 1.0);
  std::uniform_real_distribution<float> along(-3.0F, 3.0F);
  std::uniform_real_distribution<float> height(-0.2F, 2.4F);
  std::array<int, kNumMapVerdicts> num_of_verdict{};
  for (const double tolerance_m : {0.0, 0.05, 0.1, 0.3}) {
    OccupancyGrid grid = MakeRandomGrid(45, 38, 0.03, 0.15, random);
    grid.geometry.resolution_m = tolerance_m == 0.3 ? 0.1 : 0.05;
    grid.geometry.origin_x_m = place(random) - 1.0;
    grid.geometry.origin_y_m = place(random) - 1.0;
    grid.geometry.origin_yaw_rad = place(random);
    const MapFilterConfig config{.tolerance_m = tolerance_m};
    const Eigen::Isometry3d pose = MakePose(place(random), place(random), 3.0 * place(random), 0.2);
    PointCloud cloud;
    for (int i = 0; i < 400; ++i) cloud.Add({along(random), along(random), height(random)});
    cloud.Add({kNan, 0.0F, 1.0F});

    const auto verdicts = MapFilter(config, kFootprint).Judge(cloud, pose, StaticMap({1, 1}, grid));

    ASSERT_EQ(verdicts.size(), cloud.size());
    for (std::size_t i = 0; i < cloud.size(); ++i) {
      EXPECT_EQ(verdicts[i], VerdictByAllCells(config, cloud.Point(i).cast<double>(), pose, grid));
      ++num_of_verdict[static_cast<std::size_t>(verdicts[i])];
    }
  }
  EXPECT_THAT(num_of_verdict, Each(testing::Gt(0)));
}

// A row of cells of 5 cm along y = 0 .. 0.05 m; the middle one is occupied.
class MapFilterRowTest : public testing::Test {
 protected:
  static constexpr int kMiddle = 20;

  static OccupancyGrid MakeRow(std::uint8_t value = OccupancyGrid::kFree) {
    OccupancyGrid grid = MakeGrid(41, 1, value);
    SetCell(grid, {kMiddle, 0}, OccupancyGrid::kOccupied);
    return grid;
  }

  static MapVerdict JudgeInCell(const MapFilterConfig& config, int column) {
    PointCloud cloud;
    cloud.Add({0.05F * (static_cast<float>(column) + 0.5F), 0.025F, 1.0F});
    return MapFilter(config, {})
        .Judge(cloud, Eigen::Isometry3d::Identity(), StaticMap({1, 1}, MakeRow()))
        .front();
  }
};

TEST_F(MapFilterRowTest, AToleranceOfWholeCellsReachesThatManyCells) {
  for (int cells = 0; cells <= 19; ++cells) {
    const MapFilterConfig config{.tolerance_m = 0.05 * cells};

    EXPECT_EQ(JudgeInCell(config, kMiddle - cells), MapVerdict::kExplained) << cells;
    EXPECT_EQ(JudgeInCell(config, kMiddle + cells), MapVerdict::kExplained) << cells;
    EXPECT_EQ(JudgeInCell(config, kMiddle + cells + 1), MapVerdict::kUnexplained) << cells;
  }
}

TEST_F(MapFilterRowTest, APointInAnUnknownCellIsKeptBesideAnOccupiedOne) {
  PointCloud cloud;
  cloud.Add({0.05F * 21.5F, 0.025F, 1.0F});

  EXPECT_THAT(MapFilter({}, {}).Judge(cloud,
                                      Eigen::Isometry3d::Identity(),
                                      StaticMap({1, 1}, MakeRow(OccupancyGrid::kUnknown))),
              ElementsAre(MapVerdict::kUnknown));
}

TEST(MapFilter, WithoutOccupiedCellsNothingIsExplainedHoweverWideTheTolerance) {
  OccupancyGrid grid = MakeGrid(40, 40);
  grid.geometry.resolution_m = 0.001;  // The widest tolerance is 1000 cells, beyond the field.
  PointCloud cloud;
  cloud.Add({0.02F, 0.02F, 1.0F});

  EXPECT_THAT(MapFilter({.tolerance_m = 1.0}, {})
                  .Judge(cloud, Eigen::Isometry3d::Identity(), StaticMap({1, 1}, grid)),
              ElementsAre(MapVerdict::kUnexplained));
}

TEST(MapFilter, TheFirstReasonCounts) {
  const OccupancyGrid grid = MakeGrid(4, 4, OccupancyGrid::kOccupied);  // 0 .. 0.2 m.
  PointCloud cloud;
  cloud.Add({0.1F, 0.1F, kNan});
  cloud.Add({kInfinity, 0.1F, 9.0F});
  cloud.Add({0.1F, 0.1F, 9.0F});   // Out of the band, in the near zone.
  cloud.Add({0.1F, -0.3F, 1.0F});  // In the near zone, off the map.
  cloud.Add({2.0F, 2.0F, 1.0F});
  cloud.Add({3e38F, -3e38F, 1.0F});

  EXPECT_THAT(MapFilter({}, kFootprint)
                  .Judge(cloud, Eigen::Isometry3d::Identity(), StaticMap({1, 1}, grid)),
              ElementsAre(MapVerdict::kInvalid,
                          MapVerdict::kInvalid,
                          MapVerdict::kOutOfBand,
                          MapVerdict::kNear,
                          MapVerdict::kOffMap,
                          MapVerdict::kOffMap));
}

TEST(MapFilter, TheBandsBordersBelongToTheBand) {
  const OccupancyGrid grid = MakeGrid(4, 4, OccupancyGrid::kOccupied);
  PointCloud cloud;
  for (const float z : {0.24F, 0.25F, 2.0F, 2.01F}) cloud.Add({0.1F, 0.1F, z});

  EXPECT_THAT(MapFilter({.z_min_m = 0.25}, {})
                  .Judge(cloud, Eigen::Isometry3d::Identity(), StaticMap({1, 1}, grid)),
              ElementsAre(MapVerdict::kOutOfBand,
                          MapVerdict::kExplained,
                          MapVerdict::kExplained,
                          MapVerdict::kOutOfBand));
}

TEST(MapFilter, TheNearZoneIsRoundAtTheCornersOfAnyConvexFootprint) {
  OccupancyGrid grid = MakeGrid(100, 100, OccupancyGrid::kOccupied);
  grid.geometry.origin_x_m = grid.geometry.origin_y_m = -2.5;
  const std::vector<Eigen::Vector2d> triangle = {{0.0, 0.0}, {1.0, 0.0}, {0.0, 1.0}};
  const auto is_near = [&](float x, float y, double near_zone_m) {
    PointCloud cloud;
    cloud.Add({x, y, 1.0F});
    return MapFilter({.near_zone_m = near_zone_m}, triangle)
               .Judge(cloud, Eigen::Isometry3d::Identity(), StaticMap({1, 1}, grid))
               .front() == MapVerdict::kNear;
  };

  EXPECT_TRUE(is_near(0.25F, 0.25F, 0.0));  // Inside, with no zone at all.
  EXPECT_FALSE(is_near(0.75F, 0.75F, 0.3));
  EXPECT_TRUE(is_near(0.75F, 0.75F, 0.36));  // 0.354 m from the long side.
  EXPECT_TRUE(is_near(-0.35F, -0.35F, 0.5));
  EXPECT_FALSE(is_near(-0.36F, -0.36F, 0.5));  // In the box around the zone, not in the zone.
}

TEST(MapFilter, APoseThatIsNotFiniteExplainsNothing) {
  const OccupancyGrid grid = MakeGrid(4, 4, OccupancyGrid::kOccupied);
  PointCloud cloud;
  cloud.Add({0.1F, 0.1F, 1.0F});

  EXPECT_THAT(
      MapFilter({}, {}).Judge(cloud, MakePose(std::nan(""), 0.0, 0.0), StaticMap({1, 1}, grid)),
      ElementsAre(MapVerdict::kOffMap));
}

TEST(MapFilter, ATiltedPoseMovesHighPointsInTheMap) {
  OccupancyGrid grid = MakeGrid(40, 1);
  SetCell(grid, {6, 0}, OccupancyGrid::kOccupied);  // x = 0.30 .. 0.35 m.
  Eigen::Isometry3d leaning = Eigen::Isometry3d::Identity();
  leaning.rotate(Eigen::AngleAxisd(0.2, Eigen::Vector3d::UnitY()));
  PointCloud cloud;
  cloud.Add({0.02F, 0.025F, 1.5F});  // 1.5 m * sin(0.2) + 0.02 m * cos(0.2) = 0.318 m.

  EXPECT_THAT(MapFilter({.tolerance_m = 0.0}, {}).Judge(cloud, leaning, StaticMap({1, 1}, grid)),
              ElementsAre(MapVerdict::kExplained));
}

TEST(MapFilter, AnEmptyCloudGivesNoVerdicts) {
  EXPECT_TRUE(MapFilter({}, kFootprint)
                  .Judge({}, Eigen::Isometry3d::Identity(), StaticMap({1, 1}, MakeGrid(1, 1)))
                  .empty());
}

}  // namespace
}  // namespace clearway::core
