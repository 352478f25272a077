// SPDX-License-Identifier: BSD-3-Clause
#include "common/core/simulation/simulated_lidar.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <set>
#include <vector>

#include <gtest/gtest.h>

#include "common/core/simulation/mid70_pattern.hpp"
#include "common/core/simulation/truth_tally.hpp"

namespace clearway::core {
namespace {

using Eigen::Isometry3d;
using Eigen::Vector3d;
using livox::ReturnMode;

constexpr std::size_t kPacket = 96;

Isometry3d At(double x_m, double z_m) {
  Isometry3d T = Isometry3d::Identity();
  T.translation() = Vector3d(x_m, 0.0, z_m);
  return T;
}

// A wall across the way, seen from x = 0.
SceneConfig WallAt(double x_m, Material material = Material::kDiffuse) {
  SceneConfig scene;
  scene.floor.present = false;
  SceneWall& wall = scene.walls.emplace_back();
  wall.name = "wall";
  wall.x1_m = wall.x2_m = x_m + 0.05;
  wall.y1_m = -50.0;
  wall.y2_m = 50.0;
  wall.height_m = 60.0;
  wall.material = material;
  return scene;
}

std::vector<SimulatedShot> FireInto(const SceneConfig& scene,
                                    std::size_t count,
                                    ReturnMode mode = ReturnMode::kFirst,
                                    const SimulatedLidarConfig& config = {},
                                    const Isometry3d& T_map_sensor = At(0.0, 30.0)) {
  World world(scene);
  const SimulatedLidar lidar(config, 5);
  std::vector<SimulatedShot> shots(count);
  lidar.Fire(world, 0, T_map_sensor, 0, mode, shots);
  return shots;
}

double RangeOf(const SimulatedEcho& echo) {
  const livox::WirePoint& p = echo.point_sensor;
  return 0.001 * std::sqrt(double{1} * p.x_mm * p.x_mm + double{1} * p.y_mm * p.y_mm +
                           double{1} * p.z_mm * p.z_mm);
}

bool IsReturn(const SimulatedEcho& echo) {
  return echo.point_sensor != livox::WirePoint{};
}

TEST(SimulatedLidarTest, TheSameShotsGiveTheSameEchoesHoweverTheyAreBatched) {
  const SceneConfig scene = WallAt(4.0);
  World world(scene);
  const SimulatedLidar lidar({}, 5);
  std::vector<SimulatedShot> whole(kPacket);
  lidar.Fire(world, 0, At(0, 30), 1000, ReturnMode::kDual, whole);

  for (const std::size_t batch : {1U, 7U, 48U}) {
    std::vector<SimulatedShot> shots(batch);
    for (std::size_t from = 0; from + batch <= kPacket; from += batch) {
      lidar.Fire(
          world, 0, At(0, 30), 1000 + static_cast<std::int64_t>(from), ReturnMode::kDual, shots);
      for (std::size_t i = 0; i < batch; ++i) {
        for (const std::size_t echo : {0U, 1U}) {
          ASSERT_EQ(shots[i].echoes[echo].point_sensor, whole[from + i].echoes[echo].point_sensor);
        }
      }
    }
  }
}

TEST(SimulatedLidarTest, RangeNoiseIsNormalWithTheConfiguredDeviation) {
  const auto shots = FireInto(WallAt(10.0), 20000);

  double sum = 0.0;
  double sum2 = 0.0;
  for (std::size_t i = 0; i < shots.size(); ++i) {
    const double true_m = 10.0 / Mid70Direction(static_cast<std::int64_t>(i)).x();
    const double error_m = RangeOf(shots[i].echoes[0]) - true_m;
    sum += error_m;
    sum2 += error_m * error_m;
  }
  const auto n = static_cast<double>(shots.size());
  // Three standard errors of the mean, and of the deviation.
  EXPECT_NEAR(sum / n, 0.0, 3 * 0.02 / std::sqrt(n));
  EXPECT_NEAR(std::sqrt(sum2 / n), 0.02, 3 * 0.02 / std::sqrt(2 * n));
}

TEST(SimulatedLidarTest, WhatIsTooNearReturnsNothing) {
  const auto shots = FireInto(WallAt(0.045), 2000);

  int seen = 0;
  for (std::size_t i = 0; i < shots.size(); ++i) {
    const double range_m = 0.045 / Mid70Direction(static_cast<std::int64_t>(i)).x();
    EXPECT_EQ(IsReturn(shots[i].echoes[0]), range_m >= 0.05);
    seen += IsReturn(shots[i].echoes[0]) ? 1 : 0;
  }
  EXPECT_GT(seen, 10);
  EXPECT_LT(seen, 1990);
}

TEST(SimulatedLidarTest, ABlackWallIsSeenNearAndNotFar) {
  const auto is_seen = [](double range_m, double reflectivity) {
    SceneConfig scene = WallAt(range_m);
    scene.walls[0].reflectivity = reflectivity;
    const auto shots = FireInto(scene, 2000);
    // The shot that is nearest to the axis meets the wall head-on.
    std::size_t best = 0;
    for (std::size_t i = 0; i < shots.size(); ++i) {
      const auto x = [](std::size_t k) { return Mid70Direction(static_cast<std::int64_t>(k)).x(); };
      if (x(i) > x(best)) best = i;
    }
    return IsReturn(shots[best].echoes[0]);
  };

  EXPECT_TRUE(is_seen(85.0, 0.1));
  EXPECT_FALSE(is_seen(95.0, 0.1));
  EXPECT_TRUE(is_seen(120.0, 0.2));
  EXPECT_FALSE(is_seen(135.0, 0.2));
  EXPECT_TRUE(is_seen(25.0, 0.01));
  EXPECT_FALSE(is_seen(40.0, 0.01));
}

TEST(SimulatedLidarTest, GlassLetsShotsThroughButForAGlintHeadOn) {
  SceneConfig scene = WallAt(4.0);
  SceneWall glass = scene.walls[0];
  glass.name = "glass";
  glass.x1_m = glass.x2_m = 2.0;
  glass.thickness_m = 0.01;
  glass.material = Material::kGlass;
  scene.walls.push_back(glass);

  const auto shots = FireInto(scene, 20000);

  int glints = 0;
  for (std::size_t i = 0; i < shots.size(); ++i) {
    const double cosine = Mid70Direction(static_cast<std::int64_t>(i)).x();
    if (shots[i].echoes[0].object == 1) {
      ++glints;
      EXPECT_GE(cosine, 0.984);
    } else {
      EXPECT_EQ(shots[i].echoes[0].object, 0);
      EXPECT_LE(cosine, 0.986);
    }
  }
  EXPECT_GT(glints, 100);
}

TEST(SimulatedLidarTest, AGlossyFloorShowsTheWallBelowItself) {
  SceneConfig scene = WallAt(3.0);
  scene.floor.present = true;
  scene.floor.material = Material::kGlossy;

  const auto shots = FireInto(scene, 20000, ReturnMode::kFirst, {}, At(0.0, 0.5));

  int mirrored = 0;
  for (const SimulatedShot& shot : shots) {
    const SimulatedEcho& echo = shot.echoes[0];
    if ((echo.point_sensor.tag & 0x03U) != kMirrorTag) continue;
    ++mirrored;
    // As far below the floor as the wall's point is above it, and on the wall's plane.
    EXPECT_LT(echo.point_sensor.z_mm, -490);
    EXPECT_NEAR(echo.point_sensor.x_mm, 3000, 120);
    EXPECT_EQ(echo.object, 0);
  }
  EXPECT_GT(mirrored, 500);
}

TEST(SimulatedLidarTest, DustReturnsInFrontOfTheWallWithTheTagOfNoise) {
  SceneConfig scene = WallAt(8.0);
  scene.dust.push_back({.x_m = 4.0, .radius_m = 2.0, .height_m = 60.0, .density_per_m = 0.5});

  const auto shots = FireInto(scene, 20000);

  double count = 0.0;
  for (const SimulatedShot& shot : shots) {
    if (shot.echoes[0].object != kDustObject) continue;
    ++count;
    EXPECT_EQ(shot.echoes[0].point_sensor.tag & 0x0CU, kDustTag);
    EXPECT_LT(RangeOf(shot.echoes[0]), 8.0);
  }
  // The way through is up to 4 m: between no share and 1 - exp(-2).
  EXPECT_GT(count / 20000, 0.3);
  EXPECT_LT(count / 20000, 0.87);
}

TEST(SimulatedLidarTest, DualReturnSeesPastAnEdgeAndSingleReturnDoesNot) {
  SceneConfig scene = WallAt(6.0);
  SceneBox& box = scene.boxes.emplace_back();
  box.object.name = "box";
  box.object.x_m = 3.0;
  box.length_m = 0.2;
  box.width_m = 1.0;
  box.height_m = 2.0;
  const auto seconds = [](const std::vector<SimulatedShot>& shots) {
    return std::count_if(
        shots.begin(), shots.end(), [](const auto& shot) { return IsReturn(shot.echoes[1]); });
  };

  const auto dual = FireInto(scene, 50000, ReturnMode::kDual, {}, At(0.0, 1.0));

  EXPECT_GT(seconds(dual), 20);
  EXPECT_EQ(seconds(FireInto(scene, 50000, ReturnMode::kFirst, {}, At(0.0, 1.0))), 0);
  for (const SimulatedShot& shot : dual) {
    if (!IsReturn(shot.echoes[1])) continue;
    // The box is object 1: walls come first.
    EXPECT_EQ(shot.echoes[0].object, 1);
    EXPECT_EQ(shot.echoes[1].object, 0);
    EXPECT_EQ(shot.echoes[1].point_sensor.tag & 0x30U, kSecondEchoTag);
  }
}

// Share of the cells of 0.28 deg in azimuth and elevation, inside the pattern's circle, that are
// hit.
double CoverageAfter(std::int64_t shots) {
  constexpr double kCell_deg = 0.28;
  constexpr double kRadius_deg = 35.2;
  constexpr double kDegrees = 180.0 / std::numbers::pi;
  std::set<std::pair<long, long>> hit;
  for (std::int64_t shot = 0; shot < shots; ++shot) {
    const Vector3d d = Mid70Direction(shot);
    const double azimuth_deg = std::atan2(d.y(), d.x()) * kDegrees;
    const double elevation_deg = std::asin(d.z()) * kDegrees;
    hit.emplace(std::lround(azimuth_deg / kCell_deg), std::lround(elevation_deg / kCell_deg));
  }
  std::set<std::pair<long, long>> inside;
  const auto most = static_cast<long>(kRadius_deg / kCell_deg) + 10;
  for (long a = -most; a <= most; ++a) {
    for (long e = -most; e <= most; ++e) {
      const double cosine = std::cos(static_cast<double>(a) * kCell_deg / kDegrees) *
                            std::cos(static_cast<double>(e) * kCell_deg / kDegrees);
      if (std::acos(cosine) * kDegrees <= kRadius_deg) inside.emplace(a, e);
    }
  }
  const auto covered = std::count_if(
      inside.begin(), inside.end(), [&hit](const auto& cell) { return hit.contains(cell); });
  return 100.0 * static_cast<double>(covered) / static_cast<double>(inside.size());
}

TEST(SimulatedLidarTest, TheRosetteCoversTheFieldAsTheVendorsRaysDo) {
  EXPECT_NEAR(CoverageAfter(10'000), 10.6, 1.0);
  EXPECT_NEAR(CoverageAfter(20'000), 20.0, 1.0);
  EXPECT_NEAR(CoverageAfter(40'000), 36.0, 1.0);
  EXPECT_NEAR(CoverageAfter(100'000), 70.0, 1.0);
}

TEST(TruthTallyTest, CountsTheRaysAboveTheFloorsTolerance) {
  SceneConfig scene;
  SceneBox& box = scene.boxes.emplace_back();
  box.object.name = "box";
  box.object.x_m = 2.0;
  box.length_m = box.width_m = box.height_m = 0.5;
  World world(scene);
  const SimulatedLidar lidar({}, 5);
  TruthTally tally(1, {.period_us = 100'000, .first_begin_us = 0, .floor_tolerance_m = 0.05});
  std::vector<SimulatedShot> shots(10'000);
  const Isometry3d T_map_sensor = At(0.0, 0.3);
  lidar.Fire(world, 0, T_map_sensor, 0, ReturnMode::kFirst, shots);

  tally.Add(T_map_sensor, 250'000, shots);

  std::int32_t expected = 0;
  for (const SimulatedShot& shot : shots) {
    const double z_m = 0.3 + 0.001 * shot.echoes[0].point_sensor.z_mm;
    if (shot.echoes[0].object == 0 && z_m > 0.05) ++expected;
  }
  EXPECT_GT(expected, 100);
  EXPECT_EQ(tally.TakeScan(100'000)[0].points, 0);
  const RayTally rays = tally.TakeScan(200'000)[0];
  EXPECT_EQ(rays.points, expected);
  EXPECT_EQ(rays.first_ray_us, 250'000);
  EXPECT_EQ(tally.TakeScan(200'000)[0].points, 0);
}

TEST(TruthTallyTest, AMirrorImageIsNoRayOnTheObjectAndTwoEchoesOfOneShotAreOneRay) {
  TruthTally tally(1, {});
  SimulatedShot mirrored;
  mirrored.echoes[0] = {.point_sensor = {1000, 0, -500, 50, kMirrorTag}, .object = 0};
  SimulatedShot twice;
  twice.echoes[0] = {.point_sensor = {1000, 0, 500, 50, kFirstEchoTag}, .object = 0};
  twice.echoes[1] = {.point_sensor = {1500, 0, 700, 50, kSecondEchoTag}, .object = 0};

  tally.Add(Isometry3d::Identity(), 10, std::array{mirrored});
  tally.Add(Isometry3d::Identity(), 20, std::array{twice});

  const RayTally rays = tally.TakeScan(0)[0];
  EXPECT_EQ(rays.points, 1);
  EXPECT_EQ(rays.first_ray_us, 20);
}

}  // namespace
}  // namespace clearway::core
