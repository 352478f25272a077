// SPDX-License-Identifier: BSD-3-Clause
#include "common/core/geometry/pose.hpp"

#include <cmath>
#include <limits>
#include <numbers>
#include <optional>
#include <random>

#include <gtest/gtest.h>

#include "common/core/geometry/pose_buffer.hpp"

namespace clearway::core {
namespace {

constexpr double kExact = 1e-9;  // Rounding of doubles of order 10.

// Circle of radius v / w, from the origin along x.
Eigen::Isometry3d OnCircle(double v_mps, double w_radps, double t_s) {
  const double yaw = w_radps * t_s;
  const double r = v_mps / w_radps;
  return FromRpy({r * std::sin(yaw), r * (1.0 - std::cos(yaw)), 0.0}, {0.0, 0.0, yaw});
}

double AngleBetween(const Eigen::Isometry3d& a, const Eigen::Isometry3d& b) {
  return Eigen::AngleAxisd(a.linear().transpose() * b.linear()).angle();
}

PoseBuffer CircleBuffer(double v_mps, double w_radps, std::int64_t period_us) {
  PoseBuffer buffer;
  for (std::int64_t t = 0; t <= 2'000'000; t += period_us) {
    buffer.Add(t, OnCircle(v_mps, w_radps, 1e-6 * static_cast<double>(t)));
  }
  return buffer;
}

TEST(FromRpy, TurnsAboutTheFixedAxesInTheOrderXYZ) {
  const double quarter = std::numbers::pi / 2.0;

  const Eigen::Vector3d rolled_then_yawed =
      FromRpy({1.0, 2.0, 3.0}, {quarter, 0.0, quarter}) * Eigen::Vector3d::UnitY();
  const Eigen::Vector3d pitched = FromRpy({0, 0, 0}, {0.0, 0.1, 0.0}) * Eigen::Vector3d::UnitX();

  // y rolls to z, which the yaw leaves alone.
  EXPECT_TRUE(rolled_then_yawed.isApprox(Eigen::Vector3d(1.0, 2.0, 4.0), kExact));
  EXPECT_LT(pitched.z(), 0.0);
}

TEST(Interpolate, MeetsBothEndsAndTurnsTheShorterWayRound) {
  const Eigen::Isometry3d a = FromRpy({1, 2, 3}, {0.1, -0.2, 3.0});
  const Eigen::Isometry3d b = FromRpy({2, 0, 3}, {0.1, -0.2, -3.0});

  EXPECT_TRUE(Interpolate(a, b, 0.0).isApprox(a, kExact));
  EXPECT_TRUE(Interpolate(a, b, 1.0).isApprox(b, kExact));
  EXPECT_LT(AngleBetween(a, Interpolate(a, b, 0.5)), 0.2);
}

class PoseBufferMotionTest : public testing::TestWithParam<double> {};

TEST_P(PoseBufferMotionTest, FollowsACircleWithinTheSagittaOfTheSamples) {
  const double w = GetParam();
  const double v = 1.5;
  constexpr std::int64_t kPeriod_us = 20'000;
  const PoseBuffer buffer = CircleBuffer(v, w, kPeriod_us);
  // A chord of the arc that is driven in one period misses the arc by r (1 - cos(w T / 2)).
  const double sagitta_m = v / w * (1.0 - std::cos(w * 0.01));
  std::mt19937 random(7);
  std::uniform_int_distribution<std::int64_t> any_time(0, 2'000'000);

  for (int i = 0; i < 500; ++i) {
    const std::int64_t t = any_time(random);
    const std::optional<Eigen::Isometry3d> pose = buffer.Lookup(t);

    ASSERT_TRUE(pose.has_value());
    const Eigen::Isometry3d truth = OnCircle(v, w, 1e-6 * static_cast<double>(t));
    EXPECT_LE((pose->translation() - truth.translation()).norm(), sagitta_m + 1e-6);
    EXPECT_LE(AngleBetween(*pose, truth), 1e-7);
  }
}

TEST_P(PoseBufferMotionTest, CarriesTheMotionOnForFiftyMillisecondsAndNoLonger) {
  const double w = GetParam();
  const PoseBuffer buffer = CircleBuffer(1.5, w, 20'000);

  const std::optional<Eigen::Isometry3d> ahead = buffer.Lookup(2'050'000);

  ASSERT_TRUE(ahead.has_value());
  // Straight on for 0.05 s where the circle bends: v w t^2 / 2, and the chord's half period before.
  const double bend_m = 1.5 * w * 0.06 * 0.06 / 2.0;
  EXPECT_LE((ahead->translation() - OnCircle(1.5, w, 2.05).translation()).norm(), bend_m + 1e-6);
  EXPECT_LE(AngleBetween(*ahead, OnCircle(1.5, w, 2.05)), 1e-7);
  EXPECT_FALSE(buffer.Lookup(2'050'001).has_value());
}

INSTANTIATE_TEST_SUITE_P(TurnRates, PoseBufferMotionTest, testing::Values(0.01, 0.5, 1.5, 3.0));

TEST(PoseBuffer, KnowsNothingBeforeTheOldestPoseAndWhenEmpty) {
  PoseBuffer buffer;
  EXPECT_FALSE(buffer.Lookup(0).has_value());

  buffer.Add(1000, Eigen::Isometry3d::Identity());

  EXPECT_FALSE(buffer.Lookup(999).has_value());
  EXPECT_TRUE(buffer.Lookup(1000).has_value());
  EXPECT_FALSE(buffer.Lookup(1001).has_value()) << "one pose has no speed to carry on with";
}

TEST(PoseBuffer, DoesNotGuessInsideAGap) {
  PoseBuffer buffer;
  buffer.Add(0, Eigen::Isometry3d::Identity());
  buffer.Add(400'000, FromRpy({1, 0, 0}, {0, 0, 0}));

  EXPECT_FALSE(buffer.Lookup(200'000).has_value());
  EXPECT_TRUE(buffer.Lookup(400'000).has_value());
  EXPECT_FALSE(buffer.Lookup(410'000).has_value()) << "the speed over the gap is not a speed";
}

TEST(PoseBuffer, SortsOutStampsThatRepeatOrGoBack) {
  PoseBuffer buffer;
  const Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();

  EXPECT_EQ(buffer.Add(5'000'000, pose), PoseBuffer::Outcome::kAdded);
  EXPECT_EQ(buffer.Add(5'000'000, pose), PoseBuffer::Outcome::kDuplicate);
  EXPECT_EQ(buffer.Add(4'000'000, pose), PoseBuffer::Outcome::kOutOfOrder);
  EXPECT_EQ(buffer.Add(3'999'999, pose), PoseBuffer::Outcome::kRestarted);
  EXPECT_EQ(buffer.size(), 1U);
  EXPECT_EQ(buffer.newest_utime(), 3'999'999);
}

TEST(PoseBuffer, RefusesPosesThatAreNotNumbers) {
  PoseBuffer buffer;
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.translation().y() = std::numeric_limits<double>::quiet_NaN();

  EXPECT_EQ(buffer.Add(1, pose), PoseBuffer::Outcome::kInvalid);
  EXPECT_EQ(buffer.Add(-1, Eigen::Isometry3d::Identity()), PoseBuffer::Outcome::kInvalid);
  EXPECT_EQ(buffer.size(), 0U);
}

TEST(PoseBuffer, StaysBoundedInTimeAndInNumber) {
  PoseBuffer buffer;
  for (std::int64_t t = 0; t < 60'000'000; t += 10'000) {
    buffer.Add(t, Eigen::Isometry3d::Identity());
  }
  EXPECT_LE(buffer.size(), 1001U);

  for (std::int64_t t = 60'000'000; t < 60'050'000; ++t) {
    buffer.Add(t, Eigen::Isometry3d::Identity());
  }
  EXPECT_LE(buffer.size(), PoseBuffer::kMaxPoses);
}

}  // namespace
}  // namespace clearway::core
