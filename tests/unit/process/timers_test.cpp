// SPDX-License-Identifier: BSD-3-Clause
#include "common/process/timers.hpp"

#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace clearway::process {
namespace {

using testing::ElementsAre;

void RunAllDue(Timers& timers, std::int64_t now_us) {
  while (timers.RunOne(now_us)) {
  }
}

TEST(TimersTest, RunInOrderOfTheirDueTimeThenOfTheirAge) {
  Timers timers;
  std::vector<int> order;
  timers.Add(20, 0, [&] { order.push_back(3); });
  timers.Add(10, 0, [&] { order.push_back(1); });
  timers.Add(10, 0, [&] { order.push_back(2); });

  RunAllDue(timers, 20);

  EXPECT_THAT(order, ElementsAre(1, 2, 3));
  EXPECT_FALSE(timers.NextDue().has_value());
}

TEST(TimersTest, DoNotRunBeforeTheyAreDue) {
  Timers timers;
  int calls = 0;
  timers.Add(10, 0, [&] { ++calls; });

  EXPECT_FALSE(timers.RunOne(9));
  EXPECT_EQ(calls, 0);
}

TEST(TimersTest, APeriodicTimerKeepsItsGridAndMakesUpForNothing) {
  Timers timers;
  int calls = 0;
  timers.Add(10, 10, [&] { ++calls; });

  RunAllDue(timers, 57);

  EXPECT_EQ(calls, 1);
  EXPECT_EQ(timers.NextDue(), 60);
}

TEST(TimersTest, ACallbackMayCancelItsOwnTimer) {
  Timers timers;
  Timers::Id id = 0;
  int calls = 0;
  id = timers.Add(10, 10, [&] {
    ++calls;
    timers.Cancel(id);
  });

  RunAllDue(timers, 10);
  RunAllDue(timers, 100);

  EXPECT_EQ(calls, 1);
}

TEST(TimersTest, ACallbackMayAddTimers) {
  Timers timers;
  std::vector<int> order;
  timers.Add(10, 0, [&] {
    order.push_back(1);
    timers.Add(10, 0, [&] { order.push_back(2); });
  });

  RunAllDue(timers, 10);

  EXPECT_THAT(order, ElementsAre(1, 2));
}

TEST(TimersTest, ATimerWhoseCallbackThrowsStaysOnItsGrid) {
  Timers timers;
  timers.Add(10, 10, [] { throw std::runtime_error("broken"); });

  EXPECT_THROW(timers.RunOne(10), std::runtime_error);

  EXPECT_EQ(timers.NextDue(), 20);
}

}  // namespace
}  // namespace clearway::process
