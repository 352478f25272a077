// SPDX-License-Identifier: BSD-3-Clause
#include "tools/plot/scan_log.hpp"

#include <optional>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "common/core/mapping/run_length.hpp"
#include "common/io/lcm_log.hpp"
#include "common/io/read_error.hpp"
#include "common/messages/channels.hpp"
#include "common/messages/encoding.hpp"
#include "common/messages/map_tiles.hpp"
#include "common/messages/pose.hpp"
#include "tests/support/test_folder.hpp"

namespace clearway::plot {
namespace {

namespace channels = messages::channels;
using testing::AllOf;
using testing::HasSubstr;

constexpr std::int64_t kBegin = 50'000'000;  // Of the log [us since the epoch].
constexpr std::int64_t kPeriod_us = 100'000;

class ScanLogTest : public testing::Test {
 protected:
  [[nodiscard]] ScanLog Log() const { return {folder_.path() / "test.lcmlog", "B_"}; }

  template <typename Message>
  void Write(std::int64_t utime,
             const messages::Channel<Message>& channel,
             const Message& message) {
    writer_->Write(utime, std::string("B_") + channel.name, messages::Encode(message));
  }

  // A scan that ends at `end_utime`, logged by then, with what the graph made of it.
  void WriteScan(std::int64_t scan_id, std::int64_t end_utime) {
    lidar_points_t raw{};
    raw.sensor = "front";
    raw.scan_id = scan_id;
    raw.scan_utime = end_utime - kPeriod_us;
    raw.scan_end_utime = end_utime;
    raw.slice_count = 2;
    for (; raw.slice_index < 2; ++raw.slice_index) {
      Write(end_utime - 50'000 + 40'000 * raw.slice_index, channels::kLidarPoints, raw);
    }
    obstacle_points_t obstacles{};
    obstacles.utime = end_utime;
    obstacles.scan_id = scan_id;
    obstacles.slice_count = 1;
    Write(end_utime + 1000, channels::kObstaclePoints, obstacles);
    floor_t floor{};
    floor.utime = end_utime;
    floor.scan_id = scan_id;
    floor.inliers = static_cast<std::int32_t>(scan_id);
    Write(end_utime + 1000, channels::kFloor, floor);
  }

  void WriteDetections(std::int64_t scan_id, std::int64_t end_utime) {
    detections_t detections{};
    detections.utime = end_utime;
    detections.scan_id = scan_id;
    detections.slice_count = 1;
    Write(end_utime + 2000, channels::kDetections, detections);
  }

  // Ten scans with the ids 20 to 29; the last one without DETECTIONS.
  void WriteTenScans() {
    Write(kBegin, channels::kPose, messages::ToPose(kBegin, Eigen::Isometry3d::Identity()));
    for (int i = 0; i < 10; ++i) {
      const std::int64_t end_utime = kBegin + (i + 1) * kPeriod_us;
      WriteScan(20 + i, end_utime);
      if (i < 9) WriteDetections(20 + i, end_utime);
    }
  }

  [[nodiscard]] std::vector<LoggedScan> Read(const std::vector<ScanEntry>& wanted) const {
    std::vector<LoggedScan> scans;
    ReadScans(Log(), wanted, {}, [&](const LoggedScan& scan) { scans.push_back(scan); });
    return scans;
  }

  // All is in the file when the writer is gone.
  void Flush() { writer_.reset(); }

  template <typename Function>
  [[nodiscard]] static std::string ErrorOf(Function function) {
    try {
      function();
    } catch (const io::ReadError& error) {
      return error.what();
    }
    return "no error";
  }

  test::TestFolder folder_;
  std::optional<io::LcmLogWriter> writer_{std::in_place, Log().file};
};

TEST_F(ScanLogTest, SelectsByIdTimeAndPlace) {
  WriteTenScans();
  Flush();

  const ScanIndex index = IndexScans(Log());

  ASSERT_EQ(index.scans.size(), 10U);
  EXPECT_EQ(ScanWithId(index, 23).scan_id, 23);
  EXPECT_EQ(ScanAtTime(index, 0.05).scan_id, 20);
  EXPECT_EQ(ScanAtTime(index, 0.249).scan_id, 21);
  EXPECT_EQ(LastScan(index).scan_id, 28);
  const std::vector<ScanEntry> every = EveryNthScan(index, 4);
  ASSERT_EQ(every.size(), 3U);
  EXPECT_EQ(every[2].scan_id, 28);
}

TEST_F(ScanLogTest, SaysWhichScansThereAreWhenOneIsNot) {
  WriteTenScans();
  Flush();
  const ScanIndex index = IndexScans(Log());

  EXPECT_THAT(ErrorOf([&] { (void)ScanWithId(index, 30); }),
              AllOf(HasSubstr("test.lcmlog"), HasSubstr("no scan 30"), HasSubstr("from 20 to 29")));
  EXPECT_THAT(ErrorOf([&] { (void)ScanAtTime(index, 0.04); }), HasSubstr("from 0.05 s to 0.95 s"));
  EXPECT_THAT(ErrorOf([&] { (void)ScanAtTime(index, 1.1); }), HasSubstr("ends at 1.00 s"));
  EXPECT_THAT(ErrorOf([&] {
                (void)IndexScans({Log().file, ""});
              }),
              AllOf(HasSubstr("no scan"), HasSubstr("B_LIDAR_POINTS")));
  EXPECT_THAT(ErrorOf([&] { (void)IndexScans({folder_.path() / "none", ""}); }), HasSubstr("none"));
}

TEST_F(ScanLogTest, HandsOnEachWantedScanWithItsOwnMessagesOnly) {
  WriteTenScans();
  Flush();

  const std::vector<LoggedScan> scans = Read(EveryNthScan(IndexScans(Log()), 3));

  ASSERT_EQ(scans.size(), 4U);
  for (std::size_t i = 0; i < scans.size(); ++i) {
    const ScanMessages& scan = scans[i].messages;
    EXPECT_EQ(scans[i].entry.scan_id, 20 + 3 * static_cast<int>(i));
    EXPECT_EQ(scan.raw.size(), 2U);
    EXPECT_EQ(scan.obstacles.size(), 1U);
    EXPECT_EQ(scan.detections.size(), i == 3 ? 0U : 1U);
    ASSERT_TRUE(scan.floor.has_value());
    EXPECT_EQ(scan.floor->inliers, scans[i].entry.scan_id);
    EXPECT_EQ(scan.refused, 0U);
    EXPECT_EQ(scans[i].map.grid, nullptr);
  }
}

TEST_F(ScanLogTest, AnIdThatComesAgainIsTheLastScanWithIt) {
  WriteScan(1, kBegin);
  WriteScan(1, kBegin + 5 * kPeriod_us);
  Flush();

  const std::vector<LoggedScan> scans = Read({ScanWithId(IndexScans(Log()), 1)});

  ASSERT_EQ(scans.size(), 1U);
  EXPECT_EQ(scans[0].entry.end_utime, kBegin + 5 * kPeriod_us);
  EXPECT_EQ(scans[0].messages.raw.size(), 2U);
}

TEST_F(ScanLogTest, TakesThePermitThatAnswersTheScanAlsoWhenItComesLate) {
  WriteScan(1, kBegin);
  drive_permit_t permit{};
  permit.slice_sensor = "front";
  permit.slice_scan_id = 1;
  for (; permit.slice_index < 2; ++permit.slice_index) {
    permit.text = "slice " + std::to_string(permit.slice_index);
    Write(kBegin + 20'000, channels::kDrivePermit, permit);
  }
  permit.slice_index = 1;
  permit.text = "later";
  Write(kBegin + 40'000, channels::kDrivePermit, permit);
  Flush();

  const std::vector<LoggedScan> scans = Read({LastScan(IndexScans(Log()))});

  ASSERT_EQ(scans.size(), 1U);
  ASSERT_TRUE(scans[0].messages.permit.has_value());
  EXPECT_EQ(scans[0].messages.permit->text, "slice 1");
}

TEST_F(ScanLogTest, InterpolatesThePoseAtTheEndOfTheScan) {
  const auto pose_at = [&](std::int64_t utime, double x_m) {
    Write(utime,
          channels::kPose,
          messages::ToPose(utime, Eigen::Isometry3d(Eigen::Translation3d(x_m, 0.0, 0.0))));
  };
  pose_at(kBegin - 40'000, 1.0);
  WriteScan(1, kBegin);
  pose_at(kBegin + 40'000, 3.0);  // After the scan's last message.
  Flush();

  const std::vector<LoggedScan> scans = Read({LastScan(IndexScans(Log()))});

  ASSERT_EQ(scans.size(), 1U);
  ASSERT_TRUE(scans[0].messages.T_map_vehicle.has_value());
  EXPECT_NEAR(scans[0].messages.T_map_vehicle->translation().x(), 2.0, 1e-9);
}

TEST_F(ScanLogTest, ShowsTheMapAsItWasWhenTheScanCame) {
  core::OccupancyGrid grid;
  grid.geometry = {.width = 3, .height = 2};
  grid.cells.assign(6, core::OccupancyGrid::kFree);
  const auto write_map = [&](std::int64_t utime, std::int64_t epoch) {
    const core::MapTile tile{.version = {.session = 9, .epoch = epoch},
                             .geometry = grid.geometry,
                             .count = 1,
                             .rectangle = {0, 0, 3, 2},
                             .cells = grid.cells,
                             .map_checksum = core::Checksum(grid.cells)};
    map_tile_t message = messages::ToLcm(tile);
    message.session = 9;
    Write(utime, channels::kMap, message);
  };
  WriteScan(1, kBegin);
  write_map(kBegin + 3 * kPeriod_us, 1);
  WriteScan(2, kBegin + 5 * kPeriod_us);
  grid.cells[4] = core::OccupancyGrid::kOccupied;
  write_map(kBegin + 8 * kPeriod_us, 2);
  WriteScan(3, kBegin + 10 * kPeriod_us);
  Flush();

  const std::vector<LoggedScan> scans = Read(EveryNthScan(IndexScans(Log()), 1));

  ASSERT_EQ(scans.size(), 3U);
  EXPECT_EQ(scans[0].map.grid, nullptr);
  ASSERT_NE(scans[1].map.grid, nullptr);
  EXPECT_EQ(scans[1].map.epoch, 1);
  EXPECT_EQ(scans[1].map.grid->cells[4], core::OccupancyGrid::kFree);
  EXPECT_EQ(scans[2].map.epoch, 2);
  EXPECT_EQ(*scans[2].map.grid, grid);
}

}  // namespace
}  // namespace clearway::plot
