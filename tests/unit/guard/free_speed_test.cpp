// SPDX-License-Identifier: BSD-3-Clause
#include "common/core/guard/free_speed.hpp"

#include <cmath>
#include <limits>
#include <tuple>

#include <gtest/gtest.h>

namespace clearway::core {
namespace {

// Drives on at `speed` for the reaction time, then brakes, in steps of 0.1 ms; the way used.
double SimulatedStop(double speed, const Braking& braking) {
  constexpr double kStep_s = 1e-4;
  double way = 0.0;
  double now_s = 0.0;
  while (speed > 0.0) {
    const double next =
        now_s < braking.reaction_time_s ? speed : speed - braking.deceleration * kStep_s;
    way += 0.5 * (speed + std::fmax(next, 0.0)) * kStep_s;
    speed = next;
    now_s += kStep_s;
  }
  return way;
}

class FreeSpeedTest : public testing::TestWithParam<std::tuple<double, double, double>> {};

TEST_P(FreeSpeedTest, IsTheHighestSpeedFromWhichASimulatedVehicleStopsInTime) {
  const auto [distance, deceleration, reaction_s] = GetParam();
  const Braking braking{deceleration, reaction_s, 0.1};

  const double speed = FreeSpeed(distance, braking);

  ASSERT_GT(speed, 0.0);
  // One step of the simulation at that speed.
  const double tolerance_m = 2e-4 * speed + 1e-6;
  EXPECT_NEAR(SimulatedStop(speed, braking), distance - braking.margin, tolerance_m);
  EXPECT_NEAR(StoppingDistance(speed, braking), distance - braking.margin, 1e-9);
}

INSTANTIATE_TEST_SUITE_P(Vehicles,
                         FreeSpeedTest,
                         testing::Combine(testing::Values(0.11, 0.3, 1.0, 5.0, 50.0),
                                          testing::Values(0.2, 1.0, 5.0),
                                          testing::Values(0.0, 0.05, 0.3, 1.0)));

TEST(FreeSpeed, IsZeroWithoutRoom) {
  const Braking braking{1.0, 0.2, 0.1};

  EXPECT_EQ(FreeSpeed(0.1, braking), 0.0);
  EXPECT_EQ(FreeSpeed(0.05, braking), 0.0);
  EXPECT_EQ(FreeSpeed(0.0, braking), 0.0);
  EXPECT_EQ(FreeSpeed(-1.0, braking), 0.0);
  EXPECT_EQ(FreeSpeed(std::numeric_limits<double>::quiet_NaN(), braking), 0.0);
}

TEST(FreeSpeed, GrowsWithTheRoomAndIsInfiniteOnAnEmptyPlane) {
  const Braking braking{1.0, 0.2, 0.1};
  double before = 0.0;
  for (double d = 0.1001; d < 100.0; d *= 1.01) {
    const double speed = FreeSpeed(d, braking);
    EXPECT_GT(speed, before);
    before = speed;
  }

  EXPECT_TRUE(std::isinf(FreeSpeed(std::numeric_limits<double>::infinity(), braking)));
}

}  // namespace
}  // namespace clearway::core
