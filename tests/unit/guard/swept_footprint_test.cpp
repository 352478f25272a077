// SPDX-License-Identifier: BSD-3-Clause
#include "common/core/guard/swept_footprint.hpp"

#include <cmath>
#include <limits>
#include <numbers>
#include <random>
#include <vector>

#include <Eigen/Geometry>
#include <gtest/gtest.h>

namespace clearway::core {
namespace {

using Polygon = std::vector<Eigen::Vector2d>;

constexpr double kInfinity = std::numeric_limits<double>::infinity();

double Way(const FreeWay& way, Direction d) {
  return way[static_cast<std::size_t>(d)];
}

struct Robot {
  const char* name;
  Polygon footprint;
};

const Robot kRobots[] = {
    {"rectangle", {{-0.2, -0.2}, {0.3, -0.2}, {0.3, 0.2}, {-0.2, 0.2}}},
    {"hexagon",
     {{-0.3, 0.0}, {-0.15, -0.25}, {0.2, -0.25}, {0.4, 0.0}, {0.2, 0.25}, {-0.15, 0.25}}},
    {"triangle", {{-0.2, -0.3}, {0.5, 0.0}, {-0.2, 0.3}}},
    {"lopsided, axle outside", {{0.1, -0.1}, {0.6, -0.25}, {0.7, 0.3}, {0.15, 0.2}}},
};

// The footprint with `margin` added to both sides: inside when a shift in y of at most the margin
// brings the point into the footprint.
bool IsInsideWidened(const Polygon& footprint, const Eigen::Vector2d& p, double margin) {
  constexpr int kSteps = 50;
  for (int i = -kSteps; i <= kSteps; ++i) {
    if (IsInside(footprint, p + Eigen::Vector2d(0.0, margin * i / kSteps))) return true;
  }
  return false;
}

// Steps the footprint by 1 mm until it covers the point, from where its bounding box meets it.
double SteppedStraight(const Polygon& footprint,
                       const Eigen::Vector2d& p,
                       double margin,
                       int sign) {
  double foremost = -kInfinity;
  double rearmost = kInfinity;
  for (const Eigen::Vector2d& corner : footprint) {
    foremost = std::fmax(foremost, sign * corner.x());
    rearmost = std::fmin(rearmost, sign * corner.x());
  }
  const double first = std::fmax(0.0, sign * p.x() - foremost - 0.002);
  for (double s = first; s <= sign * p.x() - rearmost; s += 0.001) {
    if (IsInsideWidened(footprint, p - Eigen::Vector2d(sign * s, 0.0), margin)) return s;
  }
  return kInfinity;
}

double SteppedTurn(const Polygon& footprint, const Eigen::Vector2d& p, int sign) {
  for (int mrad = 0; mrad <= 6283; ++mrad) {
    if (IsInside(footprint, Eigen::Rotation2Dd(-sign * 0.001 * mrad) * p)) return 0.001 * mrad;
  }
  return kInfinity;
}

class SweptFootprintTest : public testing::TestWithParam<std::size_t> {
 protected:
  const Polygon& footprint() const { return kRobots[GetParam()].footprint; }
};

TEST_P(SweptFootprintTest, AgreesWithAFootprintThatIsMovedStepByStep) {
  constexpr double kMargin_m = 0.05;
  const SweptFootprint swept(footprint(), kMargin_m);
  std::mt19937 random(11);
  std::uniform_real_distribution<double> any(-1.0, 1.0);
  int num_in_the_way = 0;

  for (int i = 0; i < 150; ++i) {
    const Eigen::Vector2d p(2.0 * any(random), 0.5 * any(random));
    if (IsInsideWidened(footprint(), p, 1.05 * kMargin_m)) continue;  // Has rules of its own.
    for (const int sign : {1, -1}) {
      const double exact =
          Way(swept.WayTo(p), sign > 0 ? Direction::kForward : Direction::kBackward);
      const double stepped = SteppedStraight(footprint(), p, kMargin_m, sign);
      if (std::isinf(stepped)) {
        // At the very border of the corridor, the steps of the oracle may miss.
        if (std::isfinite(exact)) {
          EXPECT_TRUE(std::isfinite(SteppedStraight(footprint(), p, 1.01 * kMargin_m, sign)));
        }
        continue;
      }
      ++num_in_the_way;
      ASSERT_TRUE(std::isfinite(exact)) << p.transpose();
      // Steps of 1 mm along, and of 1 mm across on the steepest edge of these robots (1:2.4).
      EXPECT_NEAR(exact, stepped, 0.004) << p.transpose();
    }
  }

  EXPECT_GT(num_in_the_way, 50);
}

TEST_P(SweptFootprintTest, AgreesWithAFootprintThatIsTurnedStepByStep) {
  const SweptFootprint swept(footprint(), 0.0);
  std::mt19937 random(12);
  std::uniform_real_distribution<double> any(-0.9, 0.9);
  int num_in_the_way = 0;

  for (int i = 0; i < 400; ++i) {
    const Eigen::Vector2d p(any(random), any(random));
    for (const int sign : {1, -1}) {
      const double exact =
          Way(swept.WayTo(p), sign > 0 ? Direction::kTurnLeft : Direction::kTurnRight);
      const double stepped = SteppedTurn(footprint(), p, sign);
      if (std::isinf(stepped)) {
        // A corner that the steps just miss sweeps the outermost millimetre.
        if (std::isfinite(exact)) {
          EXPECT_NEAR(p.norm(), swept.turn_radius_m(), 1e-3);
        }
        continue;
      }
      ++num_in_the_way;
      ASSERT_TRUE(std::isfinite(exact)) << p.transpose();
      EXPECT_LE(exact, stepped + 1e-9);
      EXPECT_NEAR(exact, stepped, 0.0011) << p.transpose();
    }
  }

  EXPECT_GT(num_in_the_way, 50);
}

TEST_P(SweptFootprintTest, TurnsNoFurtherWithAMarginThanWithout) {
  const SweptFootprint tight(footprint(), 0.0);
  const SweptFootprint wide(footprint(), 0.07);
  std::mt19937 random(13);
  std::uniform_real_distribution<double> any(-0.9, 0.9);

  for (int i = 0; i < 1000; ++i) {
    const Eigen::Vector2d p(any(random), any(random));
    for (const Direction d : {Direction::kTurnLeft, Direction::kTurnRight, Direction::kForward}) {
      if (Way(tight.WayTo(p), d) > 0.0 || d != Direction::kForward) {
        EXPECT_LE(Way(wide.WayTo(p), d), Way(tight.WayTo(p), d) + 1e-12) << p.transpose();
      }
    }
  }
}

TEST_P(SweptFootprintTest, LeavesNoWayToAPointInsideTheFootprint) {
  const SweptFootprint swept(footprint(), 0.05);
  Eigen::Vector2d middle = Eigen::Vector2d::Zero();
  for (const Eigen::Vector2d& corner : footprint()) middle += corner;
  middle /= static_cast<double>(footprint().size());

  for (const double way : swept.WayTo(middle)) EXPECT_EQ(way, 0.0);
}

INSTANTIATE_TEST_SUITE_P(Robots,
                         SweptFootprintTest,
                         testing::Range(std::size_t{0}, std::size_t{4}));

TEST(SweptFootprint, LetsARobotDriveAlongAWallThatIsNearerThanTheMargin) {
  const SweptFootprint swept(kRobots[0].footprint, 0.05);

  const FreeWay beside = swept.WayTo({0.1, 0.22});
  const FreeWay ahead = swept.WayTo({0.5, 0.22});

  EXPECT_TRUE(std::isinf(Way(beside, Direction::kForward)));
  EXPECT_TRUE(std::isinf(Way(beside, Direction::kBackward)));
  EXPECT_EQ(Way(beside, Direction::kTurnLeft), 0.0);
  EXPECT_NEAR(Way(ahead, Direction::kForward), 0.2, 1e-12);
}

TEST(SweptFootprint, KnowsThatTurningTowardsAPostIsShorterThanAway) {
  const SweptFootprint swept(kRobots[0].footprint, 0.0);

  const FreeWay way = swept.WayTo({0.0, 0.33});  // Left of the axle, within reach of the nose.

  EXPECT_LT(Way(way, Direction::kTurnLeft), std::numbers::pi / 2.0);
  EXPECT_GT(Way(way, Direction::kTurnRight), std::numbers::pi);
  EXPECT_TRUE(std::isinf(Way(swept.WayTo({0.0, 0.5}), Direction::kTurnLeft)));
}

}  // namespace
}  // namespace clearway::core
