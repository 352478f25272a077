// SPDX-License-Identifier: BSD-3-Clause
#include "tools/evaluate/log_scans.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "common/io/lcm_log.hpp"
#include "common/io/read_error.hpp"
#include "common/messages/encoding.hpp"
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
  }

  const LoggedScans logged = ReadLog(path, "A_", WantAll);

  EXPECT_EQ(logged.scans.size(), 1U);
  EXPECT_EQ(logged.missing_slices, 0U);
  EXPECT_EQ(logged.invalid_messages, 1U);
}

TEST(ReadLogTest, ALogThatIsNotThereIsRefused) {
  EXPECT_THROW(static_cast<void>(ReadLog("/nonexistent/run.lcm", "", WantAll)), io::ReadError);
}

}  // namespace
}  // namespace clearway::evaluate
