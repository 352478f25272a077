// SPDX-License-Identifier: BSD-3-Clause
// A session of the reference procman, watched by an observer.
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "common/core/procman/sheriff.hpp"
#include "common/io/lcm_log.hpp"
#include "common/messages/channels.hpp"
#include "common/messages/encoding.hpp"
#include "common/messages/procman.hpp"
#include "tests/support/test_data.hpp"

namespace clearway::core::procman {
namespace {

constexpr const char* kSession = "lcm/procman_ref_session.lcmlog";
constexpr std::int64_t kStartUtime = 1795418362180950;

void Feed(const io::LogEvent& event, Sheriff& sheriff, std::int64_t now_us) {
  if (event.channel == "PM_INFO") {
    const auto message = messages::Decode<procman_lcm::deputy_info_t>(event.bytes);
    sheriff.OnReport(messages::FromLcm(message.value()), now_us);
  } else if (event.channel == "PM_ORDERS") {
    const auto message = messages::Decode<procman_lcm::orders_t>(event.bytes);
    sheriff.OnForeignOrders(messages::FromLcm(message.value()), now_us);
  }
}

// "+ms who: from > to (text)"
std::string Line(const Change& change) {
  std::string line = "+" + std::to_string((change.utime - kStartUtime) / 1000) + " " +
                     (change.command.empty() ? change.deputy : change.command) + ": " +
                     change.from + " > " + change.to;
  return change.text.empty() ? line : line + " (" + change.text + ")";
}

// Sheriff 1 runs a script that starts all three commands, one of them twice; sheriff 2 stops them.
// The log says so: the stamps are those of the messages.
TEST(SheriffRecordedTest, TheHistoryOfTheReferencesSessionComesOut) {
  const auto path = test::TestData(kSession);
  if (!path) GTEST_SKIP() << test::MissingData(kSession);
  io::LcmLogReader log(*path);
  Sheriff observer("watches", Sheriff::Mode::kObserve);

  // Played at once, long after: neither the age of messages nor this clock matters.
  std::int64_t now_us = 77;
  while (const auto event = log.Next()) {
    Feed(*event, observer, now_us += 100);
    ASSERT_TRUE(observer.OrdersDue(now_us, event->utime).empty());
  }

  std::vector<std::string> lines;
  for (const Change& change : observer.history()) lines.push_back(Line(change));
  EXPECT_THAT(lines,
              testing::ElementsAre("+600 dep1: Silent > Heard",
                                   "+2420 dep1:  > vm:29483:1795418363600685",
                                   "+2420 lidar: Unknown > Stopped (not started yet)",
                                   "+2420 oneshot: Unknown > Starting",
                                   "+2420 top: Unknown > Stopped (not started yet)",
                                   "+2422 oneshot: Starting > Running",
                                   "+2431 oneshot: Running > Stopped (exited with 0)",
                                   "+2432 lidar: Stopped > Starting",
                                   "+2433 oneshot: Stopped > Starting",
                                   "+2435 lidar: Starting > Running",
                                   "+2438 oneshot: Starting > Running",
                                   "+2451 oneshot: Running > Stopped (exited with 0)",
                                   "+3033 top: Stopped > Starting",
                                   "+3034 top: Starting > Running",
                                   "+4481 dep1: vm:29483:1795418363600685 > "
                                   "vm:29514:1795418365661763",
                                   "+4481 lidar: Running > Stopping",
                                   "+4481 top: Running > Stopping",
                                   "+4486 lidar: Stopping > Stopped (killed by SIGINT)",
                                   "+4486 top: Stopping > Stopped (killed by SIGINT)"));
}

TEST(SheriffRecordedTest, TheEndOfTheReferencesSessionIsShown) {
  const auto path = test::TestData(kSession);
  if (!path) GTEST_SKIP() << test::MissingData(kSession);
  io::LcmLogReader log(*path);
  Sheriff observer("watches", Sheriff::Mode::kObserve);
  std::int64_t now_us = 0;
  while (const auto event = log.Next()) Feed(*event, observer, now_us += 100);

  const Snapshot snapshot = observer.Look(now_us);

  ASSERT_EQ(snapshot.commands.size(), 3U);
  EXPECT_EQ(snapshot.commands.at(1).id, "oneshot");
  EXPECT_EQ(snapshot.commands.at(1).group, "drivers/aux");
  EXPECT_EQ(snapshot.commands.at(1).run_id, 2);
  ASSERT_EQ(snapshot.groups.size(), 3U);
  EXPECT_EQ(snapshot.groups.at(1).path, "drivers");
  EXPECT_EQ(snapshot.groups.at(1).commands, 2);
  ASSERT_EQ(snapshot.deputies.size(), 1U);
  EXPECT_FALSE(snapshot.deputies.front().tells_health);
  EXPECT_NEAR(snapshot.deputies.front().cpu_load, 0.538, 0.001);
  EXPECT_EQ(snapshot.other.value().id, "vm:29514:1795418365661763");
}

}  // namespace
}  // namespace clearway::core::procman
