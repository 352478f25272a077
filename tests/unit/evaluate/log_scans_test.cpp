// SPDX-License-Identifier: BSD-3-Clause
#include "tools/evaluate/log_scans.hpp"

#include <limits>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "common/io/lcm_log.hpp"
#include "common/io/read_error.hpp"
#include "common/messages/encoding.hpp"
#include "common/messages/pose.hpp"
#include "tests/unit/io/temporary_folder.hpp"

namespace clearway::evaluate {
namespace {

using testing::ElementsAre;

constexpr std::int64_t kUtime = 1'000'000;

/// One slice with one point, or one detection, at x = its index.
template <typename Message>
Message MakeSlice(int index, int count, std::int64_t utime = kUtime, std::int64_t session = 1) {
  Message slice{};
  slice.scan_utime = utime;
  slice.session = session;
  slice.slice_index = index;
  slice.slice_count = count;
  slice.n = 1;
  return slice;
}

obstacle_points_t Points(int index, int count, std::int64_t utime = kUtime, int session = 1) {
  auto slice = MakeSlice<obstacle_points_t>(index, count, utime, session);
  slice.x = {static_cast<float>(index)};
  slice.y = slice.z = {0.0F};
  slice.intensity = slice.flags = {0};
  return slice;
}

detections_t Detections(int index, int count, std::int64_t utime = kUtime, int session = 2) {
  auto slice = MakeSlice<detections_t>(index, count, utime, session);
  detection_t detection{};
  detection.centroid[0] = static_cast<float>(index);
  detection.hull_n = 1;
  detection.hull_x = {static_cast<float>(index)};
  detection.hull_y = {0.5F};
  slice.detections = {detection};
  return slice;
}

detections_t NoDetections(std::int64_t utime = kUtime) {
  auto slice = MakeSlice<detections_t>(0, 1, utime, 2);
  slice.n = 0;
  return slice;
}

/// A slice with a point of each reason, at x = its index, +0.25, +0.5.
removed_points_t Removed(int index, int count, std::int64_t utime = 0, int session = 1) {
  removed_points_t slice{};
  slice.utime = utime;
  slice.session = session;
  slice.slice_index = index;
  slice.slice_count = count;
  slice.n = 3;
  const auto x = static_cast<float>(index);
  slice.x = {x, x + 0.25F, x + 0.5F};
  slice.y = slice.z = {0.0F, 0.0F, 0.0F};
  slice.reason = {removed_points_t::REASON_FLOOR,
                  removed_points_t::REASON_MAP,
                  removed_points_t::REASON_OUTLIER};
  return slice;
}

/// A whole scan whose REMOVED_POINTS carry the stamp of its end.
void AddScan(ScanCollector& collector, std::int64_t utime, std::int64_t end_utime) {
  obstacle_points_t points = Points(0, 1, utime);
  points.utime = end_utime;
  collector.Add(points);
  collector.Add(NoDetections(utime));
}

bool WantAll(std::int64_t /*scan_utime*/) {
  return true;
}

TEST(ScanCollectorTest, SlicesInAnyOrderMakeOneScan) {
  ScanCollector collector(WantAll);

  collector.Add(Detections(1, 2));
  collector.Add(Points(2, 3));
  collector.Add(Points(0, 3));
  collector.Add(Detections(0, 2));
  collector.Add(Points(1, 3));
  const LoggedScans logged = collector.Collect();

  ASSERT_EQ(logged.scans.size(), 1U);
  EXPECT_EQ(logged.scans[0].scan_utime, kUtime);
  EXPECT_THAT(logged.scans[0].points.x, ElementsAre(0.0F, 1.0F, 2.0F));
  ASSERT_EQ(logged.scans[0].detections.size(), 2U);
  EXPECT_EQ(logged.scans[0].detections[1].centroid.x(), 1.0F);
  EXPECT_EQ(logged.scans[0].detections[1].hull.at(0), Eigen::Vector2f(1.0F, 0.5F));
  EXPECT_EQ(logged.missing_slices, 0U);
}

TEST(ScanCollectorTest, AScanWithMissingSlicesIsCountedNotGiven) {
  ScanCollector collector(WantAll);

  collector.Add(Points(0, 2));
  collector.Add(Detections(0, 1));
  collector.Add(Points(0, 1, 2 * kUtime));
  collector.Add(Detections(1, 2, 2 * kUtime));
  const LoggedScans logged = collector.Collect();

  EXPECT_TRUE(logged.scans.empty());
  EXPECT_EQ(logged.missing_slices, 2U);
}

TEST(ScanCollectorTest, AScanWithoutOneOfTheChannelsIsMissingSlices) {
  ScanCollector collector(WantAll);

  collector.Add(Points(0, 1));
  collector.Add(NoDetections(2 * kUtime));

  EXPECT_TRUE(collector.Collect().scans.empty());
  EXPECT_EQ(collector.Collect().missing_slices, 2U);
}

TEST(ScanCollectorTest, AnEmptySliceIsAScanWithoutDetections) {
  ScanCollector collector(WantAll);

  collector.Add(Points(0, 1));
  collector.Add(NoDetections());
  const LoggedScans logged = collector.Collect();

  ASSERT_EQ(logged.scans.size(), 1U);
  EXPECT_TRUE(logged.scans[0].detections.empty());
}

TEST(ScanCollectorTest, ASliceThatComesTwiceCountsOnce) {
  ScanCollector collector(WantAll);

  collector.Add(Points(0, 1));
  collector.Add(Points(0, 1));
  collector.Add(Detections(0, 2));
  collector.Add(Detections(0, 2));
  EXPECT_EQ(collector.Collect().missing_slices, 1U);
  collector.Add(Detections(1, 2));

  const LoggedScans logged = collector.Collect();
  ASSERT_EQ(logged.scans.size(), 1U);
  EXPECT_EQ(logged.scans[0].points.size(), 1U);
  EXPECT_EQ(logged.scans[0].detections.size(), 2U);
}

TEST(ScanCollectorTest, SlicesThatContradictThemselvesAreInvalid) {
  ScanCollector collector(WantAll);

  collector.Add(Points(-1, 2));
  collector.Add(Points(2, 2));
  collector.Add(Points(0, 0));
  collector.Add(Points(0, 2));
  collector.Add(Points(1, 3));
  collector.AddInvalid();

  EXPECT_EQ(collector.Collect().invalid_messages, 5U);
}

TEST(ScanCollectorTest, SlicesOfTwoSessionsAreNotPutTogether) {
  ScanCollector collector(WantAll);

  collector.Add(Points(0, 2, kUtime, 1));
  collector.Add(Points(1, 2, kUtime, 7));
  collector.Add(NoDetections());

  EXPECT_EQ(collector.Collect().missing_slices, 1U);
}

TEST(ScanCollectorTest, AScanThatTwoSessionsPublishedIsRefused) {
  ScanCollector collector(WantAll);

  collector.Add(Points(0, 1, kUtime, 1));
  collector.Add(Points(0, 1, kUtime, 7));

  EXPECT_THROW(static_cast<void>(collector.Collect()), io::ReadError);
}

TEST(ScanCollectorTest, ScansThatAreNotWantedAreCountedOnce) {
  int questions = 0;
  ScanCollector collector([&](std::int64_t scan_utime) {
    ++questions;
    return scan_utime == kUtime;
  });

  for (const std::int64_t utime : {kUtime, 2 * kUtime, 3 * kUtime}) {
    collector.Add(Points(0, 1, utime));
    collector.Add(NoDetections(utime));
  }
  const LoggedScans logged = collector.Collect();

  EXPECT_EQ(logged.scans.size(), 1U);
  EXPECT_EQ(logged.not_wanted, 2U);
  EXPECT_EQ(questions, 3);
}

TEST(ScanCollectorTest, WhatTheMapRemovedComesFromItsOwnChannelByTheEndOfTheScan) {
  ScanCollector collector(WantAll);

  collector.Add(Removed(1, 2, kUtime + 7));
  AddScan(collector, kUtime, kUtime + 7);
  collector.Add(Removed(0, 2, kUtime + 7));
  const LoggedScans logged = collector.Collect();

  ASSERT_EQ(logged.scans.size(), 1U);
  EXPECT_TRUE(logged.has_removed_points);
  ASSERT_TRUE(logged.scans[0].removed_by_map.has_value());
  EXPECT_THAT(logged.scans[0].removed_by_map->x, ElementsAre(0.25F, 1.25F));
}

TEST(ScanCollectorTest, WithoutAllSlicesOfRemovedPointsItIsNotKnownWhatTheMapRemoved) {
  ScanCollector collector(WantAll);

  for (const std::int64_t k : {1, 2, 3}) AddScan(collector, k * kUtime, k * kUtime + 7);
  collector.Add(Removed(0, 2, kUtime + 7));
  collector.Add(Removed(0, 1, 2 * kUtime));
  collector.Add(Removed(3, 2, 3 * kUtime + 7));
  const LoggedScans logged = collector.Collect();

  ASSERT_EQ(logged.scans.size(), 3U);
  for (const LoggedScan& scan : logged.scans) EXPECT_FALSE(scan.removed_by_map.has_value());
  EXPECT_EQ(logged.missing_slices, 0U);
  EXPECT_EQ(logged.invalid_messages, 1U);
}

TEST(ScanCollectorTest, RemovedPointsOfTwoSessionsAreRefused) {
  ScanCollector collector(WantAll);

  AddScan(collector, kUtime, kUtime + 7);
  collector.Add(Removed(0, 1, kUtime + 7, 1));
  collector.Add(Removed(0, 1, kUtime + 7, 2));

  EXPECT_THROW(static_cast<void>(collector.Collect()), io::ReadError);
}

TEST(ScanCollectorTest, AScanTellsWhetherItIsWholeAndWhetherItWasFiltered) {
  using Points = obstacle_points_t;
  for (const std::int8_t map_state : {Points::MAP_OFF,
                                      Points::MAP_FILTERED,
                                      Points::MAP_MISSING,
                                      Points::POSE_MISSING,
                                      Points::POSE_OLD,
                                      Points::POSE_LOST,
                                      Points::OUTSIDE_MAP}) {
    for (const std::int8_t scan_state : {Points::SCAN_COMPLETE, Points::SCAN_INCOMPLETE}) {
      ScanCollector collector(WantAll);
      obstacle_points_t points = evaluate::Points(0, 1);
      points.map_state = map_state;
      points.scan_state = scan_state;
      collector.Add(points);
      collector.Add(NoDetections());

      const LoggedScans logged = collector.Collect();

      ASSERT_EQ(logged.scans.size(), 1U);
      EXPECT_EQ(logged.scans[0].is_complete, scan_state == Points::SCAN_COMPLETE);
      EXPECT_EQ(logged.scans[0].is_filtered,
                map_state == Points::MAP_FILTERED || map_state == Points::OUTSIDE_MAP);
    }
  }
}

TEST(ScanCollectorTest, PosesAreGivenInOrderOfTimeAndInvalidOnesCounted) {
  ScanCollector collector(WantAll);
  const auto pose = [](std::int64_t utime, double x_m) {
    return messages::ToPose(utime, Eigen::Isometry3d(Eigen::Translation3d(x_m, 0.0, 0.0)));
  };

  collector.Add(pose(20, 2.0));
  collector.Add(pose(10, 0.0));
  collector.Add(pose(10, 1.0));
  collector.Add(pose(30, std::numeric_limits<double>::quiet_NaN()));
  collector.Add(pose_t{});
  const LoggedScans logged = collector.Collect();

  ASSERT_EQ(logged.poses.size(), 2U);
  EXPECT_EQ(logged.poses[0].utime, 10);
  EXPECT_EQ(logged.poses[0].T_fixed_vehicle.translation().x(), 1.0);
  EXPECT_EQ(logged.poses[1].utime, 20);
  EXPECT_EQ(logged.invalid_messages, 2U);
  EXPECT_FALSE(logged.has_removed_points);
}

TEST(ReadLogTest, TakesTheChannelsWithTheirPrefixAndCountsWhatDoesNotDecode) {
  const test::TemporaryFolder folder;
  const auto path = folder.path() / "run.lcm";
  {
    io::LcmLogWriter log(path);
    log.Write(1, "A_OBSTACLE_POINTS", messages::Encode(Points(0, 1)));
    log.Write(2, "OBSTACLE_POINTS", messages::Encode(Points(1, 2, 5 * kUtime)));
    log.Write(3, "A_DETECTIONS", messages::Encode(Points(0, 1)));
    log.Write(4, "A_DETECTIONS", messages::Encode(Detections(0, 1)));
    log.Write(5, "A_STATUS", {});
    log.Write(6, "A_REMOVED_POINTS", messages::Encode(Removed(0, 1)));
    log.Write(7, "REMOVED_POINTS", messages::Encode(Removed(0, 1, 0, 2)));
    log.Write(8, "A_POSE", messages::Encode(messages::ToPose(5, Eigen::Isometry3d::Identity())));
    log.Write(9, "POSE", messages::Encode(messages::ToPose(6, Eigen::Isometry3d::Identity())));
  }

  const LoggedScans logged = ReadLog(path, "A_", WantAll);

  ASSERT_EQ(logged.scans.size(), 1U);
  EXPECT_TRUE(logged.scans[0].removed_by_map.has_value());
  EXPECT_EQ(logged.poses.size(), 1U);
  EXPECT_EQ(logged.missing_slices, 0U);
  EXPECT_EQ(logged.invalid_messages, 1U);
}

TEST(ReadLogTest, ALogThatIsNotThereIsRefused) {
  EXPECT_THROW(static_cast<void>(ReadLog("/nonexistent/run.lcm", "", WantAll)), io::ReadError);
}

}  // namespace
}  // namespace clearway::evaluate
