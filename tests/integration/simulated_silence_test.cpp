// SPDX-License-Identifier: BSD-3-Clause
// The rows of the table "what fails, what happens", to the microsecond, in virtual time.
#include <algorithm>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/simulated_graph.hpp"

namespace clearway::test {
namespace {

namespace channels = messages::channels;

constexpr std::int64_t kSecond = 1'000'000;
constexpr std::int64_t kSilenceLimit_us = 100'000;
constexpr std::int64_t kPermitPeriod_us = 20'000;

std::vector<Timed<drive_permit_t>> PermitsAfter(const SimulatedGraph& graph, std::int64_t time_us) {
  std::vector<Timed<drive_permit_t>> permits = graph.On(channels::kDrivePermit);
  std::erase_if(permits, [&](const auto& permit) { return permit.time_us <= time_us; });
  return permits;
}

TEST(SilenceTest, NoMotionIsPermittedBeforeTheFirstSlice) {
  SimulatedGraph graph(LabConfig());

  graph.RunFor(kSecond);

  const auto permits = graph.On(channels::kDrivePermit);
  ASSERT_GE(permits.size(), 49U);
  for (const auto& permit : permits) {
    EXPECT_TRUE(IsStop(permit.message));
    EXPECT_EQ(permit.message.reason, drive_permit_t::REASON_STARTING);
  }
}

TEST(SilenceTest, WhenLidarPointsStopThePermitIsZeroWithinItsLimitAndOnePeriod) {
  // The silence begins at each phase of the permit timer.
  ListedScans room(ReadAll(*FreeRoom(2.0)));
  for (const std::int64_t phase_us : {0, 3'000, 9'999, 10'001, 17'000}) {
    SimulatedGraph graph(LabConfig());
    const std::int64_t silent_from_us = SimulatedGraph::kStart + 3 * kSecond / 2 + phase_us;
    graph.RunFor(phase_us);
    graph.Play(room, [&](auto) {
      return graph.now_us() < silent_from_us ? RelayRuntime::Deliveries{0}
                                             : RelayRuntime::Deliveries{};
    });

    graph.RunFor(3 * kSecond);

    const std::int64_t last_slice_us = graph.On(channels::kLidarPoints).back().time_us;
    const auto before = PermitsAfter(graph, last_slice_us - kSilenceLimit_us);
    EXPECT_EQ(before.front().message.reason, drive_permit_t::REASON_FREE);
    const auto after = PermitsAfter(graph, last_slice_us + kSilenceLimit_us + kPermitPeriod_us);
    ASSERT_FALSE(after.empty());
    for (const auto& permit : after) {
      EXPECT_TRUE(IsStop(permit.message));
      EXPECT_EQ(permit.message.reason, drive_permit_t::REASON_SENSOR_SILENT);
      EXPECT_THAT(permit.message.text, testing::HasSubstr("front"));
    }
  }
}

TEST(SilenceTest, AWireThatIsLateByMoreThanItsLimitMeansStopForAsLongAsItIs) {
  constexpr std::int64_t kLate_us = 130'000;
  const auto room = FreeRoom(8.0);
  SimulatedGraph graph(LabConfig());
  const std::int64_t late_from_us = graph.now_us() + 2 * kSecond;
  const std::int64_t late_until_us = graph.now_us() + 5 * kSecond;
  graph.Play(*room, [&](auto) {
    const bool is_late = graph.now_us() >= late_from_us && graph.now_us() < late_until_us;
    return RelayRuntime::Deliveries{is_late ? kLate_us : 0};
  });

  graph.RunFor(8 * kSecond);

  const auto all = graph.On(channels::kDrivePermit);
  for (const auto& permit : all) {
    const bool must_stop =
        permit.time_us > late_from_us + kSilenceLimit_us && permit.time_us < late_until_us;
    if (!must_stop) continue;
    EXPECT_TRUE(IsStop(permit.message));
    EXPECT_THAT(
        permit.message.reason,
        testing::AnyOf(drive_permit_t::REASON_SENSOR_SILENT, drive_permit_t::REASON_SLICES_LATE));
  }
  const auto late = std::count_if(all.begin(), all.end(), [](const auto& permit) {
    return permit.message.reason == drive_permit_t::REASON_SLICES_LATE;
  });
  EXPECT_GT(late, 100);  // Most of the three seconds.
  EXPECT_EQ(all.back().message.reason, drive_permit_t::REASON_FREE);
}

TEST(SilenceTest, WithoutDetectionsTheSpeedIsCappedAndPathAGoesOn) {
  for (const SimulatedGraph::Parts& parts :
       {SimulatedGraph::Parts{.preprocessor = false}, SimulatedGraph::Parts{.clusterer = false}}) {
    const auto room = FreeRoom(2.0);
    const graph::GraphConfig config = LabConfig();
    SimulatedGraph graph(config, parts);

    graph.Play(*room);
    graph.RunFor(2 * kSecond);

    const auto permits = PermitsAfter(graph, SimulatedGraph::kStart + kSecond);
    ASSERT_FALSE(permits.empty());
    for (const auto& permit : permits) {
      EXPECT_EQ(permit.message.reason, drive_permit_t::REASON_NO_DETECTIONS);
      EXPECT_EQ(permit.message.forward_mps, config.stop_guard.degraded_speed_mps);
    }
    const status_t status = graph.FreshStatus(channels::kStopGuardStatus);
    EXPECT_EQ(status.state, status_t::STATE_DEGRADED);
    EXPECT_THAT(status.text, testing::HasSubstr("DETECTIONS"));
  }
}

TEST(SilenceTest, AMovingVehicleWithoutOdometryDoesNotMove) {
  graph::GraphConfig config = LabConfig();
  config.vehicle.stationary = false;
  const auto room = FreeRoom(2.0);
  SimulatedGraph graph(config);

  graph.Play(*room);
  graph.RunFor(2 * kSecond);

  for (const auto& permit : graph.On(channels::kDrivePermit)) EXPECT_TRUE(IsStop(permit.message));
  EXPECT_EQ(graph.On(channels::kDrivePermit).back().message.reason,
            drive_permit_t::REASON_NO_ODOMETRY);
  EXPECT_EQ(graph.On(channels::kObstaclePoints).back().message.motion_state,
            obstacle_points_t::MOTION_NO_ODOMETRY);
  EXPECT_EQ(graph.FreshStatus(channels::kPreprocessorStatus).state, status_t::STATE_DEGRADED);
}

}  // namespace
}  // namespace clearway::test
