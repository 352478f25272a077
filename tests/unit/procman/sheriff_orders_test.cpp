// SPDX-License-Identifier: BSD-3-Clause
// What a sheriff tells the reference's deputy, and what comes of it.
#include <algorithm>
#include <limits>
#include <map>
#include <stdexcept>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "common/core/procman/run_id.hpp"
#include "tests/unit/procman/sheriff_bed.hpp"

namespace clearway::core::procman {
namespace {

using test::Deployed;
using test::Deploying;
using test::Everything;
using test::SheriffBed;
using test::TheCommand;
using test::TheGroup;

DeputyReport ReportOf(const std::string& deputy, std::vector<CommandReport> commands = {}) {
  DeputyReport report;
  report.utime = 1;
  report.deputy_id = deputy;
  report.commands = std::move(commands);
  return report;
}

CommandReport Reported(const DeployedCommand& command, std::int32_t pid, std::int32_t run_id) {
  CommandReport report;
  report.spec = command.spec;
  report.pid = pid;
  report.run_id = run_id;
  return report;
}

TEST(RunIdTest, NeverIsZeroOrNegative) {
  constexpr std::int32_t kLast = std::numeric_limits<std::int32_t>::max();

  EXPECT_EQ(NextRunId(0), 1);
  EXPECT_EQ(NextRunId(1), 2);
  EXPECT_EQ(NextRunId(kLast - 1), kLast);
  EXPECT_EQ(NextRunId(kLast), 1);
  EXPECT_EQ(NextRunId(-7), 1);
  EXPECT_EQ(NextRunId(std::numeric_limits<std::int32_t>::min()), 1);
}

TEST(SheriffOrdersTest, NothingIsSentToADeputyThatWasNotHeard) {
  Sheriff sheriff("s", Sheriff::Mode::kCommand);
  sheriff.Load(Deploying({Deployed("a", "dep1"), Deployed("b", "dep2")}), 0);
  sheriff.Start(Everything(), 0);

  EXPECT_TRUE(sheriff.OrdersDue(0, 100).empty());
  sheriff.OnReport(ReportOf("dep2"), 1000);
  const std::vector<Orders> due = sheriff.OrdersDue(1000, 101);

  ASSERT_EQ(due.size(), 1U);
  EXPECT_EQ(due.front().deputy_id, "dep2");
  EXPECT_EQ(due.front().sheriff_id, "s");
  ASSERT_EQ(due.front().commands.size(), 1U);
  EXPECT_EQ(due.front().commands.front().run_id, 1);
}

TEST(SheriffOrdersTest, OrdersAreCompleteAtOneHertzAndAtOnceAfterAChange) {
  SheriffBed bed({"dep1"});
  Sheriff& sheriff = bed.AddSheriff("s");
  sheriff.Load(Deploying({Deployed("a", "dep1"), Deployed("b", "dep1")}), bed.now_us());
  bed.Run(3'005'000);
  const std::size_t quiet = bed.orders().size();
  sheriff.Start(TheCommand("b"), bed.now_us());
  bed.Step();

  EXPECT_GE(quiet, 3U);
  EXPECT_LE(quiet, 5U);
  ASSERT_EQ(bed.orders().size(), quiet + 1);
  EXPECT_EQ(bed.orders().back().commands.size(), 2U);
}

TEST(SheriffOrdersTest, StampsGrowAlsoWhenTheClockIsSetBack) {
  Sheriff sheriff("s", Sheriff::Mode::kCommand);
  sheriff.OnReport(ReportOf("dep1"), 0);
  sheriff.OnReport(ReportOf("dep2"), 0);

  std::int64_t last = 0;
  std::int64_t now_us = 0;
  for (const std::int64_t utime : {5000, 5000, 400, 401, 6000}) {
    for (const Orders& orders : sheriff.OrdersDue(now_us, utime)) {
      EXPECT_GT(orders.utime, last);
      last = orders.utime;
    }
    now_us += 1'000'000;
  }
  EXPECT_EQ(last, 6001);
}

TEST(SheriffOrdersTest, StartRunsStopStopsAndRestartRunsAnew) {
  SheriffBed bed({"dep1"});
  Sheriff& sheriff = bed.AddSheriff("s");
  sheriff.Load(Deploying({Deployed("a", "dep1", "run", "g"), Deployed("b", "dep1")}), bed.now_us());

  EXPECT_EQ(sheriff.Start(TheGroup("g"), bed.now_us()), 1);
  bed.Run(2'000'000);
  EXPECT_TRUE(bed.deputy("dep1").IsUp("a"));
  EXPECT_FALSE(bed.deputy("dep1").IsUp("b"));
  sheriff.Start(TheGroup("g"), bed.now_us());
  bed.Run(2'000'000);
  EXPECT_EQ(bed.deputy("dep1").StartsOf("a"), 1) << "a start of what runs is no restart";
  sheriff.Restart(TheCommand("a"), bed.now_us());
  bed.Run(2'000'000);
  EXPECT_EQ(bed.deputy("dep1").StartsOf("a"), 2);
  EXPECT_EQ(bed.StatusOf(sheriff, "a"), Status::kRunning);
  sheriff.Stop(Everything(), bed.now_us());
  bed.Run(2'000'000);

  EXPECT_FALSE(bed.deputy("dep1").IsUp("a"));
  EXPECT_EQ(bed.StatusOf(sheriff, "a"), Status::kStopped);
  EXPECT_EQ(bed.deputy("dep1").StartsOf("b"), 0);
}

TEST(SheriffOrdersTest, TheSecondHalfOfARestartNeedsNoSecondToPass) {
  SheriffBed bed({"dep1"});
  Sheriff& sheriff = bed.AddSheriff("s");
  sheriff.Load(Deploying({Deployed("a", "dep1")}), bed.now_us());
  sheriff.Start(Everything(), bed.now_us());
  bed.Run(1'500'000);

  sheriff.Restart(Everything(), bed.now_us());

  EXPECT_TRUE(bed.RunUntil([&] { return bed.deputy("dep1").StartsOf("a") == 2; }, 100'000));
}

TEST(SheriffOrdersTest, RepeatedOrdersKillWhatIgnoresItsSignal) {
  SheriffBed bed({"dep1"});
  Sheriff& sheriff = bed.AddSheriff("s");
  sheriff.Load(Deploying({Deployed("a", "dep1", "stubborn")}), bed.now_us());
  sheriff.Start(Everything(), bed.now_us());
  bed.Run(500'000);

  sheriff.Stop(Everything(), bed.now_us());
  bed.Run(500'000);
  EXPECT_EQ(bed.StatusOf(sheriff, "a"), Status::kStopping);
  EXPECT_TRUE(bed.RunUntil([&] { return !bed.deputy("dep1").IsUp("a"); }, 2'000'000));
  bed.Run(100'000);

  const auto view = sheriff.View("a", bed.now_us());
  EXPECT_EQ(view->status, Status::kStopped);
  EXPECT_EQ(view->text, "killed by SIGKILL");
}

// The new sheriff knows the same file, another file, or none.
TEST(SheriffOrdersTest, TakingOverRestartsNothing) {
  SheriffBed bed({"dep1", "dep2"});
  Sheriff& first = bed.AddSheriff("first");
  const Deployment deployment = Deploying({Deployed("runs", "dep1", "run", "", true),
                                           Deployed("was stopped", "dep1", "run", "", true),
                                           Deployed("done", "dep2", "end 0 20"),
                                           Deployed("failed", "dep2", "end 3 20"),
                                           Deployed("never", "dep2")});
  first.Load(deployment, bed.now_us());
  first.Start(Everything(), bed.now_us());
  bed.Run(1'000'000);
  first.Stop(TheCommand("was stopped"), bed.now_us());
  first.Restart(TheCommand("runs"), bed.now_us());
  first.Stop(TheCommand("never"), bed.now_us());
  bed.Run(2'000'000);
  bed.RemoveSheriff(first);
  const auto runs_before = bed.deputy("dep1").runs().size() + bed.deputy("dep2").runs().size();

  for (const bool with_file : {true, false, true}) {
    Sheriff& next = bed.AddSheriff(with_file ? "with file" : "without");
    if (with_file) next.Load(deployment, bed.now_us());
    bed.Run(5'000'000);
    EXPECT_EQ(bed.StatusOf(next, "runs"), Status::kRunning);
    EXPECT_EQ(bed.StatusOf(next, "was stopped"), Status::kStopped);
    EXPECT_EQ(bed.StatusOf(next, "done"), Status::kStopped);
    EXPECT_EQ(bed.StatusOf(next, "failed"), Status::kFailed);
    bed.RemoveSheriff(next);
  }

  EXPECT_EQ(bed.deputy("dep1").runs().size() + bed.deputy("dep2").runs().size(), runs_before);
  EXPECT_TRUE(bed.deputy("dep1").IsUp("runs"));
}

TEST(SheriffOrdersTest, AStopBeforeTheFirstReportEndsAsStopped) {
  SheriffBed bed({"dep1"});
  Sheriff& first = bed.AddSheriff("first");
  first.Load(Deploying({Deployed("a", "dep1")}), bed.now_us());
  first.Start(Everything(), bed.now_us());
  bed.Run(1'000'000);
  bed.RemoveSheriff(first);

  Sheriff& second = bed.AddSheriff("second");
  second.Load(Deploying({Deployed("a", "dep1")}), bed.now_us());
  second.Stop(Everything(), bed.now_us());
  EXPECT_EQ(bed.StatusOf(second, "a"), Status::kUnknown);
  bed.Run(1'000'000);

  EXPECT_FALSE(bed.deputy("dep1").IsUp("a"));
  EXPECT_EQ(bed.StatusOf(second, "a"), Status::kStopped);
}

TEST(SheriffOrdersTest, AStartBeforeTheFirstReportRestartsNothingThatRuns) {
  SheriffBed bed({"dep1"});
  const Deployment deployment = Deploying({Deployed("a", "dep1"), Deployed("b", "dep1")});
  Sheriff& first = bed.AddSheriff("first");
  first.Load(deployment, bed.now_us());
  first.Start(TheCommand("a"), bed.now_us());
  bed.Run(1'000'000);
  bed.RemoveSheriff(first);

  Sheriff& second = bed.AddSheriff("second");
  second.Load(deployment, bed.now_us());
  second.Start(Everything(), bed.now_us());
  bed.Run(2'000'000);

  EXPECT_EQ(bed.deputy("dep1").StartsOf("a"), 1);
  EXPECT_EQ(bed.deputy("dep1").StartsOf("b"), 1);
}

TEST(SheriffOrdersTest, WhatEndedByItselfIsNotRunAgainByADeputyThatRestarts) {
  SheriffBed bed({"dep1"});
  Sheriff& sheriff = bed.AddSheriff("s");
  sheriff.Load(Deploying({Deployed("once", "dep1", "end 0 20"), Deployed("ever", "dep1")}),
               bed.now_us());
  sheriff.Start(Everything(), bed.now_us());
  bed.Run(1'000'000);

  bed.deputy("dep1").Reboot(bed.now_us());
  bed.Run(3'000'000);

  EXPECT_EQ(bed.deputy("dep1").StartsOf("once"), 1);
  EXPECT_EQ(bed.deputy("dep1").StartsOf("ever"), 2) << "what is to run runs again";
}

TEST(SheriffOrdersTest, RunIdsOfAnyKindAreTakenOverAndFollowed) {
  const DeployedCommand command = Deployed("a", "dep1");
  const std::map<std::int32_t, std::int32_t> next_of = {
      {5, 6}, {std::numeric_limits<std::int32_t>::max(), 1}, {-3, 1}, {0, 1}};
  for (const auto& [run_id, next] : next_of) {
    Sheriff sheriff("s", Sheriff::Mode::kCommand);
    sheriff.Load(Deploying({command}), 0);
    sheriff.OnReport(ReportOf("dep1", {Reported(command, 77, run_id)}), 0);
    EXPECT_EQ(sheriff.OrdersDue(0, 1).at(0).commands.at(0).run_id, run_id);

    sheriff.Restart(Everything(), 10);

    EXPECT_EQ(sheriff.OrdersDue(10, 2).at(0).commands.at(0).run_id, next) << run_id;
  }
}

// To a deputy, 0 is another run id than that of a run that is over: it would start.
TEST(SheriffOrdersTest, WhatHasRunIsNeverOrderedWithRunIdZero) {
  const DeployedCommand command = Deployed("a", "dep1");
  Sheriff sheriff("s", Sheriff::Mode::kCommand);
  sheriff.OnReport(ReportOf("dep1", {Reported(command, 0, 4)}), 0);
  sheriff.Load(Deploying({command}), 0);

  EXPECT_EQ(sheriff.OrdersDue(0, 1).at(0).commands.at(0).run_id, 4);
}

TEST(SheriffOrdersTest, RemovedCommandsAreLeftOutAndForgottenWhenTheyAreGone) {
  SheriffBed bed({"dep1"});
  Sheriff& sheriff = bed.AddSheriff("s");
  sheriff.Load(Deploying({Deployed("a", "dep1"), Deployed("b", "dep1", "stubborn")}), bed.now_us());
  sheriff.Start(Everything(), bed.now_us());
  bed.Run(1'000'000);

  sheriff.Remove(TheCommand("b"), bed.now_us());
  bed.Run(200'000);
  EXPECT_EQ(bed.StatusOf(sheriff, "b"), Status::kRemoving);
  EXPECT_EQ(bed.orders().back().commands.size(), 1U);
  bed.Run(3'000'000);

  EXPECT_FALSE(sheriff.View("b", bed.now_us()).has_value());
  EXPECT_FALSE(bed.deputy("dep1").Knows("b"));
  EXPECT_TRUE(bed.deputy("dep1").IsUp("a"));
}

TEST(SheriffOrdersTest, CommandsThatTheFileDoesNotHoldAreKeptUntilTheyAreAskedToStop) {
  SheriffBed bed({"dep1", "dep2"});
  Sheriff& other = bed.AddSheriff("other");
  other.Load(Deploying({Deployed("x", "dep1"), Deployed("y", "dep2")}), bed.now_us());
  other.Start(Everything(), bed.now_us());
  bed.Run(1'000'000);
  bed.RemoveSheriff(other);
  Sheriff& sheriff = bed.AddSheriff("s");
  sheriff.Load(Deploying({Deployed("a", "dep1")}), bed.now_us());

  sheriff.Restart(Everything(), bed.now_us());
  bed.Run(3'000'000);
  EXPECT_EQ(bed.deputy("dep1").StartsOf("x"), 1);
  EXPECT_TRUE(bed.deputy("dep1").IsUp("x"));
  EXPECT_TRUE(bed.deputy("dep2").IsUp("y"));
  EXPECT_FALSE(sheriff.View("x", bed.now_us())->is_in_file);
  sheriff.Stop(Everything(), bed.now_us());
  bed.Run(3'000'000);

  EXPECT_FALSE(bed.deputy("dep1").IsUp("x"));
  EXPECT_FALSE(bed.deputy("dep2").IsUp("y"));
}

TEST(SheriffOrdersTest, TheFilesAttributesTravelAndANewExecActsAtTheNextStart) {
  SheriffBed bed({"dep1"});
  Sheriff& old = bed.AddSheriff("old");
  old.Load(Deploying({Deployed("a", "dep1", "run")}), bed.now_us());
  old.Start(Everything(), bed.now_us());
  bed.Run(1'000'000);
  bed.RemoveSheriff(old);

  Sheriff& sheriff = bed.AddSheriff("s");
  sheriff.Load(Deploying({Deployed("a", "dep1", "stubborn", "g", true)}), bed.now_us());
  bed.Run(2'000'000);
  EXPECT_EQ(bed.deputy("dep1").Report(0).commands.at(0).spec.group, "g");
  EXPECT_EQ(bed.deputy("dep1").StartsOf("a"), 1);
  EXPECT_EQ(sheriff.View("a", bed.now_us())->differs, "runs \"run\" until it is restarted");
  sheriff.Restart(Everything(), bed.now_us());
  bed.Run(2'000'000);

  EXPECT_EQ(sheriff.View("a", bed.now_us())->differs, "");
  EXPECT_EQ(bed.deputy("dep1").runs().back().exec, "stubborn");
}

TEST(SheriffOrdersTest, AnObserverNeverGivesOrders) {
  SheriffBed bed({"dep1"});
  Sheriff& observer = bed.AddSheriff("watches", Sheriff::Mode::kObserve);
  observer.Load(Deploying({Deployed("a", "dep1")}), bed.now_us());
  Sheriff& sheriff = bed.AddSheriff("s");
  sheriff.Load(Deploying({Deployed("a", "dep1"), Deployed("b", "dep1")}), bed.now_us());
  sheriff.Start(Everything(), bed.now_us());
  bed.Run(2'000'000);

  EXPECT_EQ(bed.StatusOf(observer, "a"), Status::kRunning);
  EXPECT_EQ(bed.StatusOf(observer, "b"), Status::kRunning);
  for (const Orders& orders : bed.orders()) EXPECT_EQ(orders.sheriff_id, "s");
  EXPECT_THROW(observer.Start(Everything(), 0), std::logic_error);
  EXPECT_THROW(observer.Restart(Everything(), 0), std::logic_error);
  EXPECT_THROW(observer.Stop(Everything(), 0), std::logic_error);
  EXPECT_THROW(observer.Remove(Everything(), 0), std::logic_error);
  observer.RepeatOrders();
  EXPECT_TRUE(observer.OrdersDue(bed.now_us(), 1).empty());
}

TEST(SheriffOrdersTest, AnObserverTakesReportsOfAnyAgeAndMirrorsStops) {
  SheriffBed bed({"dep1"});
  Sheriff& observer = bed.AddSheriff("watches", Sheriff::Mode::kObserve);
  Sheriff& sheriff = bed.AddSheriff("s");
  sheriff.Load(Deploying({Deployed("a", "dep1", "stubborn")}), bed.now_us());
  sheriff.Start(Everything(), bed.now_us());
  bed.Run(1'000'000);
  sheriff.Stop(Everything(), bed.now_us());
  bed.Step();

  EXPECT_EQ(bed.StatusOf(observer, "a"), Status::kStopping);
  bed.Run(3'000'000);
  EXPECT_EQ(bed.StatusOf(observer, "a"), Status::kStopped) << "SIGKILL, but by order";
  bed.RemoveSheriff(sheriff);
  bed.Run(5'000'000);
  EXPECT_EQ(bed.StatusOf(observer, "a"), Status::kStopped) << "also when nobody commands any more";
}

TEST(SheriffOrdersTest, AnObserverBelievesReportsWhereTheOrdersDidNotReachIt) {
  SheriffBed bed({"dep1"});
  Sheriff& observer = bed.AddSheriff("watches", Sheriff::Mode::kObserve);
  Sheriff& sheriff = bed.AddSheriff("s");
  sheriff.Load(Deploying({Deployed("a", "dep1"), Deployed("b", "dep1")}), bed.now_us());
  sheriff.Start(Everything(), bed.now_us());
  bed.Run(1'000'000);
  sheriff.Stop(Everything(), bed.now_us());
  bed.Run(1'000'000);
  bed.RemoveSheriff(sheriff);
  bed.Run(4'000'000);
  // Straight to the deputy.
  Orders unheard;
  unheard.utime = SheriffBed::kEpoch + bed.now_us();
  unheard.deputy_id = "dep1";
  unheard.commands = {{.spec = Deployed("a", "dep1").spec, .run_id = 9, .force_quit = false}};
  bed.deputy("dep1").TakeOrders(unheard, bed.now_us(), unheard.utime);
  bed.Run(1'000'000);

  EXPECT_EQ(bed.StatusOf(observer, "a"), Status::kRunning);
  EXPECT_FALSE(observer.View("b", bed.now_us()).has_value()) << "the deputy has forgotten it";
}

TEST(SheriffOrdersTest, AnObserverThatTakesCommandRestartsNothing) {
  SheriffBed bed({"dep1"});
  Sheriff& observer = bed.AddSheriff("watches", Sheriff::Mode::kObserve);
  Sheriff& sheriff = bed.AddSheriff("s");
  sheriff.Load(Deploying({Deployed("a", "dep1"), Deployed("b", "dep1", "run", "", true)}),
               bed.now_us());
  sheriff.Start(Everything(), bed.now_us());
  bed.Run(1'000'000);
  sheriff.Stop(TheCommand("b"), bed.now_us());
  bed.Run(1'000'000);
  bed.RemoveSheriff(sheriff);

  observer.SetMode(Sheriff::Mode::kCommand);
  bed.Run(3'000'000);

  EXPECT_EQ(bed.deputy("dep1").runs().size(), 2U);
  EXPECT_EQ(bed.orders().back().sheriff_id, "watches");
}

TEST(SheriffOrdersTest, AnotherSheriffIsActiveForThreeSeconds) {
  Sheriff sheriff("me", Sheriff::Mode::kCommand);
  Orders orders;
  orders.deputy_id = "dep1";
  orders.sheriff_id = "me";
  sheriff.OnForeignOrders(orders, 0);
  EXPECT_FALSE(sheriff.ActiveOther(0).has_value()) << "our own, looped back";

  orders.sheriff_id = "other";
  sheriff.OnForeignOrders(orders, 1'000'000);

  ASSERT_TRUE(sheriff.ActiveOther(3'900'000).has_value());
  EXPECT_EQ(sheriff.ActiveOther(3'900'000)->id, "other");
  EXPECT_EQ(sheriff.ActiveOther(3'900'000)->age_us, 2'900'000);
  EXPECT_TRUE(sheriff.ActiveOther(3'900'000)->was_heard);
  EXPECT_FALSE(sheriff.ActiveOther(4'100'000).has_value());
}

TEST(SheriffOrdersTest, ADeputyTellsOfAnotherSheriff) {
  Sheriff sheriff("me", Sheriff::Mode::kCommand);
  DeputyHealth health;
  health.deputy_id = "dep1";
  health.sheriff_id = "me";
  health.orders_age_us = 0;
  sheriff.OnHealth(health, 1, 0);
  EXPECT_FALSE(sheriff.ActiveOther(0).has_value());

  health.sheriff_id = "other";
  health.orders_age_us = 2'000'000;
  sheriff.OnHealth(health, 2, 0);

  ASSERT_TRUE(sheriff.ActiveOther(900'000).has_value());
  EXPECT_FALSE(sheriff.ActiveOther(900'000)->was_heard);
  EXPECT_FALSE(sheriff.ActiveOther(1'100'000).has_value());
}

TEST(SheriffOrdersTest, OneThatKnowsOnlyItsFilesDeputiesLeavesAllOthersAlone) {
  SheriffBed bed({"mine", "theirs"});
  Sheriff& other = bed.AddSheriff("other");
  other.Load(Deploying({Deployed("a", "theirs"), Deployed("c", "theirs")}), bed.now_us());
  other.Start(Everything(), bed.now_us());
  bed.Run(1'000'000);
  bed.RemoveSheriff(other);
  const auto runs_before = bed.deputy("theirs").runs().size();
  const auto orders_before = static_cast<std::ptrdiff_t>(bed.orders().size());

  Sheriff& sheriff = bed.AddSheriff("s", Sheriff::Mode::kCommand, Sheriff::Scope::kFile);
  bed.Run(2'000'000);
  sheriff.Load(Deploying({Deployed("a", "mine"), Deployed("b", "mine")}), bed.now_us());
  sheriff.Start(Everything(), bed.now_us());
  bed.Run(3'000'000);

  EXPECT_EQ(bed.StatusOf(sheriff, "a"), Status::kRunning) << "a namesake is no obstacle";
  EXPECT_EQ(bed.StatusOf(sheriff, "b"), Status::kRunning);
  EXPECT_FALSE(sheriff.View("c", bed.now_us()).has_value());
  sheriff.Stop(Everything(), bed.now_us());
  bed.Run(2'000'000);
  EXPECT_EQ(bed.StatusOf(sheriff, "a"), Status::kStopped);
  EXPECT_TRUE(bed.deputy("theirs").IsUp("a"));
  EXPECT_TRUE(bed.deputy("theirs").IsUp("c"));
  EXPECT_EQ(bed.deputy("theirs").runs().size(), runs_before);
  EXPECT_TRUE(std::all_of(bed.orders().begin() + orders_before,
                          bed.orders().end(),
                          [](const Orders& orders) { return orders.deputy_id == "mine"; }));
}

}  // namespace
}  // namespace clearway::core::procman
