// SPDX-License-Identifier: BSD-3-Clause
#include "tools/plot/view_region.hpp"

#include <cmath>

#include <gtest/gtest.h>

namespace clearway::plot {
namespace {

TEST(ChooseRegion, HoldsAllButTheFarthestFewPoints) {
  ScanPicture picture;
  for (int i = 0; i < 990; ++i) {
    picture.raw_points.emplace_back(0.01F * static_cast<float>(i), 0.0F, 0.0F);
  }
  for (int i = 0; i < 10; ++i) picture.raw_points.emplace_back(300.0F, 0.0F, 0.0F);

  const ViewRegion region = ChooseRegion(picture);

  EXPECT_NEAR(region.range_m, 9.79, 0.011);
  EXPECT_GE(region.x_max_m, 9.7);
  EXPECT_LT(region.x_max_m, 12.0);
  EXPECT_LE(region.x_min_m, 0.0);
}

TEST(ChooseRegion, FollowsWhatThereIsWithoutRawPoints) {
  ScanPicture picture;
  picture.obstacle_points.assign(100, Eigen::Vector3f(0.0F, 20.0F, 1.0F));

  EXPECT_GE(ChooseRegion(picture).y_max_m, 20.0);
}

TEST(ChooseRegion, IsAFewMetresAroundTheOriginWithoutAnything) {
  const ViewRegion region = ChooseRegion({});

  EXPECT_DOUBLE_EQ(region.x_max_m - region.x_min_m, 3.0);
  EXPECT_DOUBLE_EQ(region.y_max_m, 1.5);
}

TEST(RoundStep, IsOneTwoOrFiveTimesAPowerOfTen) {
  EXPECT_DOUBLE_EQ(RoundStep(1.0), 1.0);
  EXPECT_DOUBLE_EQ(RoundStep(1.99), 1.0);
  EXPECT_DOUBLE_EQ(RoundStep(2.5), 2.0);
  EXPECT_DOUBLE_EQ(RoundStep(73.0), 50.0);
  EXPECT_NEAR(RoundStep(0.03), 0.02, 1e-12);
}

TEST(StepLabel, HasNoNeedlessDigits) {
  EXPECT_EQ(StepLabel(6.0, 2.0), "6");
  EXPECT_EQ(StepLabel(-1.5, 0.5), "-1.5");
  EXPECT_EQ(StepLabel(-0.0, 1.0), "0");
  EXPECT_EQ(StepLabel(0.06, 0.02), "0.06");
  EXPECT_EQ(StepLabel(-40.0, 20.0), "-40");
}

}  // namespace
}  // namespace clearway::plot
