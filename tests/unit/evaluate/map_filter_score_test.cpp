// SPDX-License-Identifier: BSD-3-Clause
#include "tools/evaluate/map_filter_score.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <random>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/unit/evaluate/scenes.hpp"

namespace clearway::evaluate {
namespace {

using testing::DoubleEq;
using testing::DoubleNear;
using testing::Optional;

constexpr double kRounding = 1e-12;
constexpr std::int64_t kUtime = 1'000'000'000;

const MapFilterRules kRules{.tolerance_m = 0.1, .z_min_m = 0.05, .z_max_m = 2.0, .min_points = 10};

core::PointCloud Cloud(const std::vector<Eigen::Vector3f>& points) {
  core::PointCloud cloud;
  for (const Eigen::Vector3f& point : points) cloud.Add(point);
  return cloud;
}

/// A box of 1 m to each side with its middle 5 m ahead, 1 m above the floor.
Box BoxAtFive(std::int64_t points = 1000) {
  Box box = test::MakeBox({5.0, 0.0}, {2.0, 2.0, 2.0});
  box.points = points;
  return box;
}

void ExpectShare(const RemovedShare& share, std::size_t points, std::size_t removed) {
  EXPECT_EQ(share.points, points);
  EXPECT_EQ(share.removed, removed);
}

/// Signed distance to the nearest side of an upright box at this yaw, along the axes: above 0
/// outside.
double Outside(const Eigen::Vector3f& point, const Box& box, double yaw_rad) {
  const Eigen::Vector3d centre = box.T_F_box.translation();
  const double x = point.x() - centre.x();
  const double y = point.y() - centre.y();
  const double along = std::abs(x * std::cos(yaw_rad) + y * std::sin(yaw_rad));
  const double across = std::abs(y * std::cos(yaw_rad) - x * std::sin(yaw_rad));
  const double up = std::abs(point.z() - centre.z());
  return std::max(
      {along - box.size_m.x() / 2, across - box.size_m.y() / 2, up - box.size_m.z() / 2});
}

class MapFilterCountsTest : public testing::TestWithParam<unsigned> {};

TEST_P(MapFilterCountsTest, AreThoseOfBruteForce) {
  std::mt19937 random(GetParam());
  std::uniform_real_distribution<float> place(-3.0F, 3.0F);
  std::uniform_real_distribution<float> height(-0.5F, 3.0F);
  const std::vector<double> yaws_rad{0.3, -1.2, 2.0};
  std::vector<Box> boxes;
  for (const double yaw_rad : yaws_rad) {
    boxes.push_back(test::MakeBox({place(random), place(random)}, {2.0, 1.0, 1.7}, yaw_rad));
  }
  boxes[2].points = 9;
  std::array<std::vector<Eigen::Vector3f>, 2> points;  // Kept, removed.
  MapFilterCounts expected;
  for (int i = 0; i < 3000; ++i) {
    const Eigen::Vector3f point(place(random), place(random), height(random));
    const std::size_t removed = random() % 3 == 0 ? 1 : 0;
    points[removed].push_back(point);
    std::vector<double> outside;
    for (std::size_t k = 0; k < 3; ++k) {
      outside.push_back(Outside(point, boxes[k], yaws_rad[k]));
    }
    const bool is_static = *std::min_element(outside.begin(), outside.end()) > 0.1;
    const bool is_object = std::min(outside[0], outside[1]) <= 0.0;
    const bool is_in_band = point.z() >= 0.05F && point.z() <= 2.0F;
    if (is_static) expected.statics += {1, removed};
    if (is_static && is_in_band) expected.statics_in_band += {1, removed};
    if (is_object) expected.objects += {1, removed};
  }

  const auto counts = CountMapFilter(Cloud(points[0]), Cloud(points[1]), boxes, kRules);

  EXPECT_GT(expected.statics.points, expected.statics_in_band.points);
  EXPECT_GT(expected.objects.removed, 0U);
  ExpectShare(counts.statics, expected.statics.points, expected.statics.removed);
  ExpectShare(
      counts.statics_in_band, expected.statics_in_band.points, expected.statics_in_band.removed);
  ExpectShare(counts.objects, expected.objects.points, expected.objects.removed);
}

INSTANTIATE_TEST_SUITE_P(SomeScans, MapFilterCountsTest, testing::Values(1U, 2U, 3U));

TEST(CountMapFilterTest, PointsJustOutsideABoxAreNeitherStaticNorObject) {
  const auto kept = Cloud({{4.5F, 0.0F, 1.0F}, {3.95F, 0.0F, 1.0F}, {3.85F, 0.0F, 1.0F}});
  const auto removed = Cloud({{5.0F, 1.0F, 1.0F}, {5.0F, 1.05F, 1.0F}, {5.0F, 1.2F, 1.0F}});

  const auto counts = CountMapFilter(kept, removed, std::vector{BoxAtFive()}, kRules);

  ExpectShare(counts.objects, 2, 1);
  ExpectShare(counts.statics, 2, 1);
}

TEST(CountMapFilterTest, BoxesWithFewPointsAreNeitherStaticNorObject) {
  const auto removed = Cloud({{5.0F, 0.0F, 1.0F}});

  const auto counts = CountMapFilter({}, removed, std::vector{BoxAtFive(9)}, kRules);

  ExpectShare(counts.objects, 0, 0);
  ExpectShare(counts.statics, 0, 0);
}

TEST(CountMapFilterTest, TheHeightBandIsThatOfTheFilter) {
  MapFilterRules rules = kRules;
  rules.z_min_m = 0.5;
  const auto kept =
      Cloud({{1.0F, 0.0F, -0.2F}, {1.0F, 0.0F, 0.49F}, {1.0F, 0.0F, 0.5F}, {1.0F, 0.0F, 2.01F}});
  const auto removed = Cloud({{1.0F, 0.0F, 2.0F}});

  const auto counts = CountMapFilter(kept, removed, {}, rules);

  ExpectShare(counts.statics, 5, 1);
  ExpectShare(counts.statics_in_band, 2, 1);
}

TEST(RemovedShareTest, OfNoPointsThereIsNoShare) {
  EXPECT_FALSE(RemovedShare{}.Value().has_value());
  EXPECT_THAT((RemovedShare{4, 1}.Value()), Optional(DoubleEq(0.25)));
}

TEST(PoseDifferenceTest, IsSeenFromAboveTheShorterWayRound) {
  const auto a = core::FromRpy({1.0, 2.0, 0.0}, {0.0, 0.0, 3.0});
  const auto b = core::FromRpy({4.0, -2.0, 9.0}, {0.0, 0.0, -3.0});

  const PoseDifference difference = Difference(a, b);

  EXPECT_THAT(difference.distance_m, DoubleNear(5.0, kRounding));
  EXPECT_THAT(difference.turn_rad, DoubleNear(2.0 * M_PI - 6.0, kRounding));
  EXPECT_THAT(Difference(b, a).turn_rad, DoubleNear(difference.turn_rad, kRounding));
}

/// A scan that the filter saw, with one static point of two removed.
LoggedScan GoodScan(std::int64_t utime = kUtime) {
  LoggedScan scan;
  scan.utime = utime;
  scan.is_complete = scan.is_filtered = true;
  scan.points = Cloud({{1.0F, 0.0F, 1.0F}});
  scan.removed_by_map = Cloud({{2.0F, 0.0F, 1.0F}});
  return scan;
}

core::StampedPose PoseAt(std::int64_t utime, double x_m, double yaw_rad) {
  return {utime, core::FromRpy({x_m, 0.0, 0.0}, {0.0, 0.0, yaw_rad})};
}

TEST(MapFilterScorerTest, ScansThatSayNothingAboutTheFilterAreCountedApart) {
  MapFilterScorer scorer(kRules, {}, {}, std::nullopt);
  LoggedScan incomplete = GoodScan();
  incomplete.is_complete = false;
  incomplete.is_filtered = false;
  LoggedScan not_filtered = GoodScan();
  not_filtered.is_filtered = false;
  not_filtered.removed_by_map = core::PointCloud();
  LoggedScan missing = GoodScan();
  missing.removed_by_map.reset();

  for (const LoggedScan& scan : {GoodScan(), incomplete, not_filtered, missing, GoodScan()}) {
    scorer.Add(scan, {});
  }
  const MapFilterSummary summary = scorer.Summarise();

  EXPECT_EQ(summary.scans, 2U);
  EXPECT_EQ(summary.scans_incomplete, 1U);
  EXPECT_EQ(summary.scans_not_filtered, 1U);
  EXPECT_EQ(summary.scans_missing_removed, 1U);
  ExpectShare(summary.counts.statics, 4, 2);
  EXPECT_THAT(summary.LeakedPerScan(), Optional(DoubleEq(1.0)));
}

TEST(MapFilterScorerTest, WithoutScansNothingIsMeasured) {
  const MapFilterSummary summary =
      MapFilterScorer(kRules, {}, {}, Eigen::Isometry3d::Identity()).Summarise();

  EXPECT_FALSE(summary.LeakedPerScan().has_value());
  EXPECT_FALSE(summary.counts.statics.Value().has_value());
  EXPECT_FALSE(summary.pose_error.has_value());
}

TEST(MapFilterScorerTest, ThePoseErrorIsTheMeanOverTheScansThatHaveAPose) {
  const auto T_map_reference = core::FromRpy({1.0, 0.0, 0.0}, {0.0, 0.0, 0.5});
  const std::vector poses{PoseAt(kUtime, 1.0, 0.5),
                          PoseAt(kUtime + 100'000, 1.4, 0.5),
                          PoseAt(kUtime + 200'000, 1.0, 0.7)};
  MapFilterScorer scorer(kRules, {}, poses, T_map_reference);

  scorer.Add(GoodScan(kUtime - 1), {});                 // Before the first pose.
  scorer.Add(GoodScan(kUtime + 50'000), {});            // Half way: 0.2 m.
  scorer.Add(GoodScan(kUtime + 100'000), {});           // 0.4 m.
  scorer.Add(GoodScan(kUtime + 200'000), {});           // 0.2 rad.
  scorer.Add(GoodScan(kUtime + 200'000 + 50'001), {});  // Not carried on as far.
  const MapFilterSummary summary = scorer.Summarise();

  EXPECT_EQ(summary.scans, 5U);
  ASSERT_TRUE(summary.pose_error.has_value());
  EXPECT_THAT(summary.pose_error->distance_m, DoubleNear(0.2, kRounding));
  EXPECT_THAT(summary.pose_error->turn_rad, DoubleNear(0.2 / 3.0, kRounding));
}

TEST(MapFilterScorerTest, WithoutAReferencePoseThereIsNoPoseError) {
  MapFilterScorer scorer(kRules, {}, {PoseAt(kUtime, 1.0, 0.0)}, std::nullopt);

  scorer.Add(GoodScan(), {});

  EXPECT_FALSE(scorer.Summarise().pose_error.has_value());
}

}  // namespace
}  // namespace clearway::evaluate
