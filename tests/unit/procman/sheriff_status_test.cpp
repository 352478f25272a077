// SPDX-License-Identifier: BSD-3-Clause
// What a sheriff shows of deputies that tell their commands' health, and of those that do not.
#include <algorithm>
#include <random>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/unit/procman/sheriff_bed.hpp"

namespace clearway::core::procman {
namespace {

using test::Deployed;
using test::Deploying;
using test::Everything;
using test::SheriffBed;
using test::TheCommand;

class SheriffStatusTest : public testing::TestWithParam<bool> {
 protected:
  SheriffStatusTest() {
    bed.health_first = GetParam();
    own = &bed.AddOwn("own");
    sheriff = &bed.AddSheriff("s");
  }

  void Start(std::vector<DeployedCommand> commands) {
    sheriff->Load(Deploying(std::move(commands)), bed.now_us());
    bed.Run(100'000);
    sheriff->Start(Everything(), bed.now_us());
  }

  // The statuses that one command went through.
  [[nodiscard]] std::vector<std::string> Way(const std::string& id) const {
    std::vector<std::string> way;
    for (const Change& change : sheriff->history()) {
      if (change.command == id) way.push_back(change.to);
    }
    return way;
  }

  SheriffBed bed{std::vector<std::string>{}};
  test::MemoryDeputy* own = nullptr;
  Sheriff* sheriff = nullptr;
};

TEST_P(SheriffStatusTest, ReadinessIsAwaitedWhereItIsTold) {
  Start({Deployed("a", "own", "ready 700")});
  bed.Run(500'000);
  EXPECT_EQ(bed.StatusOf(*sheriff, "a"), Status::kGettingReady);
  EXPECT_FALSE(sheriff->View("a", bed.now_us())->is_ready);
  bed.Run(500'000);

  EXPECT_EQ(bed.StatusOf(*sheriff, "a"), Status::kRunning);
  EXPECT_TRUE(sheriff->View("a", bed.now_us())->is_ready);
  EXPECT_EQ(Way("a"),
            (std::vector<std::string>{"Stopped", "Starting", "Getting ready", "Running"}));
}

// The health of the old run says ready: it is not to be taken for the new one's.
TEST_P(SheriffStatusTest, TheOldRunsReadinessIsNotTheNewOnes) {
  Start({Deployed("a", "own", "ready 300")});
  bed.Run(1'500'000);
  ASSERT_EQ(bed.StatusOf(*sheriff, "a"), Status::kRunning);
  const std::size_t before = Way("a").size();
  sheriff->Restart(Everything(), bed.now_us());
  bed.Run(1'500'000);

  std::vector<std::string> way = Way("a");
  way.erase(way.begin(), way.begin() + static_cast<std::ptrdiff_t>(before));
  EXPECT_EQ(way, (std::vector<std::string>{"Restarting", "Getting ready", "Running"}));
}

TEST_P(SheriffStatusTest, TroubleIsCalledByItsName) {
  Start({Deployed("sick", "own", "sick 100"),
         Deployed("forbidden", "own", "forbidden"),
         Deployed("crash", "own", "end 3 50"),
         Deployed("loop", "own", "end 1 50", "", true),
         Deployed("done", "own", "end 0 50")});
  bed.Run(1'000'000);

  const Snapshot snapshot = sheriff->Look(bed.now_us());
  std::vector<std::pair<Status, std::string>> shown;
  for (const CommandView& view : snapshot.commands) shown.emplace_back(view.status, view.text);
  EXPECT_THAT(
      shown,
      testing::ElementsAre(
          testing::Pair(Status::kUnhealthy, testing::HasSubstr("no sensor")),
          testing::Pair(Status::kRefused, testing::HasSubstr("no rule allows it")),
          testing::Pair(Status::kFailed, "exited with 3"),
          testing::Pair(Status::kBackingOff, testing::HasSubstr("exited with 1; starts again")),
          testing::Pair(Status::kStopped, "exited with 0")));
  EXPECT_EQ(snapshot.groups.front().trouble, 4);
  bed.Run(120'000'000);
  EXPECT_EQ(bed.StatusOf(*sheriff, "loop"), Status::kGaveUp);
}

// Report and health are two messages: what only one of them shows is not told as news.
TEST_P(SheriffStatusTest, TheHistoryHasNoStepsBetweenTwoMessages) {
  Start({Deployed("run", "own"),
         Deployed("forbidden", "own", "forbidden"),
         Deployed("loop", "own", "end 1 300", "", true)});
  bed.Run(900'000);

  EXPECT_EQ(Way("run"), (std::vector<std::string>{"Stopped", "Starting", "Running"}));
  EXPECT_EQ(Way("forbidden"), (std::vector<std::string>{"Stopped", "Starting", "Refused"}));
  EXPECT_EQ(Way("loop"),
            (std::vector<std::string>{
                "Stopped", "Starting", "Running", "Backing off", "Running", "Backing off"}));
}

TEST_P(SheriffStatusTest, AnObserverFollowsWhatMoves) {
  bed.AddOwn("other");
  Sheriff& observer = bed.AddSheriff("watches", Sheriff::Mode::kObserve);
  Start({Deployed("a", "own")});
  bed.Run(1'000'000);
  sheriff->Load(Deploying({Deployed("a", "other")}), bed.now_us());
  sheriff->Start(Everything(), bed.now_us());
  bed.Run(1'000'000);

  const auto view = observer.View("a", bed.now_us());
  EXPECT_EQ(view->deputy, "other");
  EXPECT_EQ(view->status, Status::kRunning);
  EXPECT_TRUE(
      std::any_of(observer.history().begin(), observer.history().end(), [](const Change& c) {
        return c.deputy == "own" && c.command == "a" && c.to.empty();
      }));
}

TEST_P(SheriffStatusTest, TheDeputysOwnTimersNeedNoOrders) {
  Start({Deployed("a", "own", "stubborn")});
  bed.Run(1'000'000);
  sheriff->Stop(Everything(), bed.now_us());
  bed.Run(100'000);
  EXPECT_EQ(bed.StatusOf(*sheriff, "a"), Status::kStopping);
  bed.Run(900'000);

  EXPECT_EQ(bed.StatusOf(*sheriff, "a"), Status::kStopped);
}

TEST_P(SheriffStatusTest, WhatOthersStoppedStaysStoppedAndIsNoFailure) {
  Start({Deployed("a", "own", "stubborn", "", true), Deployed("b", "own")});
  bed.Run(1'000'000);
  sheriff->Stop(TheCommand("a"), bed.now_us());
  bed.Run(2'000'000);
  bed.RemoveSheriff(*sheriff);

  sheriff = &bed.AddSheriff("next");
  bed.Run(3'000'000);

  EXPECT_EQ(bed.StatusOf(*sheriff, "a"), Status::kStopped) << "although it was killed";
  EXPECT_TRUE(sheriff->View("a", bed.now_us())->force_quit);
  EXPECT_EQ(own->StartsOf("a"), 1);
}

// Taken over while it is being stopped: orders that say "let it run" would take the stop back.
TEST_P(SheriffStatusTest, AStopThatIsUnderWayIsNotTakenBackByASheriffThatComes) {
  Start({Deployed("a", "own", "stubborn", "", true), Deployed("b", "own")});
  bed.Run(1'000'000);
  sheriff->Stop(TheCommand("a"), bed.now_us());
  bed.Run(50'000);
  bed.RemoveSheriff(*sheriff);

  sheriff = &bed.AddSheriff("next");
  bed.Run(50'000);
  EXPECT_EQ(bed.StatusOf(*sheriff, "a"), Status::kStopping);
  bed.Run(3'000'000);

  EXPECT_EQ(bed.StatusOf(*sheriff, "a"), Status::kStopped);
  EXPECT_EQ(own->StartsOf("a"), 1);
  EXPECT_EQ(bed.orders().back().sheriff_id, "next") << "it goes on giving orders";
}

TEST_P(SheriffStatusTest, ASilentDeputysCommandsAreUnknownNotRunning) {
  Start({Deployed("a", "own"), Deployed("b", "nobody")});
  bed.Run(1'000'000);
  EXPECT_EQ(bed.StatusOf(*sheriff, "a"), Status::kRunning);
  bed.cut_off = {"own"};
  bed.Run(4'500'000);

  const Snapshot snapshot = sheriff->Look(bed.now_us());
  EXPECT_EQ(snapshot.commands.at(0).status, Status::kUnknown);
  EXPECT_THAT(snapshot.commands.at(0).text, testing::StartsWith("deputy own is silent for "));
  EXPECT_EQ(snapshot.commands.at(1).text, "deputy nobody is not heard");
  ASSERT_EQ(snapshot.deputies.size(), 2U);
  EXPECT_FALSE(snapshot.deputies.at(0).is_heard);
  EXPECT_EQ(snapshot.deputies.at(0).age_us, -1);
  EXPECT_FALSE(snapshot.deputies.at(1).is_heard);
  EXPECT_GT(snapshot.deputies.at(1).age_us, 3'000'000);
  bed.cut_off.clear();
  bed.Run(1'100'000);
  EXPECT_EQ(bed.StatusOf(*sheriff, "a"), Status::kRunning);
  EXPECT_EQ(own->StartsOf("a"), 1);
}

TEST_P(SheriffStatusTest, AnEarlyReportCountsOnlyOnce) {
  Start({Deployed("a", "own")});
  bed.Run(1'000'000);
  const std::size_t before = sheriff->history().size();
  DeputyReport old = own->Report(SheriffBed::kEpoch + bed.now_us() - 1'500'000);
  old.commands.clear();

  sheriff->OnReport(old, bed.now_us());

  EXPECT_EQ(bed.StatusOf(*sheriff, "a"), Status::kRunning);
  EXPECT_EQ(sheriff->history().size(), before);
}

TEST_P(SheriffStatusTest, TwoDeputiesWithOneNameAreReported) {
  Start({Deployed("a", "own")});
  for (int i = 0; i < 4; ++i) {
    bed.Run(1'000'000);
    sheriff->OnReport(own->Report(1'000'000LL * i), bed.now_us());
  }

  EXPECT_THAT(sheriff->Look(bed.now_us()).deputies.at(0).text, testing::HasSubstr("two deputies"));
}

TEST_P(SheriffStatusTest, HalfOfAllMessagesAreEnough) {
  std::mt19937 random(7);
  bed.loses_orders = [&random] { return random() % 2 == 0; };
  bed.loses_reports = [&random] { return random() % 2 == 0; };
  Start({Deployed("a", "own", "ready 100"), Deployed("b", "own", "run", "", true)});
  EXPECT_TRUE(bed.RunUntil([&] {
    return bed.StatusOf(*sheriff, "a") == Status::kRunning &&
           bed.StatusOf(*sheriff, "b") == Status::kRunning;
  }));
  sheriff->Restart(Everything(), bed.now_us());
  EXPECT_TRUE(bed.RunUntil([&] {
    return own->StartsOf("a") == 2 && own->StartsOf("b") == 2 &&
           bed.StatusOf(*sheriff, "a") == Status::kRunning;
  }));
  sheriff->Stop(Everything(), bed.now_us());
  EXPECT_TRUE(bed.RunUntil([&] {
    return bed.StatusOf(*sheriff, "a") == Status::kStopped &&
           bed.StatusOf(*sheriff, "b") == Status::kStopped;
  }));
}

INSTANTIATE_TEST_SUITE_P(HealthFirstOrLast, SheriffStatusTest, testing::Bool());

}  // namespace
}  // namespace clearway::core::procman
