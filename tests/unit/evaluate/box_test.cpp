// SPDX-License-Identifier: BSD-3-Clause
#include "tools/evaluate/box.hpp"

#include <cmath>
#include <numbers>
#include <random>

#include <gtest/gtest.h>

#include "tests/unit/evaluate/scenes.hpp"

namespace clearway::evaluate {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr double kRounding_m = 1e-6;  // Footprints are floats, a few metres away.

TEST(BoxTest, ItsFacesBelongToIt) {
  const Box box = test::MakeBox({2.0, 0.0}, {1.0, 0.5, 2.0});

  EXPECT_TRUE(Contains(box, {2.5, 0.25, 2.0}, 0.0));
  EXPECT_FALSE(Contains(box, {2.501, 0.0, 1.0}, 0.0));
  EXPECT_FALSE(Contains(box, {2.0, 0.251, 1.0}, 0.0));
  EXPECT_FALSE(Contains(box, {2.0, 0.0, -0.001}, 0.0));
}

TEST(BoxTest, AMarginMovesAllSixFaces) {
  const Box box = test::MakeBox({0.0, 0.0}, {2.0, 2.0, 2.0});

  for (int i = 0; i < 3; ++i) {
    const Eigen::Vector3d axis = Eigen::Vector3d::Unit(i);
    for (const double sign : {-1.0, 1.0}) {
      const Eigen::Vector3d centre = box.T_F_box.translation();
      EXPECT_TRUE(Contains(box, centre + sign * 1.099 * axis, 0.1));
      EXPECT_FALSE(Contains(box, centre + sign * 1.101 * axis, 0.1));
    }
  }
}

TEST(BoxTest, ANotANumberIsInNoBox) {
  EXPECT_FALSE(Contains(test::MakeBox({0, 0}, {9, 9, 9}), {NAN, 0.0, 1.0}, 0.1));
}

TEST(BoxTest, ContainmentDoesNotChangeWhenBoxAndPointMoveTogether) {
  const Box box = test::MakeBox({1.0, -2.0}, {1.2, 0.6, 1.8}, 0.4);
  const Eigen::Isometry3d T = core::FromRpy({3.0, 1.0, 0.5}, {0.2, -0.1, 2.0});
  std::mt19937 random(20240501);
  std::uniform_real_distribution<double> offset(-1.0, 1.0);
  int inside = 0;

  for (int i = 0; i < 1000; ++i) {
    const Eigen::Vector3d point =
        box.T_F_box.translation() + Eigen::Vector3d(offset(random), offset(random), offset(random));
    EXPECT_EQ(Contains(box, point, 0.1), Contains(Moved(T, box), T * point, 0.1));
    if (Contains(box, point, 0.1)) ++inside;
  }

  EXPECT_GT(inside, 100);
  EXPECT_LT(inside, 900);
}

TEST(BoxTest, TheNearestDistanceIsToTheFace) {
  EXPECT_NEAR(NearestDistance(test::MakeBox({3.0, 0.0}, {1.0, 2.0, 1.0})), 2.5, kRounding_m);
}

TEST(BoxTest, TheNearestDistanceOfATurnedSquareIsToItsCorner) {
  const Box box = test::MakeBox({3.0, 0.0}, {2.0, 2.0, 1.0}, 0.25 * kPi);

  EXPECT_NEAR(NearestDistance(box), 3.0 - std::sqrt(2.0), kRounding_m);
}

TEST(BoxTest, TheNearestDistanceIsZeroAroundTheOrigin) {
  EXPECT_EQ(NearestDistance(test::MakeBox({0.2, 0.0}, {1.0, 1.0, 1.0})), 0.0);
}

TEST(BoxTest, MovingTurnsItsYaw) {
  const Box box = test::MakeBox({1.0, 0.0}, {2.0, 1.0, 1.0}, 0.3);

  const Box moved = Moved(core::FromRpy({0, 0, 0}, {0, 0, 0.5}), box);

  EXPECT_NEAR(Yaw(moved), 0.8, 1e-12);
}

TEST(BoxTest, HeadingsAreComparedModuloAQuarterTurn) {
  constexpr double kTolerance_rad = 1e-12;
  EXPECT_NEAR(QuarterTurnDifference(0.1, 0.0), 0.1, kTolerance_rad);
  EXPECT_NEAR(QuarterTurnDifference(0.0, 0.1), 0.1, kTolerance_rad);
  EXPECT_NEAR(QuarterTurnDifference(0.1 + 0.5 * kPi, 0.0), 0.1, kTolerance_rad);
  EXPECT_NEAR(QuarterTurnDifference(-kPi, kPi - 0.1), 0.1, kTolerance_rad);
  EXPECT_NEAR(QuarterTurnDifference(0.25 * kPi, 0.0), 0.25 * kPi, kTolerance_rad);
}

}  // namespace
}  // namespace clearway::evaluate
