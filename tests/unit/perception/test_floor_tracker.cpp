// SPDX-License-Identifier: BSD-3-Clause
#include <limits>

#include <gtest/gtest.h>

#include "common/core/perception/floor/floor_tracker.hpp"

namespace clearway::core {
namespace {

constexpr std::int64_t kStart_us = 1'700'000'000'000'000;

FloorFit FitAt(float height_m) {
  return {.plane_vehicle = {.normal = Eigen::Vector3f::UnitZ(), .offset_m = -height_m},
          .num_inliers = 100,
          .num_candidates = 200};
}

TEST(FloorTrackerTest, UsesTheConfiguredPlaneUntilOneIsFound) {
  FloorTracker tracker({});

  const FloorEstimate estimate = tracker.Update(kStart_us, std::nullopt);

  EXPECT_EQ(estimate.state, FloorState::kConfigured);
  EXPECT_EQ(estimate.age_us, -1);
  EXPECT_EQ(estimate.fit.num_inliers, 0U);
  EXPECT_EQ(estimate.fit.plane_vehicle.offset_m, 0.0F);
}

TEST(FloorTrackerTest, UsesWhatWasFoundInThisScan) {
  FloorTracker tracker({});

  const FloorEstimate estimate = tracker.Update(kStart_us, FitAt(0.1F));

  EXPECT_EQ(estimate.state, FloorState::kFound);
  EXPECT_EQ(estimate.age_us, 0);
  EXPECT_EQ(estimate.fit.plane_vehicle.offset_m, -0.1F);
}

TEST(FloorTrackerTest, HoldsTheLastGoodPlaneForTheStatedTimeAndNoLonger) {
  FloorTracker tracker({.hold_us = 300'000});
  tracker.Update(kStart_us, FitAt(0.1F));

  const FloorEstimate held = tracker.Update(kStart_us + 300'000, std::nullopt);
  const FloorEstimate expired = tracker.Update(kStart_us + 300'001, std::nullopt);

  EXPECT_EQ(held.state, FloorState::kHeld);
  EXPECT_EQ(held.age_us, 300'000);
  EXPECT_EQ(held.fit.plane_vehicle.offset_m, -0.1F);
  EXPECT_EQ(expired.state, FloorState::kConfigured);
  EXPECT_EQ(expired.age_us, 300'001);
  EXPECT_EQ(expired.fit.plane_vehicle.offset_m, 0.0F);
}

TEST(FloorTrackerTest, RecoversAfterTheConfiguredPlane) {
  FloorTracker tracker({.hold_us = 100'000});
  tracker.Update(kStart_us, FitAt(0.1F));
  tracker.Update(kStart_us + 500'000, std::nullopt);

  const FloorEstimate found = tracker.Update(kStart_us + 600'000, FitAt(0.2F));
  const FloorEstimate held = tracker.Update(kStart_us + 700'000, std::nullopt);

  EXPECT_EQ(found.state, FloorState::kFound);
  EXPECT_EQ(held.state, FloorState::kHeld);
  EXPECT_EQ(held.fit.plane_vehicle.offset_m, -0.2F);
}

TEST(FloorTrackerTest, StartsAnewWhenTimeGoesBack) {
  FloorTracker tracker({});
  tracker.Update(kStart_us, FitAt(0.1F));
  tracker.Update(kStart_us + 200'000, std::nullopt);

  const FloorEstimate estimate = tracker.Update(kStart_us + 100'000, std::nullopt);

  EXPECT_EQ(estimate.state, FloorState::kConfigured);
  EXPECT_EQ(estimate.age_us, -1);
}

TEST(FloorTrackerTest, SurvivesTheFarthestStamps) {
  FloorTracker tracker({});
  tracker.Update(std::numeric_limits<std::int64_t>::min(), FitAt(0.1F));

  const FloorEstimate estimate =
      tracker.Update(std::numeric_limits<std::int64_t>::max(), std::nullopt);

  EXPECT_EQ(estimate.state, FloorState::kConfigured);
  EXPECT_EQ(estimate.age_us, std::numeric_limits<std::int64_t>::max());
}

}  // namespace
}  // namespace clearway::core
