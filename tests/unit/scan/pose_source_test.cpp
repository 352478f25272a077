// SPDX-License-Identifier: BSD-3-Clause
#include "common/core/geometry/pose_source.hpp"

#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

#include "common/core/geometry/pose_buffer.hpp"

namespace clearway::core {
namespace {

constexpr double kExact = 1e-9;

PoseSourceConfig StartAt(double x_m, double y_m, double yaw_rad) {
  PoseSourceConfig config;
  config.mode = PoseSourceMode::kDeadReckoning;
  config.x_m = x_m;
  config.y_m = y_m;
  config.yaw_rad = yaw_rad;
  return config;
}

// Odometry of a circle of radius 2 m, from an odom frame that has nothing to do with map.
Eigen::Isometry3d OnACircle(double angle_rad) {
  return FromRpy({10.0, -3.0, 0.0}, {0.0, 0.0, 2.0}) *
         FromRpy({2.0 * std::sin(angle_rad), 2.0 - 2.0 * std::cos(angle_rad), 0.0},
                 {0.0, 0.0, angle_rad});
}

TEST(DeadReckoningTest, BeginsAtTheConfiguredPoseWhereverOdometryBegins) {
  const PoseSourceConfig config = StartAt(1.0, 2.0, 0.7);

  EXPECT_TRUE(DeadReckoning(config).Update(OnACircle(1.3)).isApprox(config.Start(), kExact));
}

TEST(DeadReckoningTest, MovesAsOdometryDoesSeenFromTheStart) {
  const PoseSourceConfig config = StartAt(1.0, 2.0, 0.7);
  DeadReckoning dead_reckoning(config);
  static_cast<void>(dead_reckoning.Update(OnACircle(0.0)));

  for (double angle_rad = 0.1; angle_rad < 7.0; angle_rad += 0.1) {
    const Eigen::Isometry3d expected =
        config.Start() * OnACircle(0.0).inverse() * OnACircle(angle_rad);
    EXPECT_TRUE(dead_reckoning.Update(OnACircle(angle_rad)).isApprox(expected, kExact));
  }
}

TEST(DeadReckoningTest, ARestartOfOdometryIsNoMotion) {
  DeadReckoning dead_reckoning(StartAt(1.0, 2.0, 0.7));
  static_cast<void>(dead_reckoning.Update(OnACircle(0.0)));
  const Eigen::Isometry3d before = dead_reckoning.Update(OnACircle(0.5));

  dead_reckoning.OdometryRestarted();
  const Eigen::Isometry3d after = dead_reckoning.Update(Eigen::Isometry3d::Identity());

  EXPECT_TRUE(after.isApprox(before, kExact));
}

TEST(DeadReckoningTest, TheUncertaintyGrowsWithTheWayDriven) {
  PoseSourceConfig config = StartAt(0.0, 0.0, 0.0);
  config.position_drift = 0.1;
  DeadReckoning dead_reckoning(config);
  static_cast<void>(dead_reckoning.Update(OnACircle(0.0)));
  EXPECT_DOUBLE_EQ(dead_reckoning.uncertainty().position_sigma_m, config.position_sigma_m);

  // Once round: the way counts, not the distance from the start.
  constexpr int kSteps = 1000;
  for (int i = 1; i <= kSteps; ++i) {
    static_cast<void>(dead_reckoning.Update(OnACircle(2.0 * std::numbers::pi * i / kSteps)));
  }

  const double way_m = 4.0 * std::numbers::pi;
  const PoseUncertainty uncertainty = dead_reckoning.uncertainty();
  EXPECT_NEAR(uncertainty.position_sigma_m, config.position_sigma_m + 0.1 * way_m, 1e-3);
  EXPECT_NEAR(
      uncertainty.yaw_sigma_rad, config.yaw_sigma_rad + config.yaw_drift_rad_per_m * way_m, 1e-3);
}

TEST(PoseBufferTest, AStandingVehicleHasExactlyItsPoseAtAnyTime) {
  const Eigen::Isometry3d pose = FromRpy({1.1, 2.2, 0.3}, {0.01, 0.02, 0.7});
  PoseBuffer buffer;
  for (int i = 0; i < 5; ++i) buffer.Add(i * 10'000, pose);

  for (std::int64_t utime = 0; utime <= 80'000; utime += 777) {
    EXPECT_EQ(buffer.Lookup(utime)->matrix(), pose.matrix()) << utime;
  }
}

}  // namespace
}  // namespace clearway::core
