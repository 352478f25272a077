// SPDX-License-Identifier: BSD-3-Clause
#include "common/core/simulation/flat_shape.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numbers>
#include <vector>

#include <gtest/gtest.h>

namespace clearway::core {
namespace {

using Eigen::Vector2d;

class Random {
 public:
  double Between(double low, double high) {
    state_ = state_ * 6364136223846793005ULL + 1442695040888963407ULL;
    return low + (high - low) * static_cast<double>(state_ >> 11U) * 0x1.0p-53;
  }

 private:
  std::uint64_t state_ = 1;
};

FlatShape RandomPolygon(Random& random) {
  const Vector2d center(random.Between(-1.5, 1.5), random.Between(-1.5, 1.5));
  std::vector<Vector2d> points;
  for (int i = 0; i < 6; ++i) {
    points.emplace_back(center + Vector2d(random.Between(-0.7, 0.7), random.Between(-0.7, 0.7)));
  }
  return MakePolygon(points);
}

bool Holds(const FlatShape& shape, const Vector2d& point) {
  if (shape.corners.size() == 1) return (point - shape.center).norm() <= shape.radius_m;
  for (std::size_t i = 0; i < shape.corners.size(); ++i) {
    const Vector2d edge = shape.corners[(i + 1) % shape.corners.size()] - shape.corners[i];
    const Vector2d way = point - shape.corners[i];
    if (edge.x() * way.y() - edge.y() * way.x() < 0.0) return false;
  }
  return true;
}

// Points along the outline, close together.
std::vector<Vector2d> Outline(const FlatShape& shape) {
  constexpr int kPoints = 200;
  std::vector<Vector2d> points;
  if (shape.corners.size() == 1) {
    for (int i = 0; i < 6 * kPoints; ++i) {
      const double angle = 2.0 * std::numbers::pi * i / (6 * kPoints);
      points.emplace_back(shape.center +
                          shape.radius_m * Vector2d(std::cos(angle), std::sin(angle)));
    }
    return points;
  }
  for (std::size_t c = 0; c < shape.corners.size(); ++c) {
    const Vector2d& a = shape.corners[c];
    const Vector2d& b = shape.corners[(c + 1) % shape.corners.size()];
    for (int i = 0; i < kPoints; ++i) points.emplace_back(a + (b - a) * i / kPoints);
  }
  return points;
}

double BruteForce(const FlatShape& a, const FlatShape& b) {
  double least = std::numeric_limits<double>::infinity();
  const std::vector<Vector2d> outline_b = Outline(b);
  for (const Vector2d& p : Outline(a)) {
    if (Holds(b, p)) return 0.0;
    for (const Vector2d& q : outline_b) least = std::min(least, (p - q).norm());
  }
  for (const Vector2d& q : outline_b) {
    if (Holds(a, q)) return 0.0;
  }
  return least;
}

TEST(FlatShape, MeasuresDistancesAsPointsAlongTheOutlinesDo) {
  Random random;
  int touching = 0;
  for (int i = 0; i < 60; ++i) {
    const FlatShape a = RandomPolygon(random);
    const FlatShape b = i % 3 == 0
                            ? MakeDisc({random.Between(-1.5, 1.5), random.Between(-1.5, 1.5)},
                                       random.Between(0.01, 0.8))
                            : RandomPolygon(random);

    const double distance = Distance(a, b);

    EXPECT_NEAR(distance, BruteForce(a, b), 0.006) << i;
    EXPECT_EQ(distance, Distance(b, a));
    EXPECT_GE(distance, (a.center - b.center).norm() - a.reach_m - b.reach_m - 1e-12);
    if (distance == 0.0) ++touching;
  }
  EXPECT_GT(touching, 5);
  EXPECT_LT(touching, 55);
}

TEST(FlatShape, TouchesWhatLiesWithinIt) {
  const FlatShape room = MakePolygon({{-5, -5}, {5, -5}, {5, 5}, {-5, 5}});

  EXPECT_EQ(Distance(room, MakePolygon({{0, 0}, {1, 0}, {0, 1}})), 0.0);
  EXPECT_EQ(Distance(room, MakeDisc({1, 1}, 0.1)), 0.0);
  EXPECT_EQ(Distance(MakeDisc({0, 0}, 3), MakeDisc({1, 1}, 0.1)), 0.0);
}

TEST(FlatShape, MeasuresDiscs) {
  EXPECT_NEAR(Distance(MakeDisc({0, 0}, 1), MakeDisc({3, 4}, 0.5)), 3.5, 1e-12);
}

TEST(FlatShape, MakesThePolygonCounterClockwiseWithoutNeedlessCorners) {
  const FlatShape shape = MakePolygon({{0, 0}, {1, 1}, {1, 0}, {0.5, 0.5}, {0, 1}, {0.5, 0}});

  EXPECT_EQ(shape.corners, (std::vector<Vector2d>{{0, 0}, {1, 0}, {1, 1}, {0, 1}}));
  EXPECT_NEAR(shape.reach_m, std::sqrt(0.5), 1e-12);
}

}  // namespace
}  // namespace clearway::core
