// SPDX-License-Identifier: BSD-3-Clause
// Each process in turn is killed or frozen: the rows of the design's table "what fails, what
// happens" whose parts exist. Times are the kernel's, of the messages' arrival here.
#include <csignal>
#include <utility>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/kill_fixture.hpp"

namespace clearway::test {
namespace {

TEST_F(KillTest, DriverKilledMeansNoMotionUntilItIsBack) {
  StartWholeGraph();
  const std::int64_t session = SessionOf("play");

  graph_.Kill("play");
  ASSERT_TRUE(AwaitReason(drive_permit_t::REASON_SENSOR_SILENT)) << Describe();
  ASSERT_TRUE(AwaitReason(drive_permit_t::REASON_SENSOR_SILENT)) << Describe();

  const std::int64_t moved_us = MovedOnAfterTheLastSlice();
  Report("last_slice_to_last_permit_to_move_ms", moved_us);
  EXPECT_LE(moved_us, kLimit_us + kTransport_us);
  EXPECT_TRUE(IsStop(listener_.permits.back().message));
  ExpectWholeAgainWithANewSession("play", session);
}

TEST_F(KillTest, DriverFrozenMeansNoMotionAndItsBacklogDoesNotMoveTheVehicle) {
  StartWholeGraph();

  graph_.Signal("play", SIGSTOP);
  ASSERT_TRUE(AwaitReason(drive_permit_t::REASON_SENSOR_SILENT)) << Describe();
  ASSERT_TRUE(AwaitReason(drive_permit_t::REASON_SENSOR_SILENT)) << Describe();
  const std::int64_t moved_us = MovedOnAfterTheLastSlice();
  graph_.Signal("play", SIGCONT);

  Report("last_slice_to_last_permit_to_move_ms", moved_us);
  EXPECT_LE(moved_us, kLimit_us + kTransport_us);
  EXPECT_TRUE(AwaitWhole()) << Describe();
  ExpectEveryPermitRestsOnAFreshSlice();
}

TEST_F(KillTest, StopGuardKilledMeansThatTheBaseStopsByItself) {
  StartWholeGraph();
  const std::int64_t session = SessionOf("stop_guard");

  const std::int64_t killed_us = GraphListener::NowUs();
  graph_.Kill("stop_guard");
  listener_.Await([] { return false; }, kSecond / 2);

  const std::int64_t last_us = listener_.permits.back().arrival_us;
  Report("kill_to_base_stops_ms", last_us + kLimit_us - killed_us);
  EXPECT_TRUE(MayTheBaseMove(last_us));
  EXPECT_FALSE(MayTheBaseMove(std::max(last_us, killed_us) + kLimit_us + 1));
  EXPECT_LE(last_us, killed_us + kTransport_us);
  ExpectWholeAgainWithANewSession("stop_guard", session);
  // The base locks to the new publisher once the old one has been silent for long enough.
  EXPECT_TRUE(listener_.Await([&] { return MayTheBaseMove(GraphListener::NowUs()); }));
}

TEST_F(KillTest, StopGuardFrozenMeansThatTheBaseStopsAndOldSlicesDoNotMoveIt) {
  StartWholeGraph();

  graph_.Signal("stop_guard", SIGSTOP);
  const std::int64_t frozen_us = GraphListener::NowUs();
  listener_.Await([] { return false; }, kSecond);
  const std::int64_t last_us = listener_.permits.back().arrival_us;
  const bool moves_while_frozen = MayTheBaseMove(std::max(last_us, frozen_us) + kLimit_us + 1);
  graph_.Signal("stop_guard", SIGCONT);

  Report("freeze_to_base_stops_ms", last_us + kLimit_us - frozen_us);
  EXPECT_LE(last_us, frozen_us + kTransport_us);
  EXPECT_FALSE(moves_while_frozen);
  EXPECT_TRUE(AwaitWhole()) << Describe();
  EXPECT_TRUE(listener_.Await([&] { return MayTheBaseMove(GraphListener::NowUs()); }));
  ExpectEveryPermitRestsOnAFreshSlice();
}

class PerceptionKillTest : public KillTest, public testing::WithParamInterface<const char*> {
 protected:
  void ExpectPathAGoesOnWithACap() {
    const std::int64_t from_us = GraphListener::NowUs();
    ASSERT_TRUE(AwaitReason(drive_permit_t::REASON_NO_DETECTIONS)) << Describe();
    const std::int64_t capped_us = listener_.permits.back().arrival_us;
    Report("last_detections_to_cap_ms", capped_us - listener_.detections.back().arrival_us);
    listener_.Await([] { return false; }, kSecond);

    ExpectCapped(capped_us, GraphListener::NowUs(), kDegraded_mps);
    const auto moving =
        std::count_if(listener_.permits.begin(), listener_.permits.end(), [&](const auto& permit) {
          return permit.arrival_us >= from_us && permit.message.forward_mps >= kDegraded_mps;
        });
    // 50 a second, for a second and more; a loaded machine may lose some to late slices.
    EXPECT_GT(moving, 25) << Describe();
  }
};

TEST_P(PerceptionKillTest, KilledMeansThatPathAGoesOnSlowly) {
  StartWholeGraph();
  const std::int64_t session = SessionOf(GetParam());

  graph_.Kill(GetParam());

  ExpectPathAGoesOnWithACap();
  ExpectWholeAgainWithANewSession(GetParam(), session);
}

TEST_P(PerceptionKillTest, FrozenMeansThatPathAGoesOnSlowly) {
  StartWholeGraph();

  graph_.Signal(GetParam(), SIGSTOP);
  ExpectPathAGoesOnWithACap();
  graph_.Signal(GetParam(), SIGCONT);

  EXPECT_TRUE(AwaitWhole()) << Describe();
  ExpectEveryPermitRestsOnAFreshSlice();
}

INSTANTIATE_TEST_SUITE_P(Stages,
                         PerceptionKillTest,
                         testing::Values("preprocessor", "clusterer"),
                         [](const auto& test) { return std::string(test.param); });

TEST_F(KillTest, AllKilledAndStartedAgainIsTheWholeGraphWithNewSessions) {
  StartWholeGraph();
  const std::vector<std::string> names{"play", "preprocessor", "clusterer", "stop_guard"};
  std::map<std::string, std::int64_t> sessions;
  for (const std::string& name : names) sessions[name] = SessionOf(name);

  for (const std::string& name : names) graph_.Kill(name);
  graph_.StartAll();

  EXPECT_TRUE(AwaitWhole()) << Describe();
  for (const std::string& name : names) {
    EXPECT_TRUE(listener_.Await([&] { return SessionOf(name) != sessions[name]; })) << name;
  }
}

class StopTest : public KillTest, public testing::WithParamInterface<int> {};

TEST_P(StopTest, EveryProgramEndsWithStatusZeroWithinASecondAndSaysGoodbye) {
  StartWholeGraph();

  for (const char* name : {"play", "preprocessor", "clusterer", "stop_guard"}) {
    const std::int64_t signalled_us = GraphListener::NowUs();
    graph_.Signal(name, GetParam());

    EXPECT_EQ(graph_.AwaitEnd(name, 20 * kSecond), 0) << name;

    Report(std::string(name) + "_ends_after_ms", GraphListener::NowUs() - signalled_us);
    if (!kIsSanitized) {
      EXPECT_LT(GraphListener::NowUs() - signalled_us, kSecond) << name;
    }
    EXPECT_TRUE(listener_.Await([&] {
      return listener_.statuses.at(name).arrival_us >= signalled_us;
    })) << name;
  }
}

INSTANTIATE_TEST_SUITE_P(Signals, StopTest, testing::Values(SIGINT, SIGTERM), [](const auto& test) {
  return test.param == SIGINT ? "Int" : "Term";
});

}  // namespace
}  // namespace clearway::test
