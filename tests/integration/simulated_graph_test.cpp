// SPDX-License-Identifier: BSD-3-Clause
// The whole graph in virtual time: what goes in comes out, of every stage, always the same.
#include "tests/support/simulated_graph.hpp"

#include <cmath>
#include <limits>
#include <map>
#include <set>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "common/config/config.hpp"
#include "tests/support/test_data.hpp"

namespace clearway::test {
namespace {

namespace channels = messages::channels;

// The slices of one scan, by scan id.
template <typename Message>
std::map<std::int64_t, std::vector<Message>> ByScan(const std::vector<Timed<Message>>& slices) {
  std::map<std::int64_t, std::vector<Message>> scans;
  for (const auto& slice : slices) scans[slice.message.scan_id].push_back(slice.message);
  return scans;
}

// Every scan of LIDAR_POINTS has all of its slices on each channel, with its stamps, once.
template <typename Message>
void ExpectWholeScans(const SimulatedGraph& graph, const messages::Channel<Message>& channel) {
  const auto raw = ByScan(graph.On(channels::kLidarPoints));
  const auto scans = ByScan(graph.On(channel));
  ASSERT_EQ(scans.size(), raw.size()) << channel.name;
  for (const auto& [id, slices] : scans) {
    ASSERT_TRUE(raw.contains(id));
    EXPECT_EQ(slices.size(), static_cast<std::size_t>(slices.front().slice_count)) << id;
    for (std::size_t k = 0; k < slices.size(); ++k) {
      EXPECT_EQ(slices[k].slice_index, static_cast<std::int32_t>(k));
      EXPECT_EQ(slices[k].utime, raw.at(id).front().scan_end_utime);
      EXPECT_EQ(slices[k].scan_utime, raw.at(id).front().scan_utime);
      EXPECT_EQ(slices[k].scan_state, Message::SCAN_COMPLETE);
    }
  }
}

void ExpectEveryScanThroughEveryStage(SimulatedGraph& graph, std::size_t num_scans) {
  EXPECT_EQ(ByScan(graph.On(channels::kLidarPoints)).size(), num_scans);
  ExpectWholeScans(graph, channels::kObstaclePoints);
  ExpectWholeScans(graph, channels::kDetections);
  EXPECT_EQ(graph.On(channels::kFloor).size(), num_scans);
  for (const auto& channel :
       {channels::kPreprocessorStatus, channels::kClustererStatus, channels::kStopGuardStatus}) {
    const status_t status = graph.FreshStatus(channel);
    EXPECT_EQ(status.missing, 0) << channel.name;
    EXPECT_EQ(status.invalid, 0) << channel.name;
    EXPECT_EQ(status.foreign, 0) << channel.name;
    EXPECT_EQ(status.dropped, 0) << channel.name;
  }
}

TEST(SimulatedGraphTest, EveryScanOfTheLabGoesThroughEveryStage) {
  const auto lab = play::OpenSource(SourceFolder() / "config" / "lab_scene.xml", LabConfig(), 3.0);
  SimulatedGraph graph(LabConfig());

  graph.Play(*lab);
  graph.RunToTheEnd();

  ExpectEveryScanThroughEveryStage(graph, 30);
}

TEST(SimulatedGraphTest, TheGuardAnswersEverySliceAndPublishesAtItsRate) {
  const auto room = FreeRoom(2.0);
  SimulatedGraph graph(LabConfig());

  graph.Play(*room);
  graph.RunFor(2'000'000);

  const auto permits = graph.On(channels::kDrivePermit);
  ASSERT_GE(permits.size(), 100U);  // 50 a second.
  for (std::size_t i = 0; i < permits.size(); ++i) {
    EXPECT_EQ(permits[i].message.sequence, static_cast<std::int64_t>(i));
    if (i > 0) {
      EXPECT_LE(permits[i].time_us - permits[i - 1].time_us, 20'000);
    }
  }
  EXPECT_EQ(permits.back().message.reason, drive_permit_t::REASON_FREE);
  EXPECT_EQ(permits.back().message.forward_mps, LabConfig().vehicle.max_forward_mps);
  const status_t status = graph.FreshStatus(channels::kStopGuardStatus);
  EXPECT_EQ(CounterOf(status, "slices"),
            static_cast<std::int64_t>(graph.On(channels::kLidarPoints).size()));
}

TEST(SimulatedGraphTest, BothThingsBesideTheWayAreDetectedInEveryScan) {
  const auto room = FreeRoom(1.0);
  SimulatedGraph graph(LabConfig());

  graph.Play(*room);
  graph.RunToTheEnd();

  // Surfaces are seen from the front: the centroid lies within an object's extent of its middle.
  constexpr double kWithin_m = 0.35;
  for (const auto& [id, slices] : ByScan(graph.On(channels::kDetections))) {
    for (const auto& [x, y] : {std::pair(4.0, 1.6), std::pair(3.5, -1.4)}) {
      bool found = false;
      for (const detections_t& slice : slices) {
        for (const detection_t& d : slice.detections) {
          found |= std::hypot(static_cast<double>(d.centroid[0]) - x,
                              static_cast<double>(d.centroid[1]) - y) < kWithin_m;
        }
      }
      EXPECT_TRUE(found) << "scan " << id << " at " << x << ' ' << y;
    }
  }
}

TEST(SimulatedGraphTest, EveryScanOfIndoorPeopleGoesThroughEveryStage) {
  const std::string recording = "indoor_people/consecutive";
  const auto folder = TestData(recording);
  if (!folder) GTEST_SKIP() << MissingData(recording);
  const auto config =
      config::Load<graph::GraphConfig>(SourceFolder() / "config" / "indoor_people.xml").root;
  graph::GraphConfig renamed = config;
  renamed.vehicle.sensors.front().name = "front";
  const auto source = play::OpenSource(*folder, config, 0.0);
  SimulatedGraph graph(renamed);

  graph.Play(*source);
  graph.RunToTheEnd();

  ExpectEveryScanThroughEveryStage(graph, 30);
}

TEST(SimulatedGraphTest, SlicesOfDetectionsTogetherHoldEveryCluster) {
  // Arrange: as many separate things, well above the floor, as need several small messages.
  core::PointCloud cloud;
  constexpr int kRows = 12;
  constexpr int kColumns = 12;
  for (int row = 0; row < kRows; ++row) {
    for (int column = 0; column < kColumns; ++column) {
      for (int k = 0; k < 8; ++k) {
        cloud.Add({1.0F + 0.6F * static_cast<float>(row),
                   -3.3F + 0.6F * static_cast<float>(column),
                   0.25F + 0.06F * static_cast<float>(k)});
      }
    }
  }
  ListedScans scans({cloud, cloud, cloud});
  graph::GraphConfig config = LabConfig();
  config.buses.local.max_message_bytes = config.buses.shared.max_message_bytes = 1400;
  SimulatedGraph graph(config);

  graph.Play(scans);
  graph.RunToTheEnd();

  ExpectWholeScans(graph, channels::kDetections);
  for (const auto& [id, slices] : ByScan(graph.On(channels::kDetections))) {
    EXPECT_GT(slices.size(), 1U);
    std::set<std::int32_t> ids;
    for (const detections_t& slice : slices) {
      for (const detection_t& d : slice.detections) EXPECT_TRUE(ids.insert(d.id).second);
    }
    EXPECT_EQ(ids.size(), static_cast<std::size_t>(kRows * kColumns));
  }
  for (const TappedMessage& message : graph.tapped()) {
    if (message.channel.ends_with("STATUS")) continue;
    EXPECT_LE(message.bytes.size(), 1400U) << message.channel;
  }
}

std::vector<TappedMessage> PlayTheLab() {
  const auto lab = play::OpenSource(SourceFolder() / "config" / "lab_scene.xml", LabConfig(), 1.0);
  SimulatedGraph graph(LabConfig());
  graph.Play(*lab);
  graph.RunToTheEnd();
  return graph.tapped();
}

TEST(SimulatedGraphTest, TheSameRunTwiceGivesTheSameBytes) {
  const std::vector<TappedMessage> first = PlayTheLab();
  const std::vector<TappedMessage> second = PlayTheLab();

  ASSERT_EQ(first.size(), second.size());
  for (std::size_t i = 0; i < first.size(); ++i) {
    ASSERT_TRUE(first[i] == second[i]) << "message " << i << " on " << first[i].channel;
  }
}

TEST(SimulatedGraphTest, EmptyScansGiveEmptyOutputsWithTheSameStamp) {
  core::PointCloud no_returns;
  for (int i = 0; i < 1000; ++i) no_returns.Add({0.0F, 0.0F, 0.0F});
  ListedScans scans({core::PointCloud{}, no_returns, core::PointCloud{}, no_returns});
  SimulatedGraph graph(LabConfig());

  graph.Play(scans);
  graph.RunToTheEnd();

  ExpectEveryScanThroughEveryStage(graph, 4);
  for (const auto& points : graph.On(channels::kObstaclePoints)) EXPECT_EQ(points.message.n, 0);
  for (const auto& detections : graph.On(channels::kDetections)) {
    EXPECT_EQ(detections.message.n, 0);
    EXPECT_EQ(detections.message.slice_count, 1);
  }
  for (const auto& permit : graph.On(channels::kDrivePermit)) EXPECT_TRUE(IsStop(permit.message));
}

TEST(SimulatedGraphTest, PointsThatAreNoMeasurementsChangeNoDetection) {
  // Arrange: the same scans with NaN, infinities and absurd distances at the end of each.
  const auto room = FreeRoom(1.0);
  const std::vector<core::PointCloud> clean = ReadAll(*room);
  std::vector<core::PointCloud> dirty = clean;
  constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();
  constexpr float kInf = std::numeric_limits<float>::infinity();
  constexpr float kMax = std::numeric_limits<float>::max();
  constexpr float kTiny = std::numeric_limits<float>::denorm_min();
  for (core::PointCloud& cloud : dirty) {
    const std::int32_t last_us = cloud.time_offset_us.back();
    for (const float bad : {kNaN, kInf, -kInf, kMax, -kMax, 1e30F, 2e5F}) {
      cloud.Add({bad, 0.0F, 0.0F}, 100, 0, last_us);
      cloud.Add({1.0F, bad, 0.0F}, 100, 0, last_us);
      cloud.Add({1.0F, 1.0F, bad}, 100, 0, last_us);
      cloud.Add({bad, bad, bad}, 100, 0, last_us);
    }
    cloud.Add({kTiny, kTiny, kTiny}, 100, 0, last_us);
  }
  ListedScans clean_scans(clean);
  ListedScans dirty_scans(dirty);
  SimulatedGraph clean_graph(LabConfig());
  SimulatedGraph dirty_graph(LabConfig());

  clean_graph.Play(clean_scans);
  clean_graph.RunToTheEnd();
  dirty_graph.Play(dirty_scans);
  dirty_graph.RunToTheEnd();

  const auto expected = clean_graph.On(channels::kDetections);
  const auto detections = dirty_graph.On(channels::kDetections);
  ASSERT_EQ(detections.size(), expected.size());
  for (std::size_t i = 0; i < detections.size(); ++i) {
    EXPECT_EQ(messages::Encode(detections[i].message), messages::Encode(expected[i].message)) << i;
  }
  const auto permits = dirty_graph.On(channels::kDrivePermit);
  const auto expected_permits = clean_graph.On(channels::kDrivePermit);
  ASSERT_EQ(permits.size(), expected_permits.size());
  for (std::size_t i = 0; i < permits.size(); ++i) {
    EXPECT_EQ(permits[i].message.forward_mps, expected_permits[i].message.forward_mps) << i;
  }
}

}  // namespace
}  // namespace clearway::test
