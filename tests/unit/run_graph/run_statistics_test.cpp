// SPDX-License-Identifier: BSD-3-Clause
#include "tools/run_graph/run_statistics.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <string>
#include <vector>

#include <gtest/gtest.h>

namespace clearway::run_graph {
namespace {

constexpr std::int64_t kRecorded = 1'000'000'000'000'000;
constexpr std::int64_t kPeriod_us = 100'000;

// Slice `index` of `count` of scan `scan`.
lidar_points_t Raw(std::int64_t scan, int index, int count, const std::string& sensor = "front") {
  lidar_points_t message{};
  message.sensor = sensor;
  message.scan_id = scan;
  message.scan_utime = kRecorded + scan * kPeriod_us;
  message.scan_end_utime = message.scan_utime + kPeriod_us;
  message.slice_index = index;
  message.slice_count = count;
  return message;
}

obstacle_points_t Obstacles(std::int64_t scan, int index = 0, int count = 1) {
  obstacle_points_t message{};
  message.scan_id = scan;
  message.scan_utime = kRecorded + scan * kPeriod_us;
  message.utime = message.scan_utime + kPeriod_us;
  message.slice_index = index;
  message.slice_count = count;
  return message;
}

detections_t Detected(std::int64_t scan, int index = 0, int count = 1, int n = 0) {
  detections_t message{};
  message.scan_id = scan;
  message.scan_utime = kRecorded + scan * kPeriod_us;
  message.utime = message.scan_utime + kPeriod_us;
  message.slice_index = index;
  message.slice_count = count;
  message.n = n;
  message.detections.resize(static_cast<std::size_t>(n));
  return message;
}

drive_permit_t Permit(std::int64_t scan, int index) {
  drive_permit_t message{};
  message.slice_sensor = "front";
  message.slice_scan_id = scan;
  message.slice_index = index;
  return message;
}

status_t Status(const std::string& process, std::int64_t session, std::int64_t missing) {
  status_t message{};
  message.process = process;
  message.session = session;
  message.missing = missing;
  return message;
}

// The least value that at least the share p of all values does not exceed.
double QuantileByCounting(const std::vector<double>& values, double p) {
  double best = std::numeric_limits<double>::infinity();
  for (const double candidate : values) {
    const auto below = std::count_if(
        values.begin(), values.end(), [candidate](double value) { return value <= candidate; });
    if (static_cast<double>(below) >= p * static_cast<double>(values.size())) {
      best = std::min(best, candidate);
    }
  }
  return best;
}

TEST(QuantilesTest, AgreeWithCounting) {
  std::mt19937 random(4);
  std::uniform_real_distribution<double> milliseconds(0.0, 50.0);
  for (std::size_t size = 1; size <= 300; size += 1 + size / 10) {
    std::vector<double> values(size);
    for (double& value : values) value = std::round(milliseconds(random));

    const auto quantiles = QuantilesOf(values);

    ASSERT_TRUE(quantiles.has_value());
    EXPECT_EQ(quantiles->median, QuantileByCounting(values, 0.5)) << size;
    EXPECT_EQ(quantiles->p99, QuantileByCounting(values, 0.99)) << size;
  }
}

TEST(QuantilesTest, OfNothingAreNothing) {
  EXPECT_FALSE(QuantilesOf({}).has_value());
}

TEST(RunStatisticsTest, NothingHeardIsNothingMeasured) {
  const RunSummary summary = RunStatistics().Summarise();

  EXPECT_EQ(summary.scans_played, 0U);
  EXPECT_EQ(summary.messages_lost, 0);
  EXPECT_TRUE(summary.stages.empty());
  EXPECT_FALSE(summary.points_in.has_value());
  EXPECT_FALSE(summary.points_map.has_value());
  EXPECT_FALSE(summary.detections.has_value());
  EXPECT_FALSE(summary.scan_to_detections_ms.has_value());
  EXPECT_FALSE(summary.slice_to_permit_ms.has_value());
}

TEST(RunStatisticsTest, OnlyWholeScansCountAsPlayed) {
  RunStatistics statistics;
  for (int index = 0; index < 3; ++index) statistics.OnLidarPoints(Raw(0, index, 3), 10);
  for (int index = 1; index < 3; ++index) statistics.OnLidarPoints(Raw(1, index, 3), 20);

  EXPECT_EQ(statistics.Summarise().scans_played, 1U);
  EXPECT_EQ(statistics.num_played(), 1U);
}

TEST(RunStatisticsTest, ASliceThatComesTwiceDoesNotStandForAnother) {
  RunStatistics statistics;
  statistics.OnLidarPoints(Raw(0, 0, 2), 10);
  statistics.OnLidarPoints(Raw(0, 0, 2), 11);
  EXPECT_EQ(statistics.Summarise().scans_played, 0U);

  statistics.OnLidarPoints(Raw(0, 1, 2), 12);
  EXPECT_EQ(statistics.Summarise().scans_played, 1U);
}

TEST(RunStatisticsTest, AScanOfSeveralSensorsIsWholeWhenEachSensorsPartIs) {
  RunStatistics statistics;
  statistics.OnLidarPoints(Raw(0, 0, 1, "front"), 10);
  statistics.OnLidarPoints(Raw(0, 0, 2, "rear"), 11);
  EXPECT_EQ(statistics.Summarise().scans_played, 0U);

  statistics.OnLidarPoints(Raw(0, 1, 2, "rear"), 12);
  EXPECT_EQ(statistics.Summarise().scans_played, 1U);
}

TEST(RunStatisticsTest, ASenderThatStartsAnewWithOldScanIdsHasScansOfItsOwn) {
  RunStatistics statistics;
  lidar_points_t again = Raw(0, 0, 1);
  again.scan_utime += 50 * kPeriod_us;
  statistics.OnLidarPoints(Raw(0, 0, 1), 10);
  statistics.OnLidarPoints(again, 20);

  EXPECT_EQ(statistics.Summarise().scans_played, 2U);
}

TEST(RunStatisticsTest, LatencyRunsFromTheLastSliceToTheLastPartOfTheDetections) {
  RunStatistics statistics;
  statistics.OnLidarPoints(Raw(0, 0, 2), 1'000);
  statistics.OnLidarPoints(Raw(0, 1, 2), 11'000);
  statistics.OnDetections(Detected(0, 0, 2), 40'000);
  EXPECT_FALSE(statistics.Summarise().scan_to_detections_ms.has_value());

  statistics.OnDetections(Detected(0, 1, 2), 61'500);

  const RunSummary summary = statistics.Summarise();
  ASSERT_TRUE(summary.scan_to_detections_ms.has_value());
  EXPECT_EQ(summary.scan_to_detections_ms->median, 50.5);
  EXPECT_EQ(summary.scan_to_detections_ms->p99, 50.5);
  EXPECT_EQ(summary.scans_detected, 1U);
}

TEST(RunStatisticsTest, DetectionsOfAScanThatWasNotSeenWholeAreNotAmongItsDetectedScans) {
  RunStatistics statistics;
  statistics.OnLidarPoints(Raw(0, 0, 2), 10);
  statistics.OnDetections(Detected(0), 20);
  statistics.OnDetections(Detected(5), 30);

  EXPECT_EQ(statistics.Summarise().scans_detected, 0U);
  EXPECT_EQ(statistics.num_detected(), 2U);
}

TEST(RunStatisticsTest, DetectionsAreMeantOverTheScansThatCameWhole) {
  RunStatistics statistics;
  statistics.OnDetections(Detected(0, 0, 2, 10), 10);
  statistics.OnDetections(Detected(0, 1, 2, 4), 11);
  statistics.OnDetections(Detected(1, 0, 1, 0), 12);
  statistics.OnDetections(Detected(2, 0, 2, 100), 13);  // Its second slice is lost.

  EXPECT_EQ(statistics.Summarise().detections, 7.0);
}

TEST(RunStatisticsTest, IncompleteScansAreCountedOnce) {
  RunStatistics statistics;
  for (int index = 0; index < 3; ++index) {
    detections_t message = Detected(0, index, 3);
    message.scan_state = detections_t::SCAN_INCOMPLETE;
    statistics.OnDetections(message, 10);
  }
  statistics.OnDetections(Detected(1), 20);

  EXPECT_EQ(statistics.Summarise().scans_incomplete, 1U);
}

TEST(RunStatisticsTest, PointsAreMeansPerScanAndTheMapsOnlyWhereItFiltered) {
  RunStatistics statistics;
  for (int scan = 0; scan < 2; ++scan) {
    for (int index = 0; index < 3; ++index) {
      obstacle_points_t message = Obstacles(scan, index, 3);
      message.points_in = 1000 + 100 * scan;
      message.points_voxel = 100;
      message.points_floor = 50;
      message.points_map = 20;
      statistics.OnObstaclePoints(message);
    }
  }
  EXPECT_EQ(statistics.Summarise().points_in, 1050.0);
  EXPECT_EQ(statistics.Summarise().points_voxel, 100.0);
  EXPECT_EQ(statistics.Summarise().points_floor, 50.0);
  EXPECT_FALSE(statistics.Summarise().points_map.has_value());

  obstacle_points_t filtered = Obstacles(2);
  filtered.map_state = obstacle_points_t::MAP_FILTERED;
  filtered.points_map = 30;
  statistics.OnObstaclePoints(filtered);
  EXPECT_EQ(statistics.Summarise().points_map, 30.0);
}

TEST(RunStatisticsTest, StagesHaveTheirScansAndTimes) {
  RunStatistics statistics;
  for (int scan = 0; scan < 3; ++scan) {
    obstacle_points_t obstacles = Obstacles(scan);
    obstacles.processing_us = 1000 * (scan + 1);
    detections_t detections = Detected(scan);
    detections.processing_us = 500;
    statistics.OnObstaclePoints(obstacles);
    statistics.OnDetections(detections, 10);
    for (int index = 0; index < 4; ++index) {
      statistics.OnLidarPoints(Raw(scan, index, 4), 10);
      drive_permit_t permit = Permit(scan, index);
      permit.processing_us = 250;
      statistics.OnDrivePermit(permit, 10);
    }
  }

  const RunSummary summary = statistics.Summarise();

  ASSERT_EQ(summary.stages.size(), 3U);
  EXPECT_EQ(summary.stages.at("preprocessor").scans, 3U);
  EXPECT_EQ(summary.stages.at("preprocessor").processing_ms->median, 2.0);
  EXPECT_EQ(summary.stages.at("preprocessor").processing_ms->p99, 3.0);
  EXPECT_EQ(summary.stages.at("clusterer").scans, 3U);
  EXPECT_EQ(summary.stages.at("clusterer").processing_ms->median, 0.5);
  EXPECT_EQ(summary.stages.at("stop_guard").scans, 3U);
  EXPECT_EQ(summary.stages.at("stop_guard").processing_ms->p99, 0.25);
}

TEST(RunStatisticsTest, LostMessagesAddUpOverProcessesAndTheirRestarts) {
  RunStatistics statistics;
  statistics.OnStatus(Status("preprocessor", 1, 2));
  statistics.OnStatus(Status("preprocessor", 1, 5));   // Counts on: 5, not 7.
  statistics.OnStatus(Status("preprocessor", 2, 0));   // A new life,
  statistics.OnStatus(Status("preprocessor", 2, 10));  // which adds to the first.
  statistics.OnStatus(Status("clusterer", 1, 100));

  EXPECT_EQ(statistics.Summarise().messages_lost, 115);
  EXPECT_EQ(statistics.StatusOf("preprocessor")->session, 2);
  EXPECT_EQ(statistics.StatusOf("viewer"), nullptr);
}

TEST(RunStatisticsTest, APermitAnswersItsSliceAndAllBeforeIt) {
  RunStatistics statistics;
  statistics.OnLidarPoints(Raw(0, 0, 4), 10'000);
  statistics.OnLidarPoints(Raw(0, 1, 4), 20'000);
  statistics.OnLidarPoints(Raw(0, 2, 4), 30'000);
  statistics.OnLidarPoints(Raw(0, 3, 4), 40'000);

  statistics.OnDrivePermit(Permit(0, 2), 32'000);

  // 22, 12 and 2 ms; the fourth slice still waits.
  const RunSummary summary = statistics.Summarise();
  ASSERT_TRUE(summary.slice_to_permit_ms.has_value());
  EXPECT_EQ(summary.slice_to_permit_ms->median, 12.0);
  EXPECT_EQ(summary.slice_to_permit_ms->p99, 22.0);

  statistics.OnDrivePermit(Permit(0, 3), 140'000);
  EXPECT_EQ(statistics.Summarise().slice_to_permit_ms->p99, 100.0);
}

TEST(RunStatisticsTest, APermitThatRepeatsItsSliceIsNoNewAnswer) {
  RunStatistics statistics;
  statistics.OnLidarPoints(Raw(0, 0, 1), 10'000);
  statistics.OnDrivePermit(Permit(0, 0), 11'000);
  statistics.OnDrivePermit(Permit(0, 0), 31'000);

  EXPECT_EQ(statistics.Summarise().slice_to_permit_ms->p99, 1.0);
  EXPECT_EQ(statistics.Summarise().stages.at("stop_guard").scans, 1U);
}

TEST(RunStatisticsTest, APermitBeforeAnySliceMeasuresNothing) {
  RunStatistics statistics;
  statistics.OnDrivePermit(Permit(-1, -1), 11'000);

  EXPECT_TRUE(statistics.Summarise().stages.empty());
  EXPECT_FALSE(statistics.Summarise().slice_to_permit_ms.has_value());
  ASSERT_TRUE(statistics.last_permit().has_value());
  EXPECT_EQ(statistics.last_permit()->slice_scan_id, -1);
}

TEST(RunStatisticsTest, ThePictureIsOfTheNewestScanWithDetections) {
  RunStatistics statistics;
  EXPECT_EQ(statistics.LastDetectedScan(), nullptr);
  for (int scan = 0; scan < 30; ++scan) {
    statistics.OnLidarPoints(Raw(scan, 0, 2), scan);
    statistics.OnLidarPoints(Raw(scan, 1, 2), scan);
    floor_t floor{};
    floor.utime = kRecorded + (scan + 1) * kPeriod_us;
    floor.inliers = scan;
    statistics.OnFloor(floor);
    statistics.OnObstaclePoints(Obstacles(scan));
    if (scan != 29) statistics.OnDetections(Detected(scan, 0, 1, 2), scan);
  }

  const ScanRecord* const record = statistics.LastDetectedScan();

  ASSERT_NE(record, nullptr);
  EXPECT_EQ(record->raw.size(), 2U);
  EXPECT_EQ(record->raw[0].scan_id, 28);
  EXPECT_EQ(record->obstacles.size(), 1U);
  EXPECT_EQ(record->detections.size(), 1U);
  ASSERT_TRUE(record->floor.has_value());
  EXPECT_EQ(record->floor->inliers, 28);
  EXPECT_EQ(statistics.last_input_us(), 29);
}

status_t SimulatorStatus(const std::vector<std::pair<std::string, std::int64_t>>& counters) {
  status_t status{};
  status.process = "simulator";
  for (const auto& [name, value] : counters) {
    counter_t& counter = status.counters.emplace_back();
    counter.name = name;
    counter.value = value;
  }
  status.n = static_cast<std::int32_t>(status.counters.size());
  return status;
}

TEST(RunStatisticsTest, WithoutASimulatorThereIsNoDrive) {
  RunStatistics statistics;

  statistics.OnDrivePermit(Permit(0, 0), 0);

  EXPECT_FALSE(statistics.Summarise().drive);
}

TEST(RunStatisticsTest, TheDriveIsWhatTheSimulatorCounts) {
  RunStatistics statistics;

  statistics.OnStatus(SimulatorStatus({{"driven_mm", 5250}, {"nearest_mm", 120}, {"contacts", 2}}));

  const auto drive = statistics.Summarise().drive;
  ASSERT_TRUE(drive);
  EXPECT_DOUBLE_EQ(drive->driven_m, 5.25);
  EXPECT_DOUBLE_EQ(drive->nearest_m.value(), 0.12);
  EXPECT_EQ(drive->contacts, 2);
}

TEST(RunStatisticsTest, ANearestDistanceThatIsNotKnownIsAbsent) {
  RunStatistics statistics;

  statistics.OnStatus(SimulatorStatus({{"nearest_mm", -1}}));

  EXPECT_FALSE(statistics.Summarise().drive.value().nearest_m);
}

TEST(RunStatisticsTest, AStopForAnObstacleCountsOnceHoweverLongItLasts) {
  RunStatistics statistics;
  statistics.OnStatus(SimulatorStatus({}));
  drive_permit_t free = Permit(0, 0);
  free.forward_mps = 1.0;
  drive_permit_t stopped = Permit(0, 0);
  stopped.reason = drive_permit_t::REASON_OBSTACLE;
  drive_permit_t slowed = stopped;
  slowed.forward_mps = 0.3;

  for (const auto& permit : {free, slowed, stopped, stopped, free, stopped}) {
    statistics.OnDrivePermit(permit, 0);
  }

  EXPECT_EQ(statistics.Summarise().drive.value().obstacle_stops, 2U);
}

}  // namespace
}  // namespace clearway::run_graph
