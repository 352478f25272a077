// SPDX-License-Identifier: BSD-3-Clause
// The graph mends itself: killed processes come back by their deputy, a killed deputy's next life
// carries on, and nobody needs a sheriff for it.
#include <map>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "common/host/process_table.hpp"
#include "tests/support/kill_fixture.hpp"

namespace clearway::test {
namespace {

constexpr const char* kNames[] = {"play", "preprocessor", "clusterer", "stop_guard"};

class RespawnTest : public KillTest {
 protected:
  [[nodiscard]] std::map<std::string, std::int64_t> Sessions() const {
    std::map<std::string, std::int64_t> sessions;
    for (const char* name : kNames) sessions[name] = SessionOf(name);
    return sessions;
  }

  [[nodiscard]] static bool IsAlive(std::int32_t pid) {
    const auto process = host::ReadProcess(pid);
    return process && process->state != 'Z';
  }
};

class RespawnEachTest : public RespawnTest, public testing::WithParamInterface<const char*> {};

TEST_P(RespawnEachTest, KilledItIsBackAndTheGraphIsWholeByItself) {
  graph_.LetRespawn();
  StartWholeGraph();
  const auto sessions = Sessions();
  const std::size_t orders = graph_.peer().orders.size();

  const std::int64_t killed_us = GraphListener::NowUs();
  graph_.Kill(GetParam());

  ASSERT_TRUE(listener_.Await([&] { return SessionOf(GetParam()) != sessions.at(GetParam()); }));
  Report("kill_to_its_next_status_ms", GraphListener::NowUs() - killed_us);
  ASSERT_TRUE(AwaitWhole()) << Describe();
  Report("restart_to_whole_ms", GraphListener::NowUs() - killed_us);
  EXPECT_TRUE(graph_.peer().Await(
      [&] { return graph_.peer().HealthOf(RunningGraph::kDeputy, GetParam()).starts == 2; }));
  for (const char* name : kNames) {
    EXPECT_EQ(SessionOf(name) == sessions.at(name), std::string(name) != GetParam()) << name;
  }
  EXPECT_EQ(graph_.peer().orders.size(), orders) << "nobody gave an order";
  ExpectEveryPermitRestsOnAFreshSlice();
}

INSTANTIATE_TEST_SUITE_P(Processes,
                         RespawnEachTest,
                         testing::ValuesIn(kNames),
                         [](const auto& test) { return std::string(test.param); });

TEST_F(RespawnTest, DeputyKilledMeansThatTheBaseStopsAndTheNextOneBringsAllBack) {
  StartWholeGraph();
  const auto sessions = Sessions();
  const std::size_t orders = graph_.peer().orders.size();

  const std::int64_t killed_us = GraphListener::NowUs();
  graph_.KillDeputy();
  listener_.Await([] { return false; }, kSecond / 2);

  const std::int64_t last_us = listener_.permits.back().arrival_us;
  Report("kill_to_base_stops_ms", last_us + kLimit_us - killed_us);
  EXPECT_LE(last_us, killed_us + kTransport_us);
  EXPECT_FALSE(MayTheBaseMove(std::max(last_us, killed_us) + kLimit_us + 1));
  for (const char* name : kNames) EXPECT_FALSE(IsAlive(graph_.PidOf(name))) << name;

  const std::int64_t started_us = GraphListener::NowUs();
  graph_.StartDeputy();
  ASSERT_TRUE(AwaitWhole()) << Describe();
  Report("restart_to_whole_ms", GraphListener::NowUs() - started_us);
  EXPECT_TRUE(listener_.Await([&] { return MayTheBaseMove(GraphListener::NowUs()); }));
  for (const char* name : kNames) {
    EXPECT_TRUE(listener_.Await([&] { return SessionOf(name) != sessions.at(name); })) << name;
  }
  EXPECT_EQ(graph_.peer().orders.size(), orders) << "nobody gave an order";
  ExpectEveryPermitRestsOnAFreshSlice();
}

TEST_F(RespawnTest, WithoutASheriffNothingChanges) {
  StartWholeGraph();
  const auto sessions = Sessions();
  std::map<std::string, std::int32_t> pids;
  for (const char* name : kNames) pids[name] = graph_.PidOf(name);

  graph_.DismissSheriff();
  ProcmanPeer observer(url_ + "?ttl=0", "observer:1:1");
  const auto& deputy = observer.health[RunningGraph::kDeputy];
  ASSERT_TRUE(observer.Await([&] { return deputy.orders_age_us > 5 * kSecond; }));

  EXPECT_TRUE(AwaitWhole()) << Describe();
  EXPECT_EQ(Sessions(), sessions);
  for (const char* name : kNames) {
    EXPECT_EQ(observer.Command(RunningGraph::kDeputy, name).pid, pids[name]) << name;
    EXPECT_EQ(observer.HealthOf(RunningGraph::kDeputy, name).starts, 1) << name;
  }
  EXPECT_TRUE(observer.orders.empty());
}

}  // namespace
}  // namespace clearway::test
