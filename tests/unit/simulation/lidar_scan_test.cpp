// SPDX-License-Identifier: BSD-3-Clause
#include "common/core/simulation/lidar_scan.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "common/core/simulation/mid70_pattern.hpp"
#include "common/core/simulation/noise.hpp"
#include "common/core/simulation/ray_caster.hpp"
#include "common/core/simulation/scene_geometry.hpp"

namespace clearway::core {
namespace {

using testing::Each;
using testing::Gt;

Eigen::Isometry3d At(double x_m, double y_m, double z_m) {
  return Eigen::Isometry3d(Eigen::Translation3d(x_m, y_m, z_m));
}

ScanRequest FromTheDoor() {
  ScanRequest request;
  request.T_map_vehicle = At(0.5, 3.0, 0.0);
  request.T_vehicle_sensor = At(0.0, 0.0, 0.35);
  request.seed = 5;
  return request;
}

SceneConfig Lab() {
  SceneConfig scene;
  scene.rooms = {{.name = "lab"}};
  scene.boxes = {{{.name = "crate", .x_m = 3.0, .y_m = 3.2, .yaw_rad = 0.4}}};
  scene.shelves = {{{.name = "shelf", .x_m = 6.0, .y_m = 5.0}}};
  scene.tables = {{{.name = "table", .x_m = 5.0, .y_m = 1.5}}};
  ScenePerson person;
  person.object.name = "walker";
  person.object.x_m = 4.0;
  person.object.y_m = 2.0;
  person.object.speed_mps = 1.2;
  person.object.loop = true;
  person.object.waypoints = {{4.0, 4.5, 0.0}};
  scene.persons = {person};
  return scene;
}

void ExpectSame(const SimulatedScan& a, const SimulatedScan& b) {
  EXPECT_EQ(a.cloud_sensor.x, b.cloud_sensor.x);
  EXPECT_EQ(a.cloud_sensor.y, b.cloud_sensor.y);
  EXPECT_EQ(a.cloud_sensor.z, b.cloud_sensor.z);
  EXPECT_EQ(a.cloud_sensor.intensity, b.cloud_sensor.intensity);
  EXPECT_EQ(a.objects, b.objects);
  EXPECT_EQ(a.num_returns, b.num_returns);
}

TEST(GenerateScan, HasOnePointAShotInOrder) {
  const SimulatedScan scan = GenerateScan(Lab(), {}, FromTheDoor());

  ASSERT_EQ(scan.cloud_sensor.size(), 10'000U);
  ASSERT_EQ(scan.objects.size(), 10'000U);
  for (std::size_t i = 0; i < scan.cloud_sensor.size(); ++i) {
    ASSERT_EQ(scan.cloud_sensor.time_offset_us[i], static_cast<std::int32_t>(10 * i));
  }
  EXPECT_EQ(scan.num_returns, 10'000U) << "every shot meets something in a closed room";
}

TEST(GenerateScan, PutsEachPointOnTheSurfaceThatItNames) {
  constexpr double kRounding_m = 1e-5;
  const SceneConfig scene = Lab();
  const ScanRequest request = FromTheDoor();
  SimulatedLidarConfig config;
  config.noise_sigma_m = 0.0;

  const SimulatedScan scan = GenerateScan(scene, config, request);

  const Eigen::Isometry3d T_map_sensor = request.T_map_vehicle * request.T_vehicle_sensor;
  for (std::size_t i = 0; i < scan.objects.size(); ++i) {
    const auto time_us = static_cast<std::int64_t>(i) / 100 * 1000;
    const RayCaster caster(GeometryAt(scene, time_us), T_map_sensor.translation());
    const auto hit = caster.Cast(Mid70Direction(static_cast<std::int64_t>(i)));
    ASSERT_TRUE(hit);
    ASSERT_EQ(scan.objects[i], hit->object);
    ASSERT_NEAR(scan.cloud_sensor.Point(i).norm(), hit->range_m, kRounding_m);
  }
}

TEST(GenerateScan, AddsNoiseOfTheStatedSizeAlongTheRay) {
  const ScanRequest request = FromTheDoor();
  SimulatedLidarConfig exact_config;
  exact_config.noise_sigma_m = 0.0;

  const SimulatedScan noisy = GenerateScan(Lab(), {}, request);
  const SimulatedScan exact = GenerateScan(Lab(), exact_config, request);

  double sum = 0.0;
  double sum_of_squares = 0.0;
  double largest_m = 0.0;
  for (std::size_t i = 0; i < noisy.objects.size(); ++i) {
    const Eigen::Vector3f p = noisy.cloud_sensor.Point(i);
    const Eigen::Vector3f q = exact.cloud_sensor.Point(i);
    ASSERT_NEAR(p.normalized().dot(q.normalized()), 1.0F, 1e-6F);
    const double error_m = p.norm() - q.norm();
    sum += error_m;
    sum_of_squares += error_m * error_m;
    largest_m = std::max(largest_m, std::abs(error_m));
  }
  const auto n = static_cast<double>(noisy.objects.size());
  EXPECT_NEAR(sum / n, 0.0, 0.001);
  EXPECT_NEAR(std::sqrt(sum_of_squares / n), 0.02, 0.0006);
  EXPECT_LT(largest_m, 6.0 * 0.02);
  EXPECT_GT(largest_m, 3.0 * 0.02);
}

TEST(GenerateScan, IsTheSameForASeedAndDiffersBetweenSeeds) {
  ScanRequest other = FromTheDoor();
  other.seed = 6;

  const SimulatedScan first = GenerateScan(Lab(), {}, FromTheDoor());
  const SimulatedScan again = GenerateScan(Lab(), {}, FromTheDoor());
  const SimulatedScan different = GenerateScan(Lab(), {}, other);

  ExpectSame(first, again);
  EXPECT_NE(first.cloud_sensor.x, different.cloud_sensor.x);
  EXPECT_EQ(first.objects, different.objects);
}

TEST(GenerateScan, GivesTheSameInOneWindowAsInManyOddOnes) {
  const ScanRequest whole = FromTheDoor();
  const SimulatedScan expected = GenerateScan(Lab(), {}, whole);

  SimulatedScan joined;
  ScanRequest part = whole;
  for (std::int64_t from_us = 0; from_us < whole.duration_us; from_us += 3337) {
    part.begin_us = whole.begin_us + from_us;
    part.duration_us = std::min<std::int64_t>(3337, whole.duration_us - from_us);
    const SimulatedScan scan = GenerateScan(Lab(), {}, part);
    joined.cloud_sensor.Append(scan.cloud_sensor);
    joined.objects.insert(joined.objects.end(), scan.objects.begin(), scan.objects.end());
    joined.num_returns += scan.num_returns;
  }

  ExpectSame(joined, expected);
}

TEST(GenerateScan, GivesZeroReturnsInAnEmptyScene) {
  SceneConfig scene;
  scene.floor.present = false;

  const SimulatedScan scan = GenerateScan(scene, {}, FromTheDoor());

  EXPECT_EQ(scan.cloud_sensor.size(), 10'000U);
  EXPECT_EQ(scan.num_returns, 0U);
  EXPECT_THAT(scan.cloud_sensor.x, Each(0.0F));
  EXPECT_THAT(scan.cloud_sensor.z, Each(0.0F));
  EXPECT_THAT(scan.objects, Each(kNoObject));
}

TEST(GenerateScan, LosesDarkFarAndSlantedSurfaces) {
  SceneConfig scene;
  scene.floor.present = false;
  scene.boxes = {{{.x_m = 51.0, .y_m = 0.0, .z_m = -10.0, .reflectivity = 0.1}, 2.0, 99.0, 99.0}};
  ScanRequest request = FromTheDoor();
  request.T_map_vehicle = At(0.0, 0.0, 0.0);

  const std::size_t near_returns = GenerateScan(scene, {}, request).num_returns;
  scene.boxes[0].object.x_m = 92.0;
  const std::size_t far_returns = GenerateScan(scene, {}, request).num_returns;
  scene.boxes[0].object.x_m = 51.0;
  scene.boxes[0].object.reflectivity = 0.0;
  const std::size_t black_returns = GenerateScan(scene, {}, request).num_returns;

  EXPECT_GT(near_returns, 5'000U);
  EXPECT_EQ(far_returns, 0U);
  EXPECT_EQ(black_returns, 0U);
}

TEST(GenerateScan, ShowsAnObjectOnlyWhileItIsThere) {
  SceneConfig scene = Lab();
  scene.boxes[0].object.appear_s = 0.05;
  const std::int32_t crate = 1;

  const SimulatedScan scan = GenerateScan(scene, {}, FromTheDoor());

  const auto first = std::find(scan.objects.begin(), scan.objects.end(), crate);
  ASSERT_NE(first, scan.objects.end());
  EXPECT_GE(first - scan.objects.begin(), 5'000);
}

TEST(GenerateScan, MovesTheSensorWithTheVehicle) {
  constexpr double kRounding_m = 1e-5;
  SimulatedLidarConfig config;
  config.noise_sigma_m = 0.0;
  ScanRequest moving = FromTheDoor();
  moving.speed_mps = 2.0;
  moving.yaw_rate_radps = 1.0;
  ScanRequest standing = FromTheDoor();
  standing.begin_us = 99'000;
  standing.duration_us = 1'000;
  // After 0.099 s on a circle of 2 m radius.
  const double turn_rad = 0.099;
  standing.T_map_vehicle =
      At(0.5 + 2.0 * std::sin(turn_rad), 3.0 + 2.0 * (1.0 - std::cos(turn_rad)), 0.0);
  standing.T_map_vehicle.rotate(Eigen::AngleAxisd(turn_rad, Eigen::Vector3d::UnitZ()));

  const SimulatedScan scan = GenerateScan(Lab(), config, moving);
  const SimulatedScan last = GenerateScan(Lab(), config, standing);

  ASSERT_EQ(last.cloud_sensor.size(), 100U);
  for (std::size_t i = 0; i < 100; ++i) {
    EXPECT_NEAR((scan.cloud_sensor.Point(9'900 + i) - last.cloud_sensor.Point(i)).norm(),
                0.0F,
                kRounding_m);
  }
}

TEST(GenerateScan, GivesNothingForAnEmptyWindow) {
  ScanRequest request = FromTheDoor();
  request.duration_us = -5;

  EXPECT_TRUE(GenerateScan(Lab(), {}, request).cloud_sensor.empty());
}

TEST(NormalNoise, IsStandardNormal) {
  constexpr int kCount = 100'000;

  int within[3] = {};
  double sum = 0.0;
  for (std::uint64_t i = 0; i < kCount; ++i) {
    const double value = NormalNoise(9, i);
    sum += value;
    for (int k = 0; k < 3; ++k) within[k] += std::abs(value) < k + 1.0 ? 1 : 0;
  }

  EXPECT_NEAR(sum / kCount, 0.0, 0.01);
  EXPECT_NEAR(within[0] / static_cast<double>(kCount), 0.6827, 0.005);
  EXPECT_NEAR(within[1] / static_cast<double>(kCount), 0.9545, 0.003);
  EXPECT_NEAR(within[2] / static_cast<double>(kCount), 0.9973, 0.001);
}

TEST(SplitMix64, GivesTheSameNumbersOnEveryMachine) {
  // First outputs of the reference generator started at 1234567.
  EXPECT_EQ(SplitMix64(1234567ULL), 6457827717110365317ULL);
  EXPECT_EQ(SplitMix64(1234567ULL + 0x9E3779B97F4A7C15ULL), 3203168211198807973ULL);
}

}  // namespace
}  // namespace clearway::core
