// SPDX-License-Identifier: BSD-3-Clause
#include "common/core/procman/deputy.hpp"

#include <csignal>
#include <limits>
#include <random>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/fake_commands.hpp"

namespace clearway::core::procman {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::Pair;

constexpr std::int64_t kSecond = 1'000'000;
constexpr int kExitOne = 1 << 8;
const StatusWord kReadyWord{.is_fault = false, .is_ready = true, .text = ""};

class DeputyTest : public testing::Test {
 protected:
  DesiredCommand Wanted(const std::string& id, std::int32_t run_id, bool force_quit = false) const {
    CommandSpec spec;
    spec.id = id;
    spec.exec = "sleep 50";
    spec.auto_respawn = auto_respawn_;
    spec.stop_time_allowed_s = 2.0F;
    return {.spec = spec, .run_id = run_id, .force_quit = force_quit};
  }

  OrdersOutcome Order(std::vector<DesiredCommand> commands, const std::string& sheriff = "s") {
    return deputy_.Take({.utime = ++utime_,
                         .deputy_id = "d",
                         .sheriff_id = sheriff,
                         .commands = std::move(commands)},
                        now_us_);
  }

  void End(const std::string& id, int wait_status) {
    const std::int32_t pid = commands_.PidOf(id);
    ASSERT_NE(pid, 0) << id << " does not run";
    commands_.running.erase(pid);
    deputy_.OnExit(pid, wait_status, now_us_);
  }

  void RunUntil(std::int64_t time_us) {
    for (auto due_us = deputy_.NextDue(); due_us && *due_us <= time_us;
         due_us = deputy_.NextDue()) {
      now_us_ = std::max(now_us_, *due_us);
      deputy_.Tick(now_us_);
    }
    now_us_ = time_us;
  }

  [[nodiscard]] CommandHealthReport HealthOf(const std::string& id) const {
    for (const CommandHealthReport& report : deputy_.Health(now_us_)) {
      if (report.id == id) return report;
    }
    return {};
  }
  [[nodiscard]] CommandReport ReportOf(const std::string& id) const {
    for (const CommandReport& report : deputy_.Reports()) {
      if (report.spec.id == id) return report;
    }
    return {};
  }

  bool auto_respawn_ = false;
  std::int64_t now_us_ = 10 * kSecond;
  std::int64_t utime_ = 1'000'000'000;
  test::FakeCommands commands_;
  Deputy deputy_{"d", RespawnConfig{}, HealthConfig{}, commands_};
};

TEST_F(DeputyTest, RunIdZeroStartsNothing) {
  Order({Wanted("a", 0)});

  EXPECT_TRUE(commands_.started.empty());
  EXPECT_EQ(ReportOf("a").pid, 0);
}

TEST_F(DeputyTest, ANewRunIdStartsAndARepeatedOneDoesNothing) {
  Order({Wanted("a", 7)});
  Order({Wanted("a", 7)});

  EXPECT_THAT(commands_.started, ElementsAre("a"));
  EXPECT_EQ(ReportOf("a").run_id, 7);
  EXPECT_EQ(ReportOf("a").pid, commands_.PidOf("a"));
}

TEST_F(DeputyTest, OneOrderIsEnoughForARestart) {
  Order({Wanted("a", 1)});
  const std::int32_t first = commands_.PidOf("a");

  Order({Wanted("a", 2)});
  EXPECT_THAT(commands_.signals, ElementsAre(Pair(first, SIGINT)));
  EXPECT_THAT(commands_.started, ElementsAre("a"));
  End("a", SIGINT);

  EXPECT_THAT(commands_.started, ElementsAre("a", "a"));
  EXPECT_EQ(ReportOf("a").run_id, 2);
}

TEST_F(DeputyTest, OneOrderIsEnoughForSigkillAfterTheStopTime) {
  Order({Wanted("a", 1)});
  const std::int32_t pid = commands_.PidOf("a");
  Order({Wanted("a", 1, true)});

  RunUntil(now_us_ + 2 * kSecond - 1);
  EXPECT_THAT(commands_.signals, ElementsAre(Pair(pid, SIGINT)));
  RunUntil(now_us_ + 1);

  EXPECT_THAT(commands_.signals, ElementsAre(Pair(pid, SIGINT), Pair(pid, SIGKILL)));
  End("a", SIGKILL);
  EXPECT_EQ(HealthOf("a").state, CommandState::kStopped);
  EXPECT_FALSE(deputy_.NextDue().has_value());
}

TEST_F(DeputyTest, AStopThatIsTakenBackKillsNobody) {
  Order({Wanted("a", 1)});
  Order({Wanted("a", 1, true)});
  Order({Wanted("a", 1)});

  RunUntil(now_us_ + 60 * kSecond);

  EXPECT_EQ(commands_.signals.size(), 1U);
  EXPECT_EQ(HealthOf("a").state, CommandState::kRunning);
}

TEST_F(DeputyTest, AStoppedCommandTakesTheNewRunIdWithoutARun) {
  Order({Wanted("a", 5, true)});

  EXPECT_TRUE(commands_.started.empty());
  EXPECT_EQ(ReportOf("a").run_id, 5);
}

TEST_F(DeputyTest, WhatTheOrdersLackIsStoppedAndForgotten) {
  Order({Wanted("a", 1), Wanted("b", 1)});

  Order({Wanted("b", 1)});
  EXPECT_EQ(deputy_.Reports().size(), 2U) << "a still runs";
  End("a", SIGINT);

  EXPECT_EQ(deputy_.Reports().size(), 1U);
  Order({});
  End("b", SIGINT);
  EXPECT_TRUE(deputy_.Reports().empty());
}

TEST_F(DeputyTest, ACommandThatComesBackWhileItIsRemovedIsKeptAndStartedAnew) {
  Order({Wanted("a", 1)});
  Order({});

  Order({Wanted("a", 2)});
  End("a", SIGINT);

  EXPECT_EQ(ReportOf("a").run_id, 2);
  EXPECT_NE(commands_.PidOf("a"), 0);
}

TEST_F(DeputyTest, WithoutRespawnAnEndIsAnEnd) {
  Order({Wanted("a", 1)});

  End("a", kExitOne);
  RunUntil(now_us_ + 60 * kSecond);
  Order({Wanted("a", 1)});

  EXPECT_THAT(commands_.started, ElementsAre("a"));
  EXPECT_EQ(ReportOf("a").exit_code, kExitOne);
  EXPECT_EQ(HealthOf("a").state, CommandState::kEnded);
  EXPECT_TRUE(deputy_.ToKeep().front().force_quit) << "a later life must not run it again";
}

TEST_F(DeputyTest, ACrashLoopBacksOffFromTheExitDoublesAndGivesUp) {
  auto_respawn_ = true;
  Order({Wanted("a", 1)});

  std::vector<std::int64_t> pauses_ms;
  while (commands_.PidOf("a") != 0) {
    now_us_ += 300'000;
    End("a", kExitOne);
    const std::int64_t ended_us = now_us_;
    const auto due_us = deputy_.NextDue();
    if (!due_us) break;
    RunUntil(*due_us);
    pauses_ms.push_back((now_us_ - ended_us) / 1000);
  }

  EXPECT_THAT(pauses_ms, ElementsAre(100, 200, 400, 800, 1600, 3200, 6400, 10000, 10000));
  EXPECT_EQ(HealthOf("a").state, CommandState::kGaveUp);
  EXPECT_EQ(HealthOf("a").quick_deaths, 10);
  EXPECT_THAT(HealthOf("a").text, HasSubstr("exited with 1; gave up after 10"));
  Order({Wanted("a", 1)});
  EXPECT_EQ(commands_.PidOf("a"), 0) << "the same run id does not start it";
  Order({Wanted("a", 2)});
  EXPECT_NE(commands_.PidOf("a"), 0);
  EXPECT_EQ(HealthOf("a").quick_deaths, 0);
}

TEST_F(DeputyTest, ALongLifeForgivesEarlyDeaths) {
  auto_respawn_ = true;
  Order({Wanted("a", 1)});
  End("a", kExitOne);
  RunUntil(now_us_ + kSecond);

  now_us_ += 6 * kSecond;
  End("a", kExitOne);
  RunUntil(now_us_);

  EXPECT_NE(commands_.PidOf("a"), 0) << "started again at once";
  EXPECT_EQ(HealthOf("a").quick_deaths, 0);
}

TEST_F(DeputyTest, AStopEndsTheBackOff) {
  auto_respawn_ = true;
  Order({Wanted("a", 1)});
  End("a", kExitOne);
  ASSERT_EQ(HealthOf("a").state, CommandState::kBackingOff);

  Order({Wanted("a", 1, true)});
  RunUntil(now_us_ + 60 * kSecond);

  EXPECT_EQ(HealthOf("a").state, CommandState::kStopped);
  EXPECT_THAT(commands_.started, ElementsAre("a"));
}

TEST_F(DeputyTest, WhatIsRefusedIsAnErrorWithItsReasonAndIsNotTriedAgain) {
  auto_respawn_ = true;
  commands_.next.problem = "no rule allows it";
  commands_.next.is_refused = true;

  Order({Wanted("a", 1)});
  RunUntil(now_us_ + 60 * kSecond);

  EXPECT_EQ(commands_.started.size(), 1U);
  EXPECT_EQ(HealthOf("a").state, CommandState::kRefused);
  EXPECT_EQ(HealthOf("a").text, "no rule allows it");
  EXPECT_EQ(ReportOf("a").run_id, 1);
  EXPECT_NE(ReportOf("a").exit_code, 0) << "the reference's sheriff shows an error";
}

TEST_F(DeputyTest, AMissingProgramIsTriedAgainUntilItIsGivenUp) {
  auto_respawn_ = true;
  commands_.next.problem = "no such program";

  Order({Wanted("a", 1)});
  RunUntil(now_us_ + 600 * kSecond);

  EXPECT_EQ(commands_.started.size(), 10U);
  EXPECT_EQ(HealthOf("a").state, CommandState::kGaveUp);
  EXPECT_EQ(ReportOf("a").exit_code, 255 << 8);
}

TEST_F(DeputyTest, OrdersOfASheriffMustGrowInTime) {
  Order({Wanted("a", 1)}, "s");
  utime_ -= 2;

  EXPECT_EQ(Order({}, "s"), OrdersOutcome::kStale);
  EXPECT_EQ(deputy_.Reports().size(), 1U);
  EXPECT_EQ(Order({}, "s"), OrdersOutcome::kRepeated);
  EXPECT_EQ(Order({}, "s"), OrdersOutcome::kTaken);
}

TEST_F(DeputyTest, ASheriffWhoseClockWasSetBackIsObeyedAgainAfterAWhile) {
  utime_ = std::numeric_limits<std::int64_t>::max() - 1;
  Order({Wanted("a", 1)}, "s");
  utime_ = 1'000'000;

  for (int second = 0; second < 9; ++second) {
    RunUntil(now_us_ + kSecond);
    EXPECT_EQ(Order({}, "s"), OrdersOutcome::kStale) << second;
  }
  RunUntil(now_us_ + kSecond);
  EXPECT_EQ(Order({Wanted("a", 2)}, "s"), OrdersOutcome::kTaken);
  EXPECT_EQ(Order({Wanted("a", 2)}, "s"), OrdersOutcome::kTaken) << "and from then on it grows";
  utime_ -= 2;
  EXPECT_EQ(Order({}, "s"), OrdersOutcome::kStale);
}

TEST_F(DeputyTest, AClockThatIsAnHourOffChangesNothing) {
  for (const std::int64_t off_us : {-3600 * kSecond, 0 * kSecond, 3600 * kSecond}) {
    utime_ = 1'000'000'000'000 + off_us;

    EXPECT_EQ(Order({Wanted("a", 1)}, "sheriff " + std::to_string(off_us)), OrdersOutcome::kTaken);
  }
  EXPECT_THAT(commands_.started, ElementsAre("a"));
}

TEST_F(DeputyTest, TwoSheriffsAreToldAndTheLastOneIsObeyed) {
  Order({Wanted("a", 1)}, "one");
  now_us_ += 10;
  Order({Wanted("a", 1, true)}, "two");
  EXPECT_EQ(deputy_.ledger().Rival(now_us_), "") << "one may have ended";
  now_us_ += 10;
  Order({Wanted("a", 1)}, "one");
  now_us_ += 10;
  Order({Wanted("a", 1, true)}, "two");

  EXPECT_EQ(deputy_.ledger().current(), "two");
  EXPECT_EQ(deputy_.ledger().Rival(now_us_), "one");
  EXPECT_EQ(HealthOf("a").state, CommandState::kStopping);
  EXPECT_EQ(deputy_.ledger().Rival(now_us_ + 4 * kSecond), "");
}

TEST_F(DeputyTest, ManySheriffIdsDoNotGrowTheLedgerForEver) {
  for (int i = 0; i < 100'000; ++i) Order({Wanted("a", 1)}, "sheriff " + std::to_string(i));

  EXPECT_EQ(deputy_.ledger().current(), "sheriff 99999");
  EXPECT_THAT(commands_.started, ElementsAre("a"));
}

TEST_F(DeputyTest, OrdersForOthersAndBrokenOnesAreLeftAlone) {
  EXPECT_EQ(
      deputy_.Take({.utime = 1, .deputy_id = "D", .sheriff_id = "s", .commands = {}}, now_us_),
      OrdersOutcome::kForOther);
  EXPECT_EQ(Order({Wanted("", 1)}), OrdersOutcome::kInvalid);
  EXPECT_EQ(Order({Wanted("a", 1), Wanted("a", 2)}), OrdersOutcome::kInvalid);
  const std::string too_long(Deputy::kMaxIdBytes + 1, 'x');
  EXPECT_EQ(Order({Wanted(too_long, 1)}), OrdersOutcome::kInvalid);
  EXPECT_EQ(Order({Wanted("a", 1)}, too_long), OrdersOutcome::kInvalid);
  EXPECT_FALSE(deputy_.has_orders());
}

TEST_F(DeputyTest, StopTimesAndSignalsThatMakeNoSenseAreReplacedAndNamed) {
  const float nan = std::numeric_limits<float>::quiet_NaN();
  for (const float time_s : {-1.0F, nan, 1e30F}) {
    DesiredCommand wanted = Wanted("a", 1);
    wanted.spec.stop_time_allowed_s = time_s;
    wanted.spec.stop_signal = -3;
    Order({wanted});

    EXPECT_FLOAT_EQ(ReportOf("a").spec.stop_time_allowed_s, 7.0F);
    EXPECT_EQ(ReportOf("a").spec.stop_signal, SIGINT);
    EXPECT_THAT(HealthOf("a").text, HasSubstr("stop_time_allowed"));
  }
}

TEST_F(DeputyTest, ShutDownStopsOneAfterTheOtherInReverseOrderOfTheirStarts) {
  auto_respawn_ = true;
  Order({Wanted("z", 1)});
  now_us_ += 10;
  Order({Wanted("z", 1), Wanted("a", 1)});
  now_us_ += 10;
  Order({Wanted("z", 1), Wanted("a", 1), Wanted("m", 1)});
  const std::int32_t z = commands_.PidOf("z");
  const std::int32_t a = commands_.PidOf("a");
  const std::int32_t m = commands_.PidOf("m");

  deputy_.ShutDown(now_us_);
  EXPECT_THAT(commands_.signals, ElementsAre(Pair(m, SIGINT)));
  RunUntil(now_us_ + 2 * kSecond);
  EXPECT_THAT(commands_.signals.back(), Pair(m, SIGKILL)) << "its own stop time is honoured";
  End("m", SIGKILL);
  EXPECT_THAT(commands_.signals.back(), Pair(a, SIGINT));
  End("z", kExitOne);
  EXPECT_FALSE(deputy_.IsDone());
  EXPECT_EQ(Order({Wanted("a", 2)}), OrdersOutcome::kShuttingDown);
  End("a", 0);

  EXPECT_TRUE(deputy_.IsDone());
  EXPECT_EQ(commands_.PidOf("z"), 0) << "not started again";
  EXPECT_EQ(commands_.started.size(), 3U);
  (void)z;
}

TEST_F(DeputyTest, WhatShutDownEndsIsNotToldAsStoppedByOrder) {
  Order({Wanted("a", 1), Wanted("b", 1), Wanted("done", 1)});
  End("done", 0);
  Order({Wanted("a", 1), Wanted("b", 1, true), Wanted("done", 1)});
  End("b", 0);

  deputy_.ShutDown(now_us_);
  End("a", 0);

  EXPECT_EQ(HealthOf("a").state, CommandState::kStopping) << "a sheriff would keep it down";
  EXPECT_EQ(HealthOf("b").state, CommandState::kStopped);
  EXPECT_EQ(HealthOf("done").state, CommandState::kEnded);
}

TEST_F(DeputyTest, AStatusMakesReadyAndSilenceMakesUnhealthy) {
  commands_.next.status_channel = "X_STATUS";
  Order({Wanted("a", 1)});
  const std::int32_t pid = commands_.PidOf("a");
  EXPECT_FALSE(IsReady(HealthOf("a")));

  deputy_.OnStatus("X_STATUS", pid + 1, kReadyWord, now_us_);
  deputy_.OnStatus("Y_STATUS", pid, kReadyWord, now_us_);
  EXPECT_FALSE(IsReady(HealthOf("a"))) << "another process, another channel";
  deputy_.OnStatus(
      "X_STATUS", pid, StatusWord{.is_fault = false, .is_ready = true, .text = "working"}, now_us_);
  EXPECT_TRUE(IsReady(HealthOf("a")));
  deputy_.OnStatus("X_STATUS",
                   pid,
                   StatusWord{.is_fault = true, .is_ready = false, .text = "no sensor"},
                   now_us_);
  EXPECT_EQ(HealthOf("a").health, CommandHealth::kUnhealthy);
  EXPECT_EQ(HealthOf("a").text, "no sensor");
  deputy_.OnStatus("X_STATUS", pid, kReadyWord, now_us_);
  RunUntil(now_us_ + 4 * kSecond);

  EXPECT_EQ(HealthOf("a").health, CommandHealth::kUnhealthy);
  EXPECT_TRUE(commands_.signals.empty()) << "only reported";
}

TEST_F(DeputyTest, AnUnhealthyCommandIsStartedAnewWhereItIsAskedFor) {
  commands_.next.status_channel = "X_STATUS";
  commands_.next.restart_unhealthy_us = 5 * kSecond;
  Order({Wanted("a", 1)});
  const std::int32_t pid = commands_.PidOf("a");
  deputy_.OnStatus("X_STATUS", pid, kReadyWord, now_us_);

  RunUntil(now_us_ + 8 * kSecond - 1);
  EXPECT_TRUE(commands_.signals.empty());
  RunUntil(now_us_ + 1);
  EXPECT_THAT(commands_.signals, ElementsAre(Pair(pid, SIGINT)));
  Order({Wanted("a", 1)});
  End("a", SIGINT);
  RunUntil(now_us_ + kSecond);

  EXPECT_EQ(commands_.started.size(), 2U);
  EXPECT_EQ(HealthOf("a").health, CommandHealth::kNotReady);
}

TEST_F(DeputyTest, ALaterLifeCarriesOnWithWhatRanAndNotWithWhatHadEnded) {
  Order({Wanted("runs", 3), Wanted("ended", 2), Wanted("stopped", 4, true)});
  End("ended", 0);
  const std::vector<DesiredCommand> kept = deputy_.ToKeep();

  test::FakeCommands commands;
  Deputy later("d", RespawnConfig{}, HealthConfig{}, commands);
  later.Resume(kept, 0);

  EXPECT_THAT(commands.started, ElementsAre("runs"));
  EXPECT_EQ(later.ToKeep(), kept);
  later.Take(
      {.utime = 1,
       .deputy_id = "d",
       .sheriff_id = "s",
       .commands = {Wanted("runs", 3), Wanted("ended", 2, true), Wanted("stopped", 4, true)}},
      0);
  EXPECT_THAT(commands.started, ElementsAre("runs"))
      << "a sheriff with the same ids starts nothing";
}

// Whatever is ordered, dies and is lost: one process a command at most, and in the end what the
// last order says.
TEST_F(DeputyTest, AnyOrdersAndDeathsLeadToWhatTheLastOrderSays) {
  for (unsigned seed = 0; seed < 200; ++seed) {
    std::mt19937 random(seed);
    const auto any = [&random](int most) { return static_cast<int>(random() % unsigned(most)); };
    test::FakeCommands commands;
    Deputy deputy("d", RespawnConfig{.give_up_after = 1000}, HealthConfig{}, commands);
    const std::vector<std::string> ids{"a", "b", "c"};
    std::vector<DesiredCommand> last;
    std::int64_t now_us = 0;
    for (int step = 1; step <= 100; ++step) {
      now_us += any(3'000'000);
      deputy.Tick(now_us);
      if (any(2) == 0) {
        last.clear();
        for (const std::string& id : ids) {
          auto_respawn_ = any(2) == 0;
          if (any(4) != 0) last.push_back(Wanted(id, 1 + any(4), any(3) == 0));
        }
        deputy.Take({.utime = step, .deputy_id = "d", .sheriff_id = "s", .commands = last}, now_us);
      }
      if (any(2) == 0 && !commands.running.empty()) {
        const std::int32_t pid = commands.running.begin()->first;
        commands.running.erase(pid);
        deputy.OnExit(pid, any(2) == 0 ? 0 : kExitOne, now_us);
      }
      ASSERT_FALSE(commands.HasTwins()) << "seed " << seed << ", step " << step;
    }

    // A new run is ordered of all that may run, and everything that was told to end does.
    for (DesiredCommand& wanted : last) wanted.run_id = 1000;
    deputy.Take({.utime = 101, .deputy_id = "d", .sheriff_id = "s", .commands = last}, now_us);
    for (int round = 0; round < 5; ++round) {
      now_us += 30 * kSecond;
      deputy.Tick(now_us);
      const auto running = commands.running;
      for (const auto& [pid, id] : running) {
        const ManagedCommand* const command = deputy.CommandOf(pid);
        if (command->Health(now_us).state != CommandState::kStopping) continue;
        commands.running.erase(pid);
        deputy.OnExit(pid, SIGINT, now_us);
      }
    }

    for (const std::string& id : ids) {
      const auto wanted = std::find_if(
          last.begin(), last.end(), [&id](const DesiredCommand& w) { return w.spec.id == id; });
      const bool may_run = wanted != last.end() && !wanted->force_quit;
      if (!may_run) {
        EXPECT_EQ(commands.PidOf(id), 0) << "seed " << seed << ' ' << id;
      } else {
        EXPECT_NE(commands.PidOf(id), 0) << "seed " << seed << ' ' << id;
      }
    }
  }
}

}  // namespace
}  // namespace clearway::core::procman
