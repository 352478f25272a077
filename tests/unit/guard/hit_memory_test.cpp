// SPDX-License-Identifier: BSD-3-Clause
#include "common/core/guard/hit_memory.hpp"

#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <random>
#include <vector>

#include <Eigen/Geometry>
#include <gtest/gtest.h>

namespace clearway::core {
namespace {

constexpr std::int64_t kHold_us = 500'000;
constexpr double kReach_m = 3.0;
constexpr double kMargin_m = 0.05;

SweptFootprint Footprint() {
  return SweptFootprint({{-0.2, -0.2}, {0.3, -0.2}, {0.3, 0.2}, {-0.2, 0.2}}, kMargin_m);
}

double Forward(HitMemory& hits, std::int64_t now) {
  return hits.Nearest(now, kHold_us)[static_cast<std::size_t>(Direction::kForward)].way;
}

struct Seen {
  Eigen::Vector3f point;
  std::int64_t us;
};

// The nearest hits by definition: a list of all points, each compared with each.
std::array<double, kNumDirections> Naive(const std::vector<Seen>& seen,
                                         std::int64_t now,
                                         int min_points) {
  const SweptFootprint footprint = Footprint();
  std::array<double, kNumDirections> nearest;
  nearest.fill(std::numeric_limits<double>::infinity());
  const auto matters = [&](const Seen& s) {
    if (s.us < now - kHold_us) return false;
    const FreeWay way = footprint.WayTo(s.point.head<2>().cast<double>());
    return way[0] <= kReach_m || way[1] <= kReach_m || std::isfinite(way[2]);
  };
  const auto cell = [](float v) { return std::floor(static_cast<double>(v) / HitMemory::kCell_m); };
  for (const Seen& a : seen) {
    if (!matters(a)) continue;
    int count = 0;
    for (const Seen& b : seen) {
      if (matters(b) && std::abs(cell(a.point.x()) - cell(b.point.x())) <= 1.0 &&
          std::abs(cell(a.point.y()) - cell(b.point.y())) <= 1.0) {
        ++count;
      }
    }
    if (count < min_points) continue;
    const FreeWay way = footprint.WayTo(a.point.head<2>().cast<double>());
    for (std::size_t d = 0; d < kNumDirections; ++d) {
      if (d < 2 && way[d] > kReach_m) continue;
      nearest[d] = std::min(nearest[d], way[d]);
    }
  }
  return nearest;
}

class HitMemoryTest : public testing::TestWithParam<unsigned> {};

TEST_P(HitMemoryTest, FindsWhatAListOfAllPointsFindsWhileTheVehicleStands) {
  std::mt19937 random(GetParam());
  std::uniform_real_distribution<float> x(-2.0F, 4.0F);
  std::uniform_real_distribution<float> y(-0.8F, 0.8F);
  const int min_points = 1 + static_cast<int>(GetParam() % 4);
  HitMemory hits(Footprint(), kReach_m, min_points);
  std::vector<Seen> seen;

  // 0.4 s, so that nothing is too old.
  for (std::int64_t now = 0; now <= 400'000; now += 20'000) {
    for (int i = 0; i < 3; ++i) {
      Eigen::Vector3f point(x(random), y(random), 0.2F);
      if (IsInside({{-0.25, -0.25}, {0.35, -0.25}, {0.35, 0.25}, {-0.25, 0.25}},
                   point.head<2>().cast<double>())) {
        continue;
      }
      seen.push_back({point, now});
      hits.Add(point, now);
    }
    const auto nearest = hits.Nearest(now, kHold_us);
    const auto naive = Naive(seen, now, min_points);
    for (std::size_t d = 0; d < kNumDirections; ++d) {
      if (std::isinf(naive[d])) {
        EXPECT_TRUE(std::isinf(nearest[d].way));
      } else {
        EXPECT_NEAR(nearest[d].way, naive[d], 1e-9) << "direction " << d << " at " << now;
      }
    }
  }
}

// The vehicle drives an arc past posts that are seen anew in each step: the remembered way must be
// that of the posts seen now, as long as they are seen.
TEST_P(HitMemoryTest, KeepsThePlaceOfWhatItSawWhileTheVehicleMoves) {
  std::mt19937 random(GetParam());
  std::uniform_real_distribution<double> any(-1.0, 1.0);
  HitMemory hits(Footprint(), kReach_m, 2);
  const double v = 1.0;
  const double w = 0.8 * any(random);
  const Eigen::Vector2d post_world(1.6, 0.1 * any(random));
  Eigen::Isometry2d T_world_vehicle = Eigen::Isometry2d::Identity();
  const Eigen::Vector3f post(
      static_cast<float>(post_world.x()), static_cast<float>(post_world.y()), 0.3F);
  hits.Add(post, 0);
  hits.Add(post, 0);

  for (std::int64_t now = 10'000; now <= kHold_us; now += 10'000) {
    hits.Move(v * 0.01, w * 0.01);
    T_world_vehicle.rotate(0.5 * w * 0.01).translate(Eigen::Vector2d(v * 0.01, 0.0));
    T_world_vehicle.rotate(0.5 * w * 0.01);
    const Eigen::Vector2d truth = T_world_vehicle.inverse() * post_world;
    const double expected = Footprint().WayTo(truth)[0];
    if (std::isfinite(expected)) {
      EXPECT_NEAR(Forward(hits, now), expected, 1e-3);
    } else {
      EXPECT_TRUE(std::isinf(Forward(hits, now)));
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Seeds, HitMemoryTest, testing::Range(1U, 25U));

TEST(HitMemory, ForgetsAHitAfterTheHoldTimeAndNotBefore) {
  HitMemory hits(Footprint(), kReach_m, 2);
  hits.Add({1.3F, 0.0F, 0.2F}, 1000);
  hits.Add({1.31F, 0.0F, 0.2F}, 1000);

  EXPECT_NEAR(Forward(hits, 1000 + kHold_us), 1.0, 1e-6);
  EXPECT_TRUE(std::isinf(Forward(hits, 1001 + kHold_us)));
}

TEST(HitMemory, DoesNotBlinkWhenTheNearestPointOfAnObstacleGrowsOld) {
  HitMemory hits(Footprint(), kReach_m, 2);
  // One burst near, then bursts a little further off in the same cell.
  for (int i = 0; i < 8; ++i) hits.Add({1.31F, 0.01F, 0.2F}, 0);
  for (std::int64_t now = 100'000; now <= 3'000'000; now += 100'000) {
    for (int i = 0; i < 8; ++i) hits.Add({1.37F, 0.01F, 0.2F}, now);
    ASSERT_LE(Forward(hits, now), 1.08) << now;
    ASSERT_LE(Forward(hits, now + 99'999), 1.08) << now;
  }
}

TEST(HitMemory, IgnoresALonePoint) {
  HitMemory hits(Footprint(), kReach_m, 2);
  hits.Add({1.0F, 0.0F, 0.2F}, 0);
  hits.Add({1.5F, 0.0F, 0.2F}, 0);

  EXPECT_TRUE(std::isinf(Forward(hits, 0)));
}

TEST(HitMemory, ForgetsEverythingWhenTold) {
  HitMemory hits(Footprint(), kReach_m, 1);
  hits.Add({1.0F, 0.0F, 0.2F}, 0);

  hits.Clear();

  EXPECT_TRUE(std::isinf(Forward(hits, 0)));
}

TEST(HitMemory, StaysRightOnALongWay) {
  HitMemory hits(Footprint(), kReach_m, 1);
  std::int64_t now = 0;
  for (int i = 0; i < 20'000; ++i) {  // 1 km, with a bend.
    now += 50'000;
    hits.Move(0.05, 0.0001);
    hits.Add({0.8F, 0.0F, 0.2F}, now);
    ASSERT_LE(Forward(hits, now), 0.5 + 1e-6);
  }
  hits.Add({0.5F, 0.0F, 0.2F}, now);

  EXPECT_LE(Forward(hits, now), 0.2 + 1e-6);
}

}  // namespace
}  // namespace clearway::core
