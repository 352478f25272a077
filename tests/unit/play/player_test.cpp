// SPDX-License-Identifier: BSD-3-Clause
#include "tools/play/player.hpp"

#include <map>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "common/io/read_error.hpp"
#include "common/messages/lidar_points.hpp"
#include "common/process/simulated_runtime.hpp"

namespace clearway::play {
namespace {

using messages::channels::kLidarPoints;
using messages::channels::kPlayStatus;

constexpr std::int64_t kPeriod_us = 100'000;
constexpr std::int64_t kRecorded = 1'000'000'000'000'000;  // Stamp of the first scan.
constexpr std::int64_t kNow = 1'700'000'000'000'000;       // When it is played.

// Scan i has 100 * i points, so the first is empty; some cannot be read.
class FakeSource final : public ScanSource {
 public:
  explicit FakeSource(std::vector<std::int64_t> utimes, std::set<std::size_t> unreadable = {})
      : utimes_(std::move(utimes)), unreadable_(std::move(unreadable)) {}

  [[nodiscard]] std::size_t size() const override { return utimes_.size(); }
  [[nodiscard]] std::int64_t period_us() const override { return kPeriod_us; }
  [[nodiscard]] std::int64_t utime(std::size_t i) const override { return utimes_[i]; }
  [[nodiscard]] PlayedScan Read(std::size_t i) override {
    if (unreadable_.contains(i)) throw io::ReadError("scan cannot be read");
    PlayedScan scan{.cloud_sensor = {}, .utime = utimes_[i], .name = "fake"};
    for (std::size_t k = 0; k < 100 * i; ++k) {
      scan.cloud_sensor.Add({1.0F, static_cast<float>(i), static_cast<float>(k)});
    }
    return scan;
  }

 private:
  std::vector<std::int64_t> utimes_;
  std::set<std::size_t> unreadable_;
};

FakeSource EvenScans(std::size_t count, std::set<std::size_t> unreadable = {}) {
  std::vector<std::int64_t> utimes;
  for (std::size_t i = 0; i < count; ++i) {
    utimes.push_back(kRecorded + static_cast<std::int64_t>(i) * kPeriod_us);
  }
  return FakeSource(std::move(utimes), std::move(unreadable));
}

struct Arrived {
  std::int64_t time_us = 0;
  std::size_t bytes = 0;
  lidar_points_t message;
};

// What a player on a simulated bus sends.
class PlayerTest : public testing::Test {
 protected:
  void Play(ScanSource& source,
            const PlayerSettings& settings,
            std::int64_t duration_us,
            std::size_t max_message_bytes = 58000) {
    process::SimulatedRuntime runtime(kNow, {.max_message_bytes = max_message_bytes});
    runtime.SetTap(
        [&](messages::BusId bus, const std::string& channel, std::span<const std::byte> bytes) {
          if (channel == kPlayStatus.name) statuses_.push_back(*messages::Decode<status_t>(bytes));
          if (channel != kLidarPoints.name) return;
          EXPECT_EQ(bus, kLidarPoints.bus);
          arrived_.push_back(
              {runtime.MonotonicUs(), bytes.size(), *messages::Decode<lidar_points_t>(bytes)});
        });
    process::Node node(runtime, {"play", "1", "digest"}, kPlayStatus);
    const Player player(node, source, settings, [this] { ++done_; });
    runtime.RunUntil(kNow + duration_us);
    progress_ = player.progress();
  }

  // Number of points by scan id, of all scans that are whole.
  [[nodiscard]] std::map<std::int64_t, std::size_t> PointsOfWholeScans() const {
    std::map<std::int64_t, std::size_t> points;
    std::map<std::int64_t, int> slices;
    for (const Arrived& slice : arrived_) {
      points[slice.message.scan_id] += slice.message.x.size();
      ++slices[slice.message.scan_id];
    }
    for (const Arrived& slice : arrived_) {
      if (slices[slice.message.scan_id] != slice.message.slice_count) {
        points.erase(slice.message.scan_id);
      }
    }
    return points;
  }

  std::vector<Arrived> arrived_;
  std::vector<status_t> statuses_;
  Player::Progress progress_;
  int done_ = 0;
};

const PlayerSettings kOnce = {.sensor = "front", .loop = false, .settle_s = 0.0};
const PlayerSettings kLoop = {.sensor = "front", .loop = true, .settle_s = 0.0};

TEST_F(PlayerTest, EachSliceIsSentWhenItsShareOfThePeriodIsOver) {
  FakeSource source = EvenScans(3);

  Play(source, kOnce, 10 * kPeriod_us);

  ASSERT_EQ(arrived_.size(), 30U);
  for (const Arrived& slice : arrived_) {
    const lidar_points_t& message = slice.message;
    const std::int64_t share_us = kPeriod_us / message.slice_count;
    EXPECT_EQ(slice.time_us - kNow, message.utime + share_us - kRecorded);
  }
}

TEST_F(PlayerTest, StampsAreThoseOfTheRecordingAlsoWithGaps) {
  FakeSource source({kRecorded, kRecorded + 130'000, kRecorded + 1'500'000});

  Play(source, kOnce, 3'000'000);

  ASSERT_EQ(arrived_.size(), 30U);
  for (std::size_t i = 0; i < arrived_.size(); ++i) {
    const lidar_points_t& message = arrived_[i].message;
    EXPECT_EQ(message.scan_utime, source.utime(i / 10));
    EXPECT_EQ(message.scan_end_utime, message.scan_utime + kPeriod_us);
    EXPECT_EQ(message.scan_id, static_cast<std::int64_t>(i / 10));
    EXPECT_EQ(message.slice_index, static_cast<std::int32_t>(i % 10));
    EXPECT_EQ(message.sequence, static_cast<std::int64_t>(i));
    EXPECT_EQ(message.sensor, "front");
  }
  EXPECT_EQ(arrived_.back().time_us, kNow + 1'500'000 + kPeriod_us);
}

TEST_F(PlayerTest, EveryPointIsSentAndAnEmptyScanIsSlicesToo) {
  FakeSource source = EvenScans(4);

  Play(source, kOnce, 10 * kPeriod_us);

  const std::map<std::int64_t, std::size_t> expected = {{0, 0}, {1, 100}, {2, 200}, {3, 300}};
  EXPECT_EQ(PointsOfWholeScans(), expected);
}

TEST_F(PlayerTest, SlicesStayWithinTheBusLimit) {
  FakeSource source = EvenScans(40);

  Play(source, kOnce, 50 * kPeriod_us, 1400);

  EXPECT_EQ(PointsOfWholeScans().at(39), 3900U);
  for (const Arrived& slice : arrived_) EXPECT_LE(slice.bytes, 1400U);
}

TEST_F(PlayerTest, WaitsBeforeTheFirstScanWhenToldTo) {
  FakeSource source = EvenScans(2);

  Play(source, {.sensor = "front", .loop = false, .settle_s = 0.75}, 2'000'000);

  ASSERT_EQ(arrived_.size(), 20U);
  EXPECT_EQ(arrived_.front().time_us, kNow + 750'000 + kPeriod_us / 10);
}

TEST_F(PlayerTest, IsDoneOnceAfterTheLastSliceAndSaysSo) {
  FakeSource source = EvenScans(3);

  Play(source, kOnce, 3 * kPeriod_us - 1);
  EXPECT_EQ(done_, 0);
  EXPECT_EQ(statuses_.back().state, status_t::STATE_OK);
  EXPECT_EQ(progress_.played, 2U);

  Play(source, kOnce, 10 * kPeriod_us);
  EXPECT_EQ(done_, 1);
  EXPECT_EQ(statuses_.back().state, status_t::STATE_DONE);
  EXPECT_EQ(statuses_.back().text, "played 3 of 3 scans");
  EXPECT_EQ(progress_.played, 3U);
}

TEST_F(PlayerTest, ALoopGoesOnWithStampsAndScanIds) {
  FakeSource source({kRecorded, kRecorded + 250'000});

  Play(source, kLoop, 2'000'000);

  EXPECT_EQ(done_, 0);
  ASSERT_GE(arrived_.size(), 60U);
  EXPECT_THAT(statuses_.back().text, testing::EndsWith(" scans, in a loop of 2"));
  for (std::size_t i = 0; i < arrived_.size(); ++i) {
    const lidar_points_t& message = arrived_[i].message;
    const auto scan = static_cast<std::int64_t>(i / 10);
    // The whole recording lasts until one period after its last scan's start.
    EXPECT_EQ(message.scan_utime, kRecorded + scan / 2 * 350'000 + scan % 2 * 250'000);
    EXPECT_EQ(message.scan_id, scan);
    EXPECT_EQ(message.sequence, static_cast<std::int64_t>(i));
  }
}

TEST_F(PlayerTest, AScanThatCannotBeReadIsCountedAndLeftOutWhileTheOthersPlayInTheirTime) {
  FakeSource source = EvenScans(5, {0, 2, 4});

  Play(source, kOnce, 10 * kPeriod_us);

  const std::map<std::int64_t, std::size_t> expected = {{1, 100}, {3, 300}};
  EXPECT_EQ(PointsOfWholeScans(), expected);
  EXPECT_EQ(progress_.played, 2U);
  EXPECT_EQ(progress_.unreadable, 3U);
  EXPECT_EQ(done_, 1);
  EXPECT_EQ(arrived_.front().time_us, kNow + kPeriod_us + kPeriod_us / 10);
  for (const Arrived& slice : arrived_) {
    EXPECT_EQ(slice.message.scan_utime,
              source.utime(static_cast<std::size_t>(slice.message.scan_id)));
  }
}

TEST_F(PlayerTest, ARecordingThatCannotBeReadAtAllEndsAtOnce) {
  FakeSource source = EvenScans(3, {0, 1, 2});

  Play(source, kOnce, kPeriod_us);

  EXPECT_EQ(done_, 1);
  EXPECT_TRUE(arrived_.empty());
  EXPECT_EQ(progress_.unreadable, 3U);
}

TEST_F(PlayerTest, ALoopOverNothingThatCanBeReadEndsAfterOnePass) {
  FakeSource source = EvenScans(3, {0, 1, 2});

  Play(source, kLoop, kPeriod_us);

  EXPECT_EQ(done_, 1);
  EXPECT_EQ(progress_.unreadable, 3U);
}

TEST_F(PlayerTest, ALoopPassesOverItsUnreadableScansEachTime) {
  FakeSource source = EvenScans(3, {0, 2});

  Play(source, kLoop, 30 * kPeriod_us);

  EXPECT_EQ(done_, 0);
  EXPECT_GE(progress_.played, 9U);
  for (const auto& [scan_id, points] : PointsOfWholeScans()) EXPECT_EQ(scan_id % 3, 1);
}

TEST_F(PlayerTest, TheStatusCountsScans) {
  FakeSource source = EvenScans(4, {1});

  Play(source, kOnce, 10 * kPeriod_us);

  std::map<std::string, std::int64_t> counters;
  for (const counter_t& counter : statuses_.back().counters) {
    counters[counter.name] = counter.value;
  }
  EXPECT_EQ(counters["scans_played"], 3);
  EXPECT_EQ(counters["scans_unreadable"], 1);
  EXPECT_EQ(counters["scans_total"], 4);
}

}  // namespace
}  // namespace clearway::play
