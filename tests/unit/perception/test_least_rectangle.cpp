// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

#include "common/core/geometry/least_rectangle.hpp"
#include "tests/unit/perception/scenes.hpp"

namespace clearway::core {
namespace {

using Points = std::vector<Eigen::Vector2f>;
using test::Random;

constexpr double kDegree_rad = std::numbers::pi / 180.0;
constexpr double kRounding_m = 2e-5;  // of float coordinates some 10 m from the origin

struct Extents {
  double u_m = 0.0;
  double v_m = 0.0;
  double Area() const { return u_m * v_m; }
};

Extents ExtentsAt(const Points& points, double angle_rad) {
  const Eigen::Vector2d u(std::cos(angle_rad), std::sin(angle_rad));
  const Eigen::Vector2d v(-u.y(), u.x());
  Eigen::Vector2d low = Eigen::Vector2d::Constant(std::numeric_limits<double>::infinity());
  Eigen::Vector2d high = -low;
  for (const Eigen::Vector2f& point : points) {
    const Eigen::Vector2d local(u.dot(point.cast<double>()), v.dot(point.cast<double>()));
    low = low.cwiseMin(local);
    high = high.cwiseMax(local);
  }
  return {high.x() - low.x(), high.y() - low.y()};
}

void ExpectEncloses(const Rectangle& rectangle, const Points& points) {
  const double yaw_rad = rectangle.yaw_rad;
  const Eigen::Vector2d u(std::cos(yaw_rad), std::sin(yaw_rad));
  const Eigen::Vector2d v(-u.y(), u.x());
  for (const Eigen::Vector2f& point : points) {
    const Eigen::Vector2d from_center = (point - rectangle.center).cast<double>();
    ASSERT_LE(std::fabs(u.dot(from_center)), rectangle.length_m / 2.0 + kRounding_m);
    ASSERT_LE(std::fabs(v.dot(from_center)), rectangle.width_m / 2.0 + kRounding_m);
  }
}

Points RandomBlob(Random& random) {
  Points points;
  const double yaw_rad = random.Uniform(0.0, std::numbers::pi);
  const Eigen::Vector2d u(std::cos(yaw_rad), std::sin(yaw_rad));
  const Eigen::Vector2d v(-u.y(), u.x());
  const double half_length_m = random.Uniform(0.01, 3.0);
  const double half_width_m = random.Uniform(0.01, 1.0);
  const Eigen::Vector2d center(random.Uniform(-10.0, 10.0), random.Uniform(-10.0, 10.0));
  const std::size_t num_points = 1 + random.Index(100);
  for (std::size_t i = 0; i < num_points; ++i) {
    const double along_m = random.Uniform(-half_length_m, half_length_m);
    const double across_m = random.Uniform(-half_width_m, half_width_m);
    points.emplace_back((center + along_m * u + across_m * v).cast<float>());
  }
  return points;
}

TEST(SweepLeastRectangleTest, EnclosesAllPointsWithTheLongerSideAlongYaw) {
  for (std::uint32_t seed = 1; seed <= 300; ++seed) {
    Random random(seed);
    const Points points = RandomBlob(random);

    const Rectangle rectangle = SweepLeastRectangle(points);

    SCOPED_TRACE("seed " + std::to_string(seed));
    ExpectEncloses(rectangle, points);
    EXPECT_GE(rectangle.length_m, rectangle.width_m);
    EXPECT_GT(rectangle.yaw_rad, -static_cast<float>(std::numbers::pi / 2.0));
    EXPECT_LE(rectangle.yaw_rad, static_cast<float>(std::numbers::pi / 2.0));
  }
}

TEST(SweepLeastRectangleTest, IsNotLargerThanTheRectangleAtAnyAngleOfTheSweep) {
  for (std::uint32_t seed = 1; seed <= 300; ++seed) {
    Random random(seed);
    const Points points = RandomBlob(random);

    const Rectangle rectangle = SweepLeastRectangle(points);

    const double area_m2 = static_cast<double>(rectangle.length_m) * rectangle.width_m;
    for (int degree = 0; degree < 90; ++degree) {
      const Extents extents = ExtentsAt(points, degree * kDegree_rad);
      const double rounding_m2 = kRounding_m * (extents.u_m + extents.v_m + kRounding_m);
      ASSERT_LE(area_m2, extents.Area() + rounding_m2) << "seed " << seed << ", " << degree;
    }
  }
}

// Turning the finest rectangle L x W by the half degree that the sweep may be off gives one of
// (L cos + W sin)(W cos + L sin) around it.
TEST(SweepLeastRectangleTest, ExceedsATenTimesFinerSweepByNoMoreThanTheStepExplains) {
  constexpr double kHalfStep_rad = 0.5 * kDegree_rad;
  for (std::uint32_t seed = 1; seed <= 300; ++seed) {
    Random random(seed);
    const Points points = RandomBlob(random);

    const Rectangle rectangle = SweepLeastRectangle(points);

    Extents finest = ExtentsAt(points, 0.0);
    for (int tenth = 1; tenth < 900; ++tenth) {
      const Extents extents = ExtentsAt(points, 0.1 * tenth * kDegree_rad);
      if (extents.Area() < finest.Area()) finest = extents;
    }
    const double c = std::cos(kHalfStep_rad);
    const double s = std::sin(kHalfStep_rad);
    const double bound_m2 = (finest.u_m * c + finest.v_m * s) * (finest.v_m * c + finest.u_m * s) +
                            kRounding_m * (finest.u_m + finest.v_m + kRounding_m);
    EXPECT_LE(static_cast<double>(rectangle.length_m) * rectangle.width_m, bound_m2)
        << "seed " << seed;
  }
}

class KnownRectangleTest : public testing::TestWithParam<int> {};

INSTANTIATE_TEST_SUITE_P(YawDegrees, KnownRectangleTest, testing::Range(-89, 91, 7));

TEST_P(KnownRectangleTest, IsFoundAgain) {
  const double yaw_rad = GetParam() * kDegree_rad;
  const Eigen::Vector2d u(std::cos(yaw_rad), std::sin(yaw_rad));
  const Eigen::Vector2d v(-u.y(), u.x());
  Points corners;
  for (const auto& [a, b] : {std::pair{1, 1}, {1, -1}, {-1, -1}, {-1, 1}}) {
    corners.emplace_back((Eigen::Vector2d(4.0, -2.0) + a * 1.5 * u + b * 0.5 * v).cast<float>());
  }

  const Rectangle rectangle = SweepLeastRectangle(corners);

  EXPECT_NEAR(rectangle.length_m, 3.0, kRounding_m);
  EXPECT_NEAR(rectangle.width_m, 1.0, kRounding_m);
  EXPECT_NEAR(rectangle.yaw_rad, yaw_rad, 1e-6);
  EXPECT_NEAR(rectangle.center.x(), 4.0, kRounding_m);
  EXPECT_NEAR(rectangle.center.y(), -2.0, kRounding_m);
}

TEST(SweepLeastRectangleTest, IsADefaultForNoPointsAndOfNoSizeForOne) {
  const Rectangle none = SweepLeastRectangle({});
  const Rectangle one = SweepLeastRectangle(Points{{3.0F, 4.0F}});

  EXPECT_EQ(none.length_m, 0.0F);
  EXPECT_EQ(one.center, Eigen::Vector2f(3.0F, 4.0F));
  EXPECT_EQ(one.length_m, 0.0F);
  EXPECT_EQ(one.width_m, 0.0F);
}

TEST(SweepLeastRectangleTest, LiesAlongALineOfPoints) {
  Points line;
  for (int i = 0; i <= 10; ++i) {
    line.emplace_back(0.3F * static_cast<float>(i), 0.3F * static_cast<float>(i));
  }

  const Rectangle rectangle = SweepLeastRectangle(line);

  EXPECT_NEAR(rectangle.yaw_rad, std::numbers::pi / 4.0, 1e-6);
  EXPECT_NEAR(rectangle.length_m, 3.0 * std::numbers::sqrt2, kRounding_m);
  EXPECT_NEAR(rectangle.width_m, 0.0, kRounding_m);
}

TEST(SweepLeastRectangleTest, SurvivesHugeCoordinates) {
  const Points points = {{1e30F, 0.0F}, {-1e30F, 1e30F}, {0.0F, -1e30F}};

  const Rectangle rectangle = SweepLeastRectangle(points);

  EXPECT_TRUE(std::isfinite(rectangle.length_m));
  EXPECT_TRUE(std::isfinite(rectangle.center.x()));
}

}  // namespace
}  // namespace clearway::core
