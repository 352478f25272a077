// SPDX-License-Identifier: BSD-3-Clause
#include "common/core/preprocessing/preprocessor.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <random>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "common/core/preprocessing/motion_track.hpp"
#include "tests/unit/scan/visit_check.hpp"

namespace clearway::core {
namespace {

using testing::Each;
using testing::ElementsAre;
using testing::IsEmpty;

constexpr std::int64_t kEpoch_us = 1'600'000'000'000'000;
constexpr std::int64_t kScan_us = 100'000;
constexpr float kFloat_m = 2e-4F;  // Rounding of float coordinates through three transforms.

struct Motion {
  double v_mps = 0.0;
  double w_radps = 0.0;
  Eigen::Vector3d start_odom = Eigen::Vector3d::Zero();

  // T_odom_vehicle, `t_us` after kEpoch_us.
  [[nodiscard]] Eigen::Isometry3d At(std::int64_t t_us) const {
    const double t = 1e-6 * static_cast<double>(t_us);
    const double yaw = w_radps * t;
    Eigen::Vector3d way(v_mps * t, 0.0, 0.0);
    if (w_radps != 0.0) {
      way = v_mps / w_radps * Eigen::Vector3d(std::sin(yaw), 1.0 - std::cos(yaw), 0.0);
    }
    return FromRpy(start_odom + way, {0.0, 0.0, yaw});
  }
};

PoseBuffer Odometry(const Motion& motion, std::int64_t from_us = -200'000) {
  PoseBuffer buffer;
  for (std::int64_t t = from_us; t <= kScan_us; t += 5000) buffer.Add(kEpoch_us + t, motion.At(t));
  return buffer;
}

VehicleConfig Vehicle() {
  VehicleConfig vehicle;
  vehicle.sensors[0].x_m = 0.2;
  vehicle.sensors[0].z_m = 0.4;
  vehicle.sensors[0].yaw_rad = 0.3;
  vehicle.sensors[0].pitch_rad = 0.1;
  return vehicle;
}

AssembledScan MakeScan(const PointCloud& cloud_sensor) {
  AssembledScan scan;
  scan.scan_id = 1;
  scan.utime_start = kEpoch_us;
  scan.utime_end = kEpoch_us + kScan_us;
  scan.complete = true;
  scan.sensors.resize(1);
  scan.sensors[0] = {true, kEpoch_us, kEpoch_us + kScan_us, 1, 0, cloud_sensor};
  return scan;
}

// What a sensor that moves sees of points that stand still in odom, one after the other.
PointCloud Measure(const std::vector<Eigen::Vector3d>& points_odom,
                   const VehicleConfig& vehicle,
                   const Motion& motion) {
  PointCloud cloud;
  const auto n = static_cast<std::int64_t>(points_odom.size());
  for (std::int64_t i = 0; i < n; ++i) {
    const std::int64_t t = kScan_us * i / n;
    const Eigen::Isometry3d T_odom_sensor = motion.At(t) * vehicle.sensors[0].T_vehicle_sensor();
    const Eigen::Vector3d p = T_odom_sensor.inverse() * points_odom[static_cast<std::size_t>(i)];
    cloud.Add(p.cast<float>(), 7, 0, static_cast<std::int32_t>(t));
  }
  return cloud;
}

// A wall across the way, 4 m ahead of the start, well above the floor.
std::vector<Eigen::Vector3d> Wall(const Eigen::Vector3d& start_odom) {
  std::mt19937 random(5);
  std::uniform_real_distribution<double> y(-2.0, 2.0);
  std::uniform_real_distribution<double> z(0.4, 1.6);
  std::vector<Eigen::Vector3d> points;
  for (int i = 0; i < 3000; ++i) {
    points.push_back(start_odom + Eigen::Vector3d(4.013, y(random), z(random)));
  }
  return points;
}

// Largest distance of the obstacles from the wall, in odom.
double WorstOffWall(const PreprocessedScan& scan, const Motion& motion) {
  const Eigen::Isometry3d T_odom_vehicle = motion.At(kScan_us);
  double worst_m = 0.0;
  for (std::size_t i = 0; i < scan.obstacles_vehicle.size(); ++i) {
    const Eigen::Vector3d p =
        T_odom_vehicle * scan.obstacles_vehicle.Point(i).cast<double>() - motion.start_odom;
    worst_m = std::max(worst_m, std::abs(p.x() - 4.013));
  }
  return worst_m;
}

std::size_t Sum(const PointCounts& c) {
  return c.zero + c.invalid + c.out_of_range + c.noise + c.cropped + c.body + c.excluded + c.kept;
}

TEST(PreprocessorConfig, HasDefaultsWithinItsBounds) {
  EXPECT_THAT(test::FaultsOfDefaults<PreprocessorConfig>(), IsEmpty());
  EXPECT_THAT(PreprocessorConfig{}.crop_box.Validate(), IsEmpty());
}

class DeskewTest : public testing::TestWithParam<Motion> {};

TEST_P(DeskewTest, PutsAWallThatIsSeenFromAMovingSensorBackIntoOnePlane) {
  const Motion motion = GetParam();
  const VehicleConfig vehicle = Vehicle();
  const AssembledScan scan = MakeScan(Measure(Wall(motion.start_odom), vehicle, motion));
  const PoseBuffer odometry = Odometry(motion);
  Preprocessor preprocessor({}, vehicle);

  const PreprocessedScan result = preprocessor.Process(scan, {.odometry = &odometry});

  EXPECT_EQ(result.deskew, DeskewState::kDeskewed);
  EXPECT_EQ(result.num_undeskewed, 0U);
  EXPECT_EQ(result.utime, kEpoch_us + kScan_us);
  EXPECT_GT(result.obstacles_vehicle.size(), 1000U);
  // Odometry every 5 ms: the chord of the arc is off by 3 * 2 * 0.005^2 / 8 m.
  EXPECT_LT(WorstOffWall(result, motion), 5e-4);
  EXPECT_THAT(result.obstacles_vehicle.time_offset_us, Each(0));
  EXPECT_THAT(result.obstacles_vehicle.intensity, Each(7));
}

TEST_P(DeskewTest, KeepsEveryPointAndSaysSoWithoutOdometry) {
  const Motion motion = GetParam();
  const VehicleConfig vehicle = Vehicle();
  const AssembledScan scan = MakeScan(Measure(Wall(motion.start_odom), vehicle, motion));
  const PoseBuffer empty;
  Preprocessor preprocessor({}, vehicle);

  for (const PoseBuffer* odometry : {static_cast<const PoseBuffer*>(nullptr), &empty}) {
    const PreprocessedScan result = preprocessor.Process(scan, {.odometry = odometry});

    EXPECT_EQ(result.deskew, DeskewState::kNoOdometry);
    EXPECT_EQ(result.counts.kept, 3000U);
    EXPECT_EQ(result.num_undeskewed, 3000U);
    EXPECT_GT(result.obstacles_vehicle.size(), 1000U);
  }
}

TEST_P(DeskewTest, GivesTheSameCellsFarFromTheOriginOfOdom) {
  Motion near = GetParam();
  near.start_odom.setZero();
  Motion far = near;
  far.start_odom = {123'000.0, -45'000.0, 20.0};  // Multiples of the leaf.
  const VehicleConfig vehicle = Vehicle();
  Preprocessor preprocessor({}, vehicle);
  const PoseBuffer near_odometry = Odometry(near);
  const PoseBuffer far_odometry = Odometry(far);

  const PreprocessedScan a = preprocessor.Process(
      MakeScan(Measure(Wall(near.start_odom), vehicle, near)), {.odometry = &near_odometry});
  const PreprocessedScan b = preprocessor.Process(
      MakeScan(Measure(Wall(far.start_odom), vehicle, far)), {.odometry = &far_odometry});

  EXPECT_LT(WorstOffWall(b, far), 5e-4);
  // A point on a cell's border may fall to either side.
  EXPECT_NEAR(static_cast<double>(a.counts.voxels), static_cast<double>(b.counts.voxels), 10.0);
}

INSTANTIATE_TEST_SUITE_P(Motions,
                         DeskewTest,
                         testing::Values(Motion{0.0, 0.0},
                                         Motion{1.0, 0.0},
                                         Motion{0.0, 1.5},
                                         Motion{1.0, -1.5},
                                         Motion{3.0, 2.0},
                                         Motion{1.0, 0.7, {800.0, -300.0, 0.0}}));

TEST(Deskew, MattersForTheTestAbove) {
  const Motion motion{1.0, 1.5};
  const VehicleConfig vehicle = Vehicle();
  Preprocessor preprocessor({}, vehicle);

  const PreprocessedScan result =
      preprocessor.Process(MakeScan(Measure(Wall({0, 0, 0}), vehicle, motion)), {});

  EXPECT_GT(WorstOffWall(result, motion), 0.1);
}

TEST(Deskew, TakesPointsOfUnknownTimeAsMeasuredAtTheEndAndCountsThem) {
  const Motion motion{1.0, 0.0};
  const VehicleConfig vehicle = Vehicle();
  PointCloud cloud = Measure(Wall({0, 0, 0}), vehicle, motion);
  cloud.time_offset_us[0] = std::numeric_limits<std::int32_t>::max();
  cloud.time_offset_us[1] = std::numeric_limits<std::int32_t>::min();
  const PoseBuffer odometry = Odometry(motion, 50'000);
  Preprocessor preprocessor({}, vehicle);

  const PreprocessedScan result = preprocessor.Process(MakeScan(cloud), {.odometry = &odometry});

  EXPECT_EQ(result.deskew, DeskewState::kDeskewed);
  EXPECT_EQ(result.counts.kept, 3000U);
  // The first half, by rounding to the next sample; the two absurd ones belong to it.
  EXPECT_NEAR(static_cast<double>(result.num_undeskewed), 1500.0, 31.0);
  EXPECT_LT(WorstOffWall(result, motion), 0.101);
}

TEST(Deskew, LeavesTheScanOfAStationarySensorAsItIs) {
  VehicleConfig vehicle = Vehicle();
  vehicle.stationary = true;
  const PoseBuffer moving = Odometry({5.0, 1.0});
  Preprocessor preprocessor({}, vehicle);

  const PreprocessedScan result =
      preprocessor.Process(MakeScan(Measure(Wall({0, 0, 0}), vehicle, {})), {.odometry = &moving});

  EXPECT_EQ(result.deskew, DeskewState::kStationary);
  EXPECT_EQ(result.num_undeskewed, 0U);
  for (std::size_t i = 0; i < result.obstacles_vehicle.size(); ++i) {
    EXPECT_NEAR(result.obstacles_vehicle.x[i], 4.013F, kFloat_m);
  }
}

TEST(MotionTrack, FollowsOdometryToTheEndOfTheScanAndNotBeyond) {
  const Motion motion{1.0, 2.0};
  const PoseBuffer odometry = Odometry(motion);
  const MotionTrack track(odometry, kEpoch_us, kEpoch_us + 99'500, Eigen::Vector3d::Zero());
  const Eigen::Vector3f p(10.0F, 3.0F, 1.0F);

  for (std::int64_t t = 0; t <= 99'500; t += 125) {
    const std::optional<Eigen::Vector3f> local = track.ToLocal(p, kEpoch_us + t);
    ASSERT_TRUE(local.has_value()) << t;
    EXPECT_LT((local->cast<double>() - motion.At(t) * p.cast<double>()).norm(), 1e-4) << t;
  }
  EXPECT_FALSE(track.ToLocal(p, kEpoch_us - 1).has_value());
  EXPECT_FALSE(track.ToLocal(p, kEpoch_us + 99'501).has_value());
}

TEST(MotionTrack, ServesAScanWithoutDuration) {
  const PoseBuffer odometry = Odometry({1.0, 0.0});
  const MotionTrack track(odometry, kEpoch_us, kEpoch_us, Eigen::Vector3d::Zero());

  EXPECT_TRUE(track.ToLocal({1, 2, 3}, kEpoch_us).has_value());
}

TEST(SnapToGrid, IsAMultipleOfTheLeafAtMostHalfALeafAway) {
  std::mt19937 random(9);
  std::uniform_real_distribution<double> any(-1e5, 1e5);
  for (int i = 0; i < 1000; ++i) {
    const Eigen::Vector3d p(any(random), any(random), any(random));
    const Eigen::Vector3d snapped = SnapToGrid(p, 0.05);

    EXPECT_LE((snapped - p).cwiseAbs().maxCoeff(), 0.025 + 1e-9);
    for (int k = 0; k < 3; ++k) {
      EXPECT_NEAR(snapped[k] / 0.05, std::round(snapped[k] / 0.05), 1e-6);
    }
  }
}

// One point for each fate; the sensor sits in the vehicle's origin.
TEST(Preprocessor, CountsEveryPointOnce) {
  constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
  constexpr float kInf = std::numeric_limits<float>::infinity();
  VehicleConfig vehicle;
  vehicle.stationary = true;
  vehicle.sensors[0] = {.x_m = 0.0, .z_m = 0.0, .min_range_m = 0.1, .max_range_m = 50.0};
  vehicle.body = {{0.0, 0.3, -0.1, 0.1, 0.1, 0.4}};
  PreprocessorConfig config;
  config.drop_noise = NoiseFilter::kCertain;
  config.exclusion_zones = {{5.0, 6.0, -1.0, 1.0, 0.0, 2.0}};
  PointCloud cloud;
  cloud.Add({0.0F, 0.0F, 0.0F});
  cloud.Add({-0.0F, 0.0F, -0.0F});
  cloud.Add({kNan, 0.0F, 0.0F});
  cloud.Add({1.0F, kInf, 0.0F});
  cloud.Add({1.0F, 0.0F, 3e38F});
  cloud.Add({0.05F, 0.0F, 0.0F});
  cloud.Add({60.0F, 0.0F, 0.0F});
  cloud.Add({2.0F, 0.0F, 1.0F}, 0, 0b0100);
  cloud.Add({2.0F, 0.0F, 1.0F}, 0, 0b0001);
  cloud.Add({2.0F, 0.0F, 1.0F}, 0, 0b1010);  // Moderate confidence: kept.
  cloud.Add({0.0F, 0.0F, 9.0F});
  cloud.Add({0.2F, 0.0F, 0.2F});
  cloud.Add({5.5F, 0.0F, 1.0F});
  Preprocessor preprocessor(config, vehicle);

  const PreprocessedScan result = preprocessor.Process(MakeScan(cloud), {});

  EXPECT_EQ(result.counts.in, cloud.size());
  EXPECT_EQ(Sum(result.counts), cloud.size());
  EXPECT_EQ(result.counts.zero, 2U);
  EXPECT_EQ(result.counts.invalid, 3U);
  EXPECT_EQ(result.counts.out_of_range, 2U);
  EXPECT_EQ(result.counts.noise, 2U);
  EXPECT_EQ(result.counts.cropped, 1U);
  EXPECT_EQ(result.counts.body, 1U);
  EXPECT_EQ(result.counts.excluded, 1U);
  EXPECT_EQ(result.counts.kept, 1U);
  EXPECT_THAT(result.obstacles_vehicle.z, ElementsAre(1.0F));
}

TEST(Preprocessor, RemovesTheFloorAndMarksWhatLiesBelowIt) {
  VehicleConfig vehicle;
  vehicle.stationary = true;
  vehicle.sensors[0] = {.x_m = 0.0, .z_m = 0.0};
  PointCloud cloud;
  for (int i = 0; i < 60; ++i) {
    for (int k = 0; k < 40; ++k) {
      cloud.Add(
          {1.0F + 0.06F * static_cast<float>(i), -1.2F + 0.06F * static_cast<float>(k), 0.0F});
    }
  }
  for (int k = 0; k < 10; ++k) {
    cloud.Add({2.0F, 0.0F, 0.3F + 0.1F * static_cast<float>(k)});
    cloud.Add({5.0F, 0.1F * static_cast<float>(k), -0.5F});
  }
  Preprocessor preprocessor({}, vehicle);

  const PreprocessedScan result = preprocessor.Process(MakeScan(cloud), {});

  EXPECT_EQ(result.floor.state, FloorState::kFound);
  EXPECT_EQ(result.counts.voxels, result.counts.floor + result.counts.above + result.counts.below);
  EXPECT_EQ(result.counts.above, 10U);
  EXPECT_EQ(result.counts.below, 10U);
  ASSERT_EQ(result.flags.size(), result.obstacles_vehicle.size());
  for (std::size_t i = 0; i < result.flags.size(); ++i) {
    const bool is_below = (result.flags[i] & kFlagBelowFloor) != 0;
    EXPECT_EQ(is_below, result.obstacles_vehicle.z[i] < 0.0F);
  }
}

TEST(Preprocessor, AnswersAnEmptyScanWithAnEmptyResultOfTheSameStamp) {
  Preprocessor preprocessor({}, Vehicle());
  AssembledScan scan = MakeScan({});
  scan.sensors[0].present = false;
  scan.complete = false;
  scan.missing_sensors = {0};

  const PreprocessedScan result = preprocessor.Process(scan, {});

  EXPECT_TRUE(result.obstacles_vehicle.empty());
  EXPECT_EQ(result.utime, scan.utime_end);
  EXPECT_THAT(result.missing_sensors, ElementsAre(0));
  EXPECT_FALSE(result.complete);
}

TEST(Preprocessor, MergesSensorsThatSeeTheSameWallFromTwoPlaces) {
  VehicleConfig vehicle = Vehicle();
  vehicle.sensors.push_back({.name = "left", .x_m = 0.1, .y_m = 0.3, .z_m = 0.8, .yaw_rad = -0.5});
  VehicleConfig second = vehicle;
  second.sensors[0] = vehicle.sensors[1];
  const Motion motion{1.0, 0.5};
  const PoseBuffer odometry = Odometry(motion);
  AssembledScan scan = MakeScan(Measure(Wall({0, 0, 0}), vehicle, motion));
  scan.sensors.push_back(
      {true, kEpoch_us, kEpoch_us + kScan_us, 1, 0, Measure(Wall({0, 0, 0}), second, motion)});
  Preprocessor preprocessor({}, vehicle);

  const PreprocessedScan both = preprocessor.Process(scan, {.odometry = &odometry});
  scan.sensors.pop_back();
  const PreprocessedScan one = preprocessor.Process(scan, {.odometry = &odometry});

  EXPECT_EQ(both.counts.kept, 2 * one.counts.kept);
  EXPECT_LT(WorstOffWall(both, motion), 5e-4);
  EXPECT_NEAR(
      static_cast<double>(both.counts.voxels), static_cast<double>(one.counts.voxels), 60.0);
}

TEST(Preprocessor, GivesTheSameResultForTheSameInput) {
  const Motion motion{1.0, 0.5};
  const VehicleConfig vehicle = Vehicle();
  const PoseBuffer odometry = Odometry(motion);
  const AssembledScan scan = MakeScan(Measure(Wall({0, 0, 0}), vehicle, motion));
  Preprocessor first({}, vehicle);
  Preprocessor second({}, vehicle);

  const PreprocessedScan a = first.Process(scan, {.odometry = &odometry});
  (void)second.Process(MakeScan({}), {});
  const PreprocessedScan b = second.Process(scan, {.odometry = &odometry});

  EXPECT_EQ(a.obstacles_vehicle.x, b.obstacles_vehicle.x);
  EXPECT_EQ(a.obstacles_vehicle.z, b.obstacles_vehicle.z);
  EXPECT_EQ(a.flags, b.flags);
}

}  // namespace
}  // namespace clearway::core
