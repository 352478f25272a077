// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "common/core/geometry/convex_hull.hpp"
#include "tests/unit/perception/scenes.hpp"

namespace clearway::core {
namespace {

using Points = std::vector<Eigen::Vector2f>;
using test::Random;
using testing::ElementsAre;
using testing::IsEmpty;

double Cross(const Eigen::Vector2f& a, const Eigen::Vector2f& b, const Eigen::Vector2f& c) {
  const Eigen::Vector2d ab = b.cast<double>() - a.cast<double>();
  const Eigen::Vector2d ac = c.cast<double>() - a.cast<double>();
  return ab.x() * ac.y() - ab.y() * ac.x();
}

// Coarse coordinates, so that points repeat and lie on common lines.
Points RandomPoints(Random& random, std::size_t n, double step_m) {
  Points points;
  for (std::size_t i = 0; i < n; ++i) {
    const double x = std::round(random.Uniform(-2.0, 2.0) / step_m) * step_m;
    const double y = std::round(random.Uniform(-1.0, 1.0) / step_m) * step_m;
    points.emplace_back(static_cast<float>(x), static_cast<float>(y));
  }
  return points;
}

class ConvexHullTest : public testing::TestWithParam<double> {};

INSTANTIATE_TEST_SUITE_P(Steps, ConvexHullTest, testing::Values(1e-6, 0.01, 0.25, 1.0));

TEST_P(ConvexHullTest, IsStrictlyConvexAndContainsEveryPoint) {
  for (std::uint32_t seed = 1; seed <= 100; ++seed) {
    Random random(seed);
    const Points points = RandomPoints(random, 3 + random.Index(80), GetParam());

    const Points hull = ConvexHull(points);

    for (std::size_t i = 0; hull.size() >= 3 && i < hull.size(); ++i) {
      const Eigen::Vector2f& a = hull[i];
      const Eigen::Vector2f& b = hull[(i + 1) % hull.size()];
      EXPECT_GT(Cross(a, b, hull[(i + 2) % hull.size()]), 0.0) << "seed " << seed;
      for (const Eigen::Vector2f& p : points) ASSERT_GE(Cross(a, b, p), 0.0) << "seed " << seed;
    }
    for (const Eigen::Vector2f& corner : hull) {
      EXPECT_NE(std::find(points.begin(), points.end(), corner), points.end()) << "seed " << seed;
    }
  }
}

TEST_P(ConvexHullTest, DoesNotDependOnOrderAndRepetition) {
  Random random(61);
  const Points points = RandomPoints(random, 50, GetParam());
  Points other(points.rbegin(), points.rend());
  other.insert(other.end(), points.begin(), points.end());

  EXPECT_EQ(ConvexHull(other), ConvexHull(points));
}

TEST(ConvexHullCasesTest, GoesCounterClockwiseFromTheLeftmostCorner) {
  const Points square = {{1.0F, 1.0F}, {0.0F, 0.0F}, {1.0F, 0.0F}, {0.0F, 1.0F}, {0.5F, 0.5F}};

  EXPECT_THAT(ConvexHull(square),
              ElementsAre(Eigen::Vector2f(0.0F, 0.0F),
                          Eigen::Vector2f(1.0F, 0.0F),
                          Eigen::Vector2f(1.0F, 1.0F),
                          Eigen::Vector2f(0.0F, 1.0F)));
}

TEST(ConvexHullCasesTest, HasFewerThanThreeCornersWhenTheInputIsDegenerate) {
  const Points line = {{2.0F, 2.0F}, {0.0F, 0.0F}, {1.0F, 1.0F}, {3.0F, 3.0F}, {1.0F, 1.0F}};
  const Points place(7, Eigen::Vector2f(3.0F, 4.0F));

  EXPECT_THAT(ConvexHull({}), IsEmpty());
  EXPECT_THAT(ConvexHull(place), ElementsAre(Eigen::Vector2f(3.0F, 4.0F)));
  EXPECT_THAT(ConvexHull(line),
              ElementsAre(Eigen::Vector2f(0.0F, 0.0F), Eigen::Vector2f(3.0F, 3.0F)));
}

TEST(ConvexHullCasesTest, IgnoresPointsThatAreNotFinite) {
  const Points points = {
      {0.0F, 0.0F}, {test::kNan, 0.0F}, {1.0F, 0.0F}, {0.0F, test::kInfinity}, {0.0F, 1.0F}};

  EXPECT_EQ(ConvexHull(points).size(), 3U);
}

TEST(ConvexHullCasesTest, SurvivesHugeCoordinates) {
  const Points points = {
      {1e30F, 0.0F}, {-1e30F, 0.0F}, {0.0F, 1e30F}, {0.0F, -1e30F}, {1.0F, 2.0F}};

  EXPECT_EQ(ConvexHull(points).size(), 4U);
}

TEST(NearestToOriginTest, IsTheOriginInsideTheHull) {
  const Points square = {{-1.0F, -1.0F}, {1.0F, -1.0F}, {1.0F, 1.0F}, {-1.0F, 1.0F}};

  EXPECT_EQ(NearestToOrigin(square), Eigen::Vector2f(0.0F, 0.0F));
}

TEST(NearestToOriginTest, LiesOnAnEdgeOrACorner) {
  const Points ahead = {{2.0F, -1.0F}, {3.0F, -1.0F}, {3.0F, 1.0F}, {2.0F, 1.0F}};
  const Points aside = {{2.0F, 1.0F}, {3.0F, 1.0F}, {3.0F, 2.0F}};
  const Points segment = {{1.0F, -1.0F}, {1.0F, 1.0F}};
  const Points point = {{5.0F, 6.0F}};

  EXPECT_EQ(NearestToOrigin(ahead), Eigen::Vector2f(2.0F, 0.0F));
  EXPECT_EQ(NearestToOrigin(aside), Eigen::Vector2f(2.0F, 1.0F));
  EXPECT_EQ(NearestToOrigin(segment), Eigen::Vector2f(1.0F, 0.0F));
  EXPECT_EQ(NearestToOrigin(point), Eigen::Vector2f(5.0F, 6.0F));
  EXPECT_EQ(NearestToOrigin({}), Eigen::Vector2f(0.0F, 0.0F));
}

TEST(NearestToOriginTest, IsNotFartherThanAnyPointOfTheBorder) {
  constexpr int kSamples = 200;
  constexpr float kRounding_m = 1e-5F;
  for (std::uint32_t seed = 1; seed <= 100; ++seed) {
    Random random(seed);
    Points points = RandomPoints(random, 20, 1e-6);
    for (Eigen::Vector2f& p : points) p += Eigen::Vector2f(3.0F, 1.0F);
    const Points hull = ConvexHull(points);

    const float distance_m = NearestToOrigin(hull).norm();

    float least_m = test::kInfinity;
    for (std::size_t i = 0; i < hull.size(); ++i) {
      const Eigen::Vector2f along = hull[(i + 1) % hull.size()] - hull[i];
      for (int k = 0; k <= kSamples; ++k) {
        const float share = static_cast<float>(k) / kSamples;
        least_m = std::min(least_m, (hull[i] + share * along).norm());
      }
    }
    EXPECT_LE(distance_m, least_m + kRounding_m) << "seed " << seed;
    EXPECT_GE(distance_m, least_m - 0.01F) << "seed " << seed;
  }
}

}  // namespace
}  // namespace clearway::core
