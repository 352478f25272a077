// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>
#include <numeric>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "common/core/perception/floor/floor_split.hpp"
#include "tests/unit/perception/scenes.hpp"

namespace clearway::core {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

TEST(FloorSplitTest, TellsFloorObstacleAndHoleApart) {
  PointCloud cloud;
  for (const float z : {0.0F, 0.04F, 0.06F, 1.0F, -0.04F, -0.09F, -0.11F, -2.0F}) {
    cloud.Add({1.0F, 2.0F, z});
  }

  const FloorSplit split = SplitByFloor(cloud, Plane{}, FloorConfig{});

  EXPECT_THAT(split.floor, ElementsAre(0, 1, 4, 5));
  EXPECT_THAT(split.above, ElementsAre(2, 3));
  EXPECT_THAT(split.below, ElementsAre(6, 7));
  EXPECT_EQ(split.num_invalid, 0U);
}

TEST(FloorSplitTest, MeasuresAcrossATiltedPlane) {
  const float tilt_rad = 0.2F;
  const Plane ramp{.normal = {-std::sin(tilt_rad), 0.0F, std::cos(tilt_rad)}, .offset_m = 0.0F};
  PointCloud cloud;
  cloud.Add({10.0F, 0.0F, 10.0F * std::tan(tilt_rad)});
  cloud.Add({10.0F, 0.0F, 0.0F});

  const FloorSplit split = SplitByFloor(cloud, ramp, FloorConfig{});

  EXPECT_THAT(split.floor, ElementsAre(0));
  EXPECT_THAT(split.below, ElementsAre(1));
}

TEST(FloorSplitTest, PutsEachMeasurementIntoExactlyOneList) {
  test::Random random(51);
  PointCloud cloud = test::RandomCube(random, 5000, 0.3);
  for (int i = 0; i < 10; ++i) cloud.Add({test::kNan, 0.0F, 0.0F});

  const FloorSplit split = SplitByFloor(cloud, Plane{}, FloorConfig{});

  std::vector<std::uint32_t> all;
  for (const auto& part : {split.floor, split.above, split.below}) {
    EXPECT_TRUE(std::is_sorted(part.begin(), part.end()));
    EXPECT_FALSE(part.empty());
    all.insert(all.end(), part.begin(), part.end());
  }
  std::sort(all.begin(), all.end());
  std::vector<std::uint32_t> expected(5000);
  std::iota(expected.begin(), expected.end(), 0U);
  EXPECT_EQ(all, expected);
  EXPECT_EQ(split.num_invalid, 10U);
}

TEST(FloorSplitTest, GivesNothingForNothing) {
  const FloorSplit split = SplitByFloor({}, Plane{}, FloorConfig{});

  EXPECT_THAT(split.floor, IsEmpty());
  EXPECT_THAT(split.above, IsEmpty());
  EXPECT_THAT(split.below, IsEmpty());
}

TEST(FloorSplitTest, CountsWhatIsNoMeasurementAsInvalid) {
  PointCloud cloud;
  cloud.Add({test::kNan, 0.0F, 0.0F});
  cloud.Add({0.0F, 0.0F, -test::kInfinity});
  cloud.Add({1e30F, 0.0F, 0.0F});

  const FloorSplit split = SplitByFloor(cloud, Plane{}, FloorConfig{});

  EXPECT_EQ(split.num_invalid, 3U);
  EXPECT_THAT(split.below, IsEmpty());
}

TEST(FloorConfigTest, WantsTheBelowMarginOutsideTheFloor) {
  EXPECT_TRUE(FloorConfig{}.Validate().empty());
  EXPECT_EQ((FloorConfig{.distance_threshold_m = 0.2, .below_margin_m = 0.1}.Validate().size()),
            1U);
}

}  // namespace
}  // namespace clearway::core
