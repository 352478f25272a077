// SPDX-License-Identifier: BSD-3-Clause
#include <cmath>
#include <tuple>

#include <gtest/gtest.h>

#include "common/core/perception/floor/floor_finder.hpp"
#include "tests/support/recorded_scan.hpp"
#include "tests/unit/perception/floor_scenes.hpp"

namespace clearway::core {
namespace {

using test::AddFloor;
using test::AddTable;
using test::AddWall;
using test::AngleBetween;
using test::HeightAtOrigin;
using test::kDegree_rad;
using test::kInfinity;
using test::kNan;
using test::kNoise_m;
using test::PlaneOf;
using test::Random;

// A refined plane over some thousand points with 1 cm of noise and clutter beside it.
constexpr double kNormalTolerance_rad = 0.6 * kDegree_rad;
constexpr double kHeightTolerance_m = 0.02;
// PCL stops at 99 % confidence, so the best plane may be missed by some points.
constexpr double kLeastShareOfInliers = 0.95;

std::size_t CountInliers(const PointCloud& cloud, const Plane& plane, double threshold_m) {
  std::size_t count = 0;
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    if (std::fabs(plane.SignedDistance(cloud.Point(i))) <= static_cast<float>(threshold_m)) ++count;
  }
  return count;
}

class FloorFinderTest : public testing::TestWithParam<Backend> {
 protected:
  static std::optional<FloorFit> Find(const PointCloud& cloud, const FloorConfig& config = {}) {
    return MakeFloorFinder(GetParam(), config)->Find(cloud);
  }
};

INSTANTIATE_TEST_SUITE_P(Backends,
                         FloorFinderTest,
                         testing::ValuesIn(test::AllBackends()),
                         test::BackendName);

class FloorFinderPlaneTest
    : public testing::TestWithParam<std::tuple<Backend, double, double, double>> {};

INSTANTIATE_TEST_SUITE_P(TiltAzimuthHeight,
                         FloorFinderPlaneTest,
                         testing::Combine(testing::ValuesIn(test::AllBackends()),
                                          testing::Values(0.0, 3.0, 8.0, 14.0),
                                          testing::Values(0.0, 110.0, 250.0),
                                          testing::Values(-0.2, 0.0, 0.2)));

TEST_P(FloorFinderPlaneTest, FindsThePlaneBetweenWallAndTable) {
  const auto [backend, tilt_deg, azimuth_deg, height_m] = GetParam();
  const Plane truth = PlaneOf(tilt_deg * kDegree_rad, azimuth_deg * kDegree_rad, height_m);
  Random random(31);
  PointCloud cloud;
  AddWall(cloud, 4.0F, 1500, random);
  AddFloor(cloud, truth, 3000, random);
  AddTable(cloud, 800, random);
  const FloorConfig config;

  const auto fit = MakeFloorFinder(backend, config)->Find(cloud);

  ASSERT_TRUE(fit.has_value());
  EXPECT_LE(AngleBetween(fit->plane_vehicle, truth), kNormalTolerance_rad);
  EXPECT_NEAR(HeightAtOrigin(fit->plane_vehicle), height_m, kHeightTolerance_m);
  EXPECT_GE(static_cast<double>(fit->num_inliers),
            kLeastShareOfInliers *
                static_cast<double>(CountInliers(cloud, truth, config.distance_threshold_m)));
}

TEST_P(FloorFinderTest, DescribesItsPlaneTruthfully) {
  Random random(32);
  PointCloud cloud;
  AddFloor(cloud, PlaneOf(5.0 * kDegree_rad, 1.0, 0.1), 2000, random);
  AddWall(cloud, 3.0F, 500, random);
  const FloorConfig config;

  const auto fit = Find(cloud, config);

  ASSERT_TRUE(fit.has_value());
  const Plane& plane = fit->plane_vehicle;
  EXPECT_NEAR(plane.normal.norm(), 1.0F, 1e-6F);
  EXPECT_GT(plane.normal.z(), 0.0F);
  EXPECT_NEAR(fit->tilt_rad, AngleBetween(plane, Plane{}), 1e-6);
  EXPECT_EQ(fit->num_inliers, CountInliers(cloud, plane, config.distance_threshold_m));
  EXPECT_LE(fit->num_inliers, fit->num_candidates);
  EXPECT_LE(fit->num_candidates, cloud.size());
  EXPECT_NEAR(fit->rms_m, kNoise_m, 0.3 * kNoise_m);
}

TEST_P(FloorFinderTest, RefusesATableTopWithoutAFloor) {
  Random random(33);
  PointCloud cloud;
  AddTable(cloud, 3000, random);

  EXPECT_FALSE(Find(cloud).has_value());
}

TEST_P(FloorFinderTest, FindsTheFloorUnderALargerTableTop) {
  Random random(34);
  PointCloud cloud;
  AddTable(cloud, 6000, random);
  AddFloor(cloud, Plane{}, 2000, random);

  const auto fit = Find(cloud);

  ASSERT_TRUE(fit.has_value());
  EXPECT_NEAR(HeightAtOrigin(fit->plane_vehicle), 0.0, kHeightTolerance_m);
  EXPECT_LE(fit->tilt_rad, kNormalTolerance_rad);
}

TEST_P(FloorFinderTest, RefusesAPlaneTooHighOrTooLow) {
  for (const double height_m : {-0.5, -0.3, 0.3, 0.5}) {
    Random random(35);
    PointCloud cloud;
    AddFloor(cloud, PlaneOf(0.0, 0.0, height_m), 3000, random);

    const auto fit = Find(cloud, {.max_tilt_rad = 0.5 * kDegree_rad});

    EXPECT_FALSE(fit.has_value()) << height_m;
  }
}

TEST_P(FloorFinderTest, RefusesAWall) {
  Random random(36);
  PointCloud cloud;
  AddWall(cloud, 2.0F, 3000, random);

  EXPECT_FALSE(Find(cloud, {.min_inliers = 500}).has_value());
}

TEST_P(FloorFinderTest, NeverGivesAPlaneBeyondItsBounds) {
  for (std::uint32_t seed = 1; seed <= 40; ++seed) {
    Random random(seed);
    PointCloud cloud;
    AddFloor(cloud,
             PlaneOf(random.Uniform(0.0, 40.0) * kDegree_rad,
                     random.Uniform(0.0, 6.28),
                     random.Uniform(-1.0, 1.0)),
             1000,
             random);
    const FloorConfig config{.max_tilt_rad = random.Uniform(0.0, 30.0) * kDegree_rad};

    const auto fit = Find(cloud, config);

    if (!fit) continue;
    EXPECT_LE(fit->tilt_rad, config.max_tilt_rad) << seed;
    EXPECT_LE(std::fabs(HeightAtOrigin(fit->plane_vehicle)), config.max_height_offset_m) << seed;
    EXPECT_GE(fit->num_inliers, static_cast<std::size_t>(config.min_inliers)) << seed;
  }
}

TEST_P(FloorFinderTest, GivesALevelPlaneWhenNoTiltIsAllowed) {
  Random random(37);
  PointCloud cloud;
  AddFloor(cloud, PlaneOf(0.0, 0.0, 0.1), 2000, random);
  AddWall(cloud, 2.0F, 2000, random);

  const auto fit = Find(cloud, {.max_tilt_rad = 0.0});

  ASSERT_TRUE(fit.has_value());
  EXPECT_EQ(fit->plane_vehicle.normal, Eigen::Vector3f::UnitZ());
  EXPECT_NEAR(HeightAtOrigin(fit->plane_vehicle), 0.1, kHeightTolerance_m);
  EXPECT_EQ(fit->tilt_rad, 0.0);
}

TEST_P(FloorFinderTest, NeedsTheLeastNumberOfInliers) {
  Random random(38);
  PointCloud cloud;
  for (int i = 0; i < 60; ++i) {
    cloud.Add({static_cast<float>(random.Uniform(-2.0, 2.0)),
               static_cast<float>(random.Uniform(-2.0, 2.0)),
               0.0F});
  }

  EXPECT_TRUE(Find(cloud, {.min_inliers = 60}).has_value());
  EXPECT_FALSE(Find(cloud, {.min_inliers = 61}).has_value());
}

TEST_P(FloorFinderTest, FindsNothingInDegenerateClouds) {
  PointCloud empty;
  PointCloud one;
  one.Add({1.0F, 0.0F, 0.0F});
  PointCloud same_place;
  PointCloud line;
  PointCloud invalid;
  for (int i = 0; i < 200; ++i) {
    same_place.Add({1.0F, 1.0F, 0.0F});
    line.Add({0.05F * static_cast<float>(i), 0.0F, 0.0F});
    invalid.Add({kNan, 0.0F, 0.0F});
    invalid.Add({0.0F, kInfinity, 0.0F});
    invalid.Add({1e30F, -1e30F, 0.0F});
  }

  for (const PointCloud& cloud : {empty, one, same_place, line, invalid}) {
    EXPECT_FALSE(Find(cloud).has_value());
  }
}

TEST_P(FloorFinderTest, IsNotDisturbedByPointsThatAreNoMeasurements) {
  Random random(39);
  PointCloud cloud;
  AddFloor(cloud, Plane{}, 2000, random);
  const auto expected = Find(cloud);
  for (int i = 0; i < 500; ++i) {
    cloud.Add({kNan, kNan, kNan});
    cloud.Add({1e30F, 1e30F, 0.0F});
  }

  const auto fit = Find(cloud);

  ASSERT_TRUE(expected && fit);
  EXPECT_EQ(fit->plane_vehicle.normal, expected->plane_vehicle.normal);
  EXPECT_EQ(fit->plane_vehicle.offset_m, expected->plane_vehicle.offset_m);
}

TEST_P(FloorFinderTest, GivesTheSameFloorEachTime) {
  const PointCloud cloud = test::MakeRoom({.seed = 3});
  const auto finder = MakeFloorFinder(GetParam(), {});

  const auto first = finder->Find(cloud);
  static_cast<void>(finder->Find(test::MakeRoom({.seed = 4})));
  const auto second = finder->Find(cloud);

  ASSERT_TRUE(first && second);
  EXPECT_EQ(first->plane_vehicle.normal, second->plane_vehicle.normal);
  EXPECT_EQ(first->plane_vehicle.offset_m, second->plane_vehicle.offset_m);
  EXPECT_EQ(first->num_inliers, second->num_inliers);
}

TEST_P(FloorFinderTest, FindsNearlyTheSameFloorInAnotherOrderOfPoints) {
  Random random(40);
  const PointCloud cloud = test::MakeRoom({.seed = 5});
  const auto expected = Find(cloud);

  const auto fit = Find(test::Reordered(cloud, test::RandomOrder(random, cloud.size())));

  ASSERT_TRUE(expected && fit);
  EXPECT_LE(AngleBetween(fit->plane_vehicle, expected->plane_vehicle), kNormalTolerance_rad);
  EXPECT_NEAR(fit->plane_vehicle.offset_m, expected->plane_vehicle.offset_m, kHeightTolerance_m);
}

TEST_P(FloorFinderTest, FindsTheFloorOfRealScans) {
  for (const auto& scan : {test::kLivoxHorizon, test::kIndoor28k, test::kKittiFull}) {
    const PointCloud cloud = test::LoadScan(scan, 60.0F);
    if (cloud.empty()) GTEST_SKIP() << test::MissingData(scan.path);

    const auto fit = Find(cloud);

    ASSERT_TRUE(fit.has_value()) << scan.name;
    EXPECT_LE(fit->tilt_rad, 3.0 * kDegree_rad) << scan.name;
    EXPECT_LE(std::fabs(HeightAtOrigin(fit->plane_vehicle)), 0.15) << scan.name;
  }
}

TEST_P(FloorFinderTest, PrintsNothingWhenThereIsNoFloor) {
  PointCloud line;
  for (int i = 0; i < 200; ++i) line.Add({0.05F * static_cast<float>(i), 0.0F, 0.0F});
  Random random(41);
  PointCloud wall;
  AddWall(wall, 2.0F, 1000, random);

  testing::internal::CaptureStderr();
  testing::internal::CaptureStdout();
  static_cast<void>(Find({}));
  static_cast<void>(Find(line));
  static_cast<void>(Find(wall, {.max_tilt_rad = 0.002}));

  EXPECT_EQ(testing::internal::GetCapturedStderr(), "");
  EXPECT_EQ(testing::internal::GetCapturedStdout(), "");
}

}  // namespace
}  // namespace clearway::core
