// SPDX-License-Identifier: BSD-3-Clause
#include "common/core/simulation/measured_motion.hpp"

#include <cmath>
#include <cstdint>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace clearway::core {
namespace {

constexpr std::int64_t kSecond = 1'000'000;
const PlanarPose kTruth{1.0, 2.0, 0.3};

struct Moments {
  double mean = 0.0;
  double sigma = 0.0;
};

Moments MomentsOf(const std::vector<double>& values) {
  Moments m;
  for (const double v : values) m.mean += v / static_cast<double>(values.size());
  for (const double v : values) {
    m.sigma += (v - m.mean) * (v - m.mean) / static_cast<double>(values.size());
  }
  m.sigma = std::sqrt(m.sigma);
  return m;
}

TEST(PoseErrors, TellsTheTruthWithoutErrors) {
  const MeasuredPose measured = PoseErrors({}, 1).Measure(kTruth, 5 * kSecond);

  EXPECT_EQ(measured.in_map, kTruth);
  EXPECT_EQ(measured.claim, PoseClaim::kGood);
  EXPECT_EQ(measured.delay_us, 0);
  EXPECT_FALSE(measured.is_lost);
}

TEST(PoseErrors, ActFromTheirBeginningUntilBeforeTheirEnd) {
  PoseErrorConfig error;
  error.times = {.from_s = 2.0, .to_s = 3.0};
  error.bias_x_m = 0.5;
  error.bias_yaw_rad = 0.1;
  error.delay_us = 70'000;
  error.claim = PoseClaim::kUncertain;
  const PoseErrors errors({error}, 1);

  EXPECT_EQ(errors.Measure(kTruth, 2 * kSecond - 1).in_map, kTruth);
  EXPECT_EQ(errors.Measure(kTruth, 3 * kSecond).in_map, kTruth);
  EXPECT_EQ(errors.Measure(kTruth, 3 * kSecond).claim, PoseClaim::kGood);
  for (const std::int64_t t : {2 * kSecond, 3 * kSecond - 1}) {
    const MeasuredPose measured = errors.Measure(kTruth, t);
    EXPECT_EQ(measured.in_map, (PlanarPose{1.5, 2.0, 0.4}));
    EXPECT_EQ(measured.delay_us, 70'000);
    EXPECT_EQ(measured.claim, PoseClaim::kUncertain);
  }
}

TEST(PoseErrors, AddUp) {
  PoseErrorConfig a;
  a.bias_x_m = 0.5;
  a.claim = PoseClaim::kUncertain;
  PoseErrorConfig b;
  b.bias_x_m = -0.2;
  b.claim = PoseClaim::kLost;

  const MeasuredPose measured = PoseErrors({a, b}, 1).Measure(kTruth, 0);

  EXPECT_NEAR(measured.in_map.x_m, 1.3, 1e-12);
  EXPECT_EQ(measured.claim, PoseClaim::kLost);
}

TEST(PoseErrors, DriftGrowsFromTheBeginning) {
  PoseErrorConfig error;
  error.times.from_s = 2.0;
  error.drift_mps = 0.1;
  error.drift_toward_rad = 0.5 * M_PI;
  error.drift_radps = 0.02;
  const PoseErrors errors({error}, 1);

  const PlanarPose pose = errors.Measure(kTruth, 7 * kSecond).in_map;

  EXPECT_NEAR(pose.x_m, 1.0, 1e-12);
  EXPECT_NEAR(pose.y_m, 2.5, 1e-12);
  EXPECT_NEAR(pose.yaw_rad, 0.4, 1e-12);
}

// Of 10,000 messages; five standard errors are 0.05 sigma for the mean, 0.035 for sigma.
TEST(PoseErrors, NoiseHasItsStandardDeviationAndNoMean) {
  PoseErrorConfig error;
  error.noise_m = 0.2;
  error.noise_rad = 0.05;
  const PoseErrors errors({error}, 7);
  std::vector<double> x;
  std::vector<double> y;
  std::vector<double> yaw;
  double product = 0.0;
  for (int i = 0; i < 10'000; ++i) {
    const PlanarPose pose = errors.Measure({}, i * 50'000).in_map;
    x.push_back(pose.x_m);
    y.push_back(pose.y_m);
    yaw.push_back(pose.yaw_rad);
    product += pose.x_m * pose.y_m / (0.04 * 10'000.0);
  }

  EXPECT_NEAR(MomentsOf(x).mean, 0.0, 0.05 * 0.2);
  EXPECT_NEAR(MomentsOf(x).sigma, 0.2, 0.035 * 0.2);
  EXPECT_NEAR(MomentsOf(y).sigma, 0.2, 0.035 * 0.2);
  EXPECT_NEAR(MomentsOf(yaw).sigma, 0.05, 0.035 * 0.05);
  EXPECT_NEAR(product, 0.0, 0.05) << "x and y are independent";
}

TEST(PoseErrors, JumpsAtItsTimesOnly) {
  PoseErrorConfig error;
  error.times.from_s = 1.0;
  error.jump_m = 0.5;
  error.jump_every_s = 2.0;
  const PoseErrors errors({error}, 3);
  int jumps = 0;
  PlanarPose before = errors.Measure({}, kSecond).in_map;

  for (std::int64_t t = kSecond; t < 21 * kSecond; t += 50'000) {
    const PlanarPose pose = errors.Measure({}, t).in_map;
    if (pose != before) {
      EXPECT_EQ((t - kSecond) % (2 * kSecond), 0);
      ++jumps;
    }
    before = pose;
  }

  EXPECT_EQ(jumps, 9);
}

TEST(PoseErrors, LosesItsShare) {
  PoseErrorConfig error;
  error.loss = 0.2;
  const PoseErrors errors({error}, 3);
  int lost = 0;

  for (int i = 0; i < 10'000; ++i) lost += errors.Measure({}, i * 50'000).is_lost ? 1 : 0;

  EXPECT_NEAR(lost, 2000, 200) << "five standard deviations";
  error.loss = 1.0;
  EXPECT_TRUE(PoseErrors({error}, 3).Measure({}, 0).is_lost);
}

TEST(PoseErrors, DependOnTheSeed) {
  PoseErrorConfig error;
  error.noise_m = 0.2;

  const PlanarPose pose = PoseErrors({error}, 1).Measure({}, 0).in_map;

  EXPECT_EQ(PoseErrors({error}, 1).Measure({}, 0).in_map, pose);
  EXPECT_NE(PoseErrors({error}, 2).Measure({}, 0).in_map, pose);
}

// A state as if wheels had turned at constant speeds from the beginning.
RobotState WheelsAt(double v_mps, double w_radps, std::int64_t time_us) {
  RobotState state;
  const double time_s = 1e-6 * static_cast<double>(time_us);
  state.in_odom = PlanarPose{}.Moved(v_mps * time_s, w_radps * time_s);
  state.wheel_v_mps = v_mps;
  state.wheel_w_radps = w_radps;
  return state;
}

MeasuredOdometry MeasureFor(OdometryErrors& errors, double v_mps, double w_radps, int steps) {
  MeasuredOdometry measured;
  for (int i = 0; i <= steps; ++i) {
    measured = errors.Measure(WheelsAt(v_mps, w_radps, i * 20'000), i * 20'000);
  }
  return measured;
}

// The chord of 20 ms instead of its arc: shorter by (w dt)^2 / 24.
TEST(OdometryErrors, TellsTheWheelsWithoutErrors) {
  OdometryErrors errors({}, 1);

  const MeasuredOdometry measured = MeasureFor(errors, 0.5, 0.8, 500);

  const PlanarPose wheels = WheelsAt(0.5, 0.8, 10 * kSecond).in_odom;
  EXPECT_NEAR(measured.in_odom.x_m, wheels.x_m, 1e-9);
  EXPECT_NEAR(measured.in_odom.y_m, wheels.y_m, 1e-9);
  EXPECT_NEAR(measured.in_odom.yaw_rad, wheels.yaw_rad, 1e-9);
  EXPECT_EQ(measured.speed, (BaseMotion{0.5, 0.8}));
}

TEST(OdometryErrors, ScaleWhatIsMeasured) {
  OdometryErrorConfig error;
  error.scale = 1.1;
  error.turn_scale = 0.5;
  OdometryErrors straight({error}, 1);
  OdometryErrors turning({error}, 1);

  EXPECT_NEAR(MeasureFor(straight, 0.5, 0.0, 500).in_odom.x_m, 5.5, 1e-9);
  EXPECT_NEAR(MeasureFor(turning, 0.0, 0.8, 500).in_odom.yaw_rad, 4.0, 1e-9);
  EXPECT_NEAR(MeasureFor(straight, 0.5, 0.0, 0).speed.v_mps, 0.55, 1e-12);
}

TEST(OdometryErrors, ScaleOnlyWhatIsDrivenInTheirTimes) {
  OdometryErrorConfig error;
  error.times = {.from_s = 4.0, .to_s = 6.0};
  error.scale = 2.0;
  OdometryErrors errors({error}, 1);

  EXPECT_NEAR(MeasureFor(errors, 0.5, 0.0, 500).in_odom.x_m, 6.0, 1e-9);
}

// Noise of the speed walks into the pose: sigma sqrt(n) dt after n steps.
TEST(OdometryErrors, NoiseOfTheSpeedIsAWalkOfThePose) {
  OdometryErrorConfig error;
  error.noise_mps = 0.1;
  std::vector<double> ends;
  std::vector<double> speeds;
  for (std::uint64_t seed = 0; seed < 1000; ++seed) {
    OdometryErrors errors({error}, seed);
    const MeasuredOdometry measured = MeasureFor(errors, 0.5, 0.0, 100);
    ends.push_back(measured.in_odom.x_m);
    speeds.push_back(measured.speed.v_mps);
  }

  EXPECT_NEAR(MomentsOf(speeds).mean, 0.5, 0.016);
  EXPECT_NEAR(MomentsOf(speeds).sigma, 0.1, 0.0115);
  EXPECT_NEAR(MomentsOf(ends).mean, 1.0, 0.0033);
  EXPECT_NEAR(MomentsOf(ends).sigma, 0.1 * 10.0 * 0.02, 0.0024);
}

TEST(OdometryErrors, LosesAndDelaysMessagesNotMotion) {
  OdometryErrorConfig error;
  error.loss = 1.0;
  error.delay_us = 30'000;
  OdometryErrors errors({error}, 1);

  const MeasuredOdometry measured = MeasureFor(errors, 0.5, 0.0, 500);

  EXPECT_TRUE(measured.is_lost);
  EXPECT_EQ(measured.delay_us, 30'000);
  EXPECT_NEAR(measured.in_odom.x_m, 5.0, 1e-9);
}

TEST(ErrorTimes, MustNotEndBeforeTheyBegin) {
  EXPECT_EQ((ErrorTimes{.from_s = 2.0, .to_s = 2.0}).Validate().size(), 1U);
  EXPECT_TRUE((ErrorTimes{.from_s = 2.0, .to_s = 2.5}).Validate().empty());
  EXPECT_TRUE((ErrorTimes{.from_s = 2.0, .to_s = -1.0}).Validate().empty());
}

}  // namespace
}  // namespace clearway::core
