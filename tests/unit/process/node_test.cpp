// SPDX-License-Identifier: BSD-3-Clause
#include "common/process/node.hpp"

#include <limits>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "common/process/simulated_runtime.hpp"

namespace clearway::process {
namespace {

using messages::Channel;
using messages::channels::kClustererStatus;
using messages::channels::kDriveRequest;
using messages::channels::kFloor;
using messages::channels::kLidarPoints;
using messages::channels::kPreprocessorStatus;
using testing::ElementsAre;

constexpr std::int64_t kStart = 5'000'000;
constexpr std::int64_t kSecond = 1'000'000;

class NodeTest : public testing::Test {
 protected:
  NodeTest() {
    runtime_.SetTap([this](auto, const std::string& channel, std::span<const std::byte> bytes) {
      if (channel == kPreprocessorStatus.name) {
        statuses_.push_back(messages::Decode<status_t>(bytes).value());
      }
    });
  }

  void PublishFrom(std::int64_t session, std::int64_t sequence) {
    drive_request_t request{};
    request.session = session;
    request.sequence = sequence;
    runtime_.Publish(kDriveRequest.bus, kDriveRequest.name, messages::Encode(request));
    runtime_.RunUntil(runtime_.MonotonicUs() + 1000);
  }

  const status_t& StatusAfterOneSecond() {
    runtime_.RunUntil(runtime_.MonotonicUs() + kSecond);
    return statuses_.back();
  }

  SimulatedRuntime runtime_{kStart, {}};
  std::vector<status_t> statuses_;
  Node node_{runtime_, {"preprocessor", "0.1.0", "digest"}, kPreprocessorStatus};
};

TEST_F(NodeTest, PublishesItsStatusAtOnceThenEverySecond) {
  runtime_.RunUntil(kStart + 3 * kSecond);

  ASSERT_EQ(statuses_.size(), 4U);
  EXPECT_EQ(statuses_[0].state, status_t::STATE_STARTING);
  EXPECT_EQ(statuses_[3].sequence, 3);
  EXPECT_EQ(statuses_[3].utime, kStart + 3 * kSecond);
  EXPECT_EQ(statuses_[3].process, "preprocessor");
  EXPECT_EQ(statuses_[3].config_digest, "digest");
  EXPECT_EQ(statuses_[3].input_age_us, -1);
  EXPECT_EQ(statuses_[3].processing_median_ms, -1.0);
}

TEST_F(NodeTest, PublishesAChangeOfStateAtOnceAndTheSameStateNot) {
  node_.SetState({status_t::STATE_OK, true, "works"});
  node_.SetState({status_t::STATE_OK, true, "works, 2 scans"});
  runtime_.RunUntil(kStart + 1);

  ASSERT_EQ(statuses_.size(), 2U);
  EXPECT_EQ(statuses_[1].state, status_t::STATE_OK);
  EXPECT_EQ(StatusAfterOneSecond().text, "works, 2 scans");
}

TEST_F(NodeTest, CountsGapsUndecodableMessagesAndASecondPublisher) {
  int handled = 0;
  node_.Subscribe<drive_request_t>(kDriveRequest, [&](const auto&) { ++handled; });

  PublishFrom(7, 0);
  PublishFrom(7, 3);  // 1 and 2 never came.
  PublishFrom(8, 0);  // Another session: a restart...
  PublishFrom(7, 4);  // ...but the first one is still there.
  runtime_.Publish(kDriveRequest.bus, kDriveRequest.name, messages::Encode(floor_t{}));
  const status_t& status = StatusAfterOneSecond();

  EXPECT_EQ(handled, 4);
  EXPECT_EQ(status.received, 4);
  EXPECT_EQ(status.missing, 2);
  EXPECT_GE(status.foreign, 1);
  EXPECT_EQ(status.invalid, 1);
}

TEST_F(NodeTest, KeepsTheSequencesOfSeveralSensorsApart) {
  node_.Subscribe<lidar_points_t>(kLidarPoints, [](const auto&) {});
  lidar_points_t left{};
  left.sensor = "left";
  left.session = 1;
  lidar_points_t right = left;
  right.sensor = "right";

  for (int i = 0; i < 3; ++i) {
    left.sequence = right.sequence = i;
    runtime_.Publish(kLidarPoints.bus, kLidarPoints.name, messages::Encode(left));
    runtime_.Publish(kLidarPoints.bus, kLidarPoints.name, messages::Encode(right));
  }

  EXPECT_EQ(StatusAfterOneSecond().missing, 0);
}

TEST_F(NodeTest, PacesTheSlicesOfABurstAndNumbersThem) {
  std::vector<std::int64_t> times;
  std::vector<std::int64_t> sequences;
  runtime_.Subscribe(kFloor.bus, kFloor.name, [&](std::span<const std::byte> bytes) {
    times.push_back(runtime_.MonotonicUs() - kStart);
    sequences.push_back(messages::Decode<floor_t>(bytes)->sequence);
  });

  node_.PublishBurst(kFloor, std::vector<floor_t>(3));
  node_.PublishBurst(kFloor, std::vector<floor_t>(1));
  runtime_.RunUntil(kStart + 20'000);
  node_.PublishBurst(kFloor, std::vector<floor_t>(1));
  runtime_.RunUntil(kStart + 20'000);

  EXPECT_THAT(times, ElementsAre(0, 2000, 4000, 6000, 20'000));
  EXPECT_THAT(sequences, ElementsAre(0, 1, 2, 3, 4));
}

TEST_F(NodeTest, GivesUpTheOldestBurstThatHasNotBegunWhenMoreThanFourWait) {
  std::vector<std::int64_t> scans;
  runtime_.Subscribe(kFloor.bus, kFloor.name, [&](std::span<const std::byte> bytes) {
    scans.push_back(messages::Decode<floor_t>(bytes)->scan_id);
  });
  const auto burst_of = [](std::int64_t scan) {
    floor_t message{};
    message.scan_id = scan;
    return std::vector<floor_t>(3, message);
  };

  for (std::int64_t scan = 1; scan <= 7; ++scan) node_.PublishBurst(kFloor, burst_of(scan));
  const status_t& status = StatusAfterOneSecond();

  EXPECT_THAT(scans, ElementsAre(1, 1, 1, 4, 4, 4, 5, 5, 5, 6, 6, 6, 7, 7, 7));
  EXPECT_EQ(status.dropped, 2 * 3);
}

TEST_F(NodeTest, CountsOfHostileSequencesSaturate) {
  node_.Subscribe<drive_request_t>(kDriveRequest, [](const auto&) {});
  node_.Subscribe<lidar_points_t>(kLidarPoints, [](const auto&) {});
  constexpr std::int64_t kMost = std::numeric_limits<std::int64_t>::max();
  for (const char* sensor : {"a", "b", "c"}) {
    lidar_points_t slice{};
    slice.sensor = sensor;
    for (const std::int64_t sequence : {std::int64_t{0}, kMost}) {
      slice.sequence = sequence;
      runtime_.Publish(kLidarPoints.bus, kLidarPoints.name, messages::Encode(slice));
    }
  }

  EXPECT_EQ(StatusAfterOneSecond().missing, kMost);
}

TEST_F(NodeTest, AFloodOfNamesDoesNotGrowTheNode) {
  node_.Subscribe<lidar_points_t>(kLidarPoints, [](const auto&) {});
  lidar_points_t slice{};
  for (int i = 0; i < 1000; ++i) {
    slice.sensor = "sensor" + std::to_string(i);
    slice.sequence = 0;
    runtime_.Publish(kLidarPoints.bus, kLidarPoints.name, messages::Encode(slice));
    slice.sequence = 2;  // A gap of one message for each stream that is watched.
    runtime_.Publish(kLidarPoints.bus, kLidarPoints.name, messages::Encode(slice));
  }

  const status_t& status = StatusAfterOneSecond();

  EXPECT_EQ(status.received, 2000);
  EXPECT_LE(status.missing, 64);
}

TEST_F(NodeTest, RefreshesTheStateBeforeEachStatus) {
  node_.BeforeStatus([this] {
    node_.SetState({status_t::STATE_WAITING, true, "no input"});
    node_.SetCounter("late_slices", 3);
  });

  const status_t& status = StatusAfterOneSecond();

  EXPECT_EQ(status.state, status_t::STATE_WAITING);
  ASSERT_EQ(status.n, 2);  // And send_failures.
  EXPECT_EQ(status.counters[0].name, "late_slices");
  EXPECT_EQ(status.counters[0].value, 3);
}

TEST_F(NodeTest, SummarisesTheProcessingTimesOfEachSecond) {
  for (const int ms : {1, 9, 2}) node_.AddProcessingTime(ms * 1000);

  EXPECT_EQ(StatusAfterOneSecond().processing_median_ms, 2.0);
  EXPECT_EQ(statuses_.back().processing_max_ms, 9.0);
  EXPECT_EQ(StatusAfterOneSecond().scans, 0);
}

}  // namespace
}  // namespace clearway::process
