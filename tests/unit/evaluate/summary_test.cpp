// SPDX-License-Identifier: BSD-3-Clause
#include "tools/evaluate/summary.hpp"

#include <numbers>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace clearway::evaluate {
namespace {

using testing::DoubleEq;
using testing::Optional;

ObjectScore Found(double range_m, double centre_error_m) {
  ObjectScore score;
  score.range_m = range_m;
  score.any_evidence = true;
  score.centre_error_m = centre_error_m;
  score.nearest_error_m = 2.0 * centre_error_m;
  return score;
}

ObjectScore Missed(double range_m) {
  ObjectScore score;
  score.range_m = range_m;
  return score;
}

TEST(SummaryTest, ObjectsAreBinnedByRangeWithTheLowerEdgeInside) {
  SceneScore scene;
  scene.objects = {Found(1.99, 0.1), Missed(2.0), Found(4.99, 0.1), Found(20.0, 0.1)};
  scene.objects[2].separated = true;

  const Summary summary = Summarise(std::vector{scene});

  ASSERT_EQ(summary.recall.size(), 3U) << "bins without objects are left out";
  EXPECT_EQ(summary.recall[0].max_m, 2.0);
  EXPECT_EQ(summary.recall[0].objects, 1U);
  EXPECT_EQ(summary.recall[1].min_m, 2.0);
  EXPECT_EQ(summary.recall[1].objects, 2U);
  EXPECT_EQ(summary.recall[1].any_evidence, 1U);
  EXPECT_EQ(summary.recall[1].separated, 1U);
  EXPECT_EQ(summary.recall[2].min_m, 20.0);
  EXPECT_EQ(summary.recall[2].max_m, 60.0);
}

TEST(SummaryTest, ErrorsAreMediansOverTheObjectsThatHaveAMatch) {
  SceneScore first;
  first.objects = {Found(3.0, 0.3), Missed(3.0)};
  SceneScore second;
  second.objects = {Found(3.0, 0.1), Found(3.0, 0.2)};
  second.objects[0].yaw_error_rad = std::numbers::pi / 18.0;

  const Summary summary = Summarise(std::vector{first, second});

  EXPECT_THAT(summary.centre_error_m, Optional(DoubleEq(0.2)));
  EXPECT_THAT(summary.centre_error_p99_m, Optional(DoubleEq(0.3)));
  EXPECT_THAT(summary.nearest_error_m, Optional(DoubleEq(0.4)));
  EXPECT_THAT(summary.yaw_error_deg, Optional(DoubleEq(10.0)));
}

TEST(SummaryTest, CountsAreSums) {
  SceneScore first{.objects = {Found(3.0, 0.1)}, .detections = 3, .merges = 1, .few_points = 2};
  first.objects[0].splits = 2;
  first.objects[0].within_radius = true;
  const SceneScore second{.objects = {Missed(3.0)}, .detections = 2, .out_of_range = 1};

  const Summary summary = Summarise(std::vector{first, second});

  EXPECT_EQ(summary.scans, 2U);
  EXPECT_EQ(summary.objects, 2U);
  EXPECT_EQ(summary.within_radius, 1U);
  EXPECT_EQ(summary.few_points, 2U);
  EXPECT_EQ(summary.out_of_range, 1U);
  EXPECT_THAT(summary.splits, Optional(2U));
  EXPECT_THAT(summary.merges, Optional(1U));
  EXPECT_THAT(summary.detections_per_scan, Optional(DoubleEq(2.5)));
}

TEST(SummaryTest, WhatWasNotMeasuredIsAbsent) {
  const Summary nothing = Summarise({});
  EXPECT_FALSE(nothing.detections_per_scan.has_value());
  EXPECT_FALSE(nothing.splits.has_value());

  const Summary no_objects = Summarise(std::vector<SceneScore>(1));
  EXPECT_THAT(no_objects.detections_per_scan, Optional(0.0));
  EXPECT_TRUE(no_objects.recall.empty());
  EXPECT_FALSE(no_objects.merges.has_value());
  EXPECT_FALSE(no_objects.centre_error_m.has_value());
  EXPECT_FALSE(no_objects.yaw_error_deg.has_value());
}

TEST(QuantileTest, TakesTheNearestRank) {
  std::vector<double> hundred;
  for (int i = 100; i >= 1; --i) hundred.push_back(i);

  EXPECT_THAT(Quantile(hundred, 0.99), Optional(99.0));
  EXPECT_THAT(Quantile(hundred, 1.0), Optional(100.0));
  EXPECT_THAT(Quantile(hundred, 0.5), Optional(50.5));
  EXPECT_THAT(Quantile({3.0, 1.0, 2.0}, 0.5), Optional(2.0));
  EXPECT_THAT(Quantile({7.0}, 0.99), Optional(7.0));
  EXPECT_FALSE(Quantile({}, 0.5).has_value());
}

}  // namespace
}  // namespace clearway::evaluate
