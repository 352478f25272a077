// SPDX-License-Identifier: BSD-3-Clause
// A command whose deputy changed in the file: never two copies where that can be avoided.
#include <gtest/gtest.h>

#include "tests/unit/procman/sheriff_bed.hpp"

namespace clearway::core::procman {
namespace {

using test::Deployed;
using test::Deploying;
using test::Everything;
using test::SheriffBed;
using test::TheCommand;

class SheriffMovesTest : public testing::Test {
 protected:
  // "a" runs on dep1, and a new sheriff has a file that says dep2.
  Sheriff& Moved(const std::string& exec = "run", bool auto_respawn = false) {
    Sheriff& old = bed.AddSheriff("old");
    old.Load(Deploying({Deployed("a", "dep1", exec, "", auto_respawn), Deployed("b", "dep1")}),
             bed.now_us());
    old.Start(Everything(), bed.now_us());
    bed.Run(1'500'000);
    bed.RemoveSheriff(old);
    Sheriff& sheriff = bed.AddSheriff("new");
    sheriff.Load(Deploying({Deployed("a", "dep2", exec, "", auto_respawn), Deployed("b", "dep1")}),
                 bed.now_us());
    bed.check = [this] { most_copies = std::max(most_copies, bed.Copies("a")); };
    return sheriff;
  }

  SheriffBed bed{{"dep1", "dep2"}};
  int most_copies = 0;
};

TEST_F(SheriffMovesTest, LoadingTheFileMovesNothing) {
  Sheriff& sheriff = Moved();
  bed.Run(5'000'000);

  EXPECT_TRUE(bed.deputy("dep1").IsUp("a"));
  EXPECT_EQ(bed.deputy("dep1").StartsOf("a"), 1);
  EXPECT_EQ(bed.deputy("dep2").StartsOf("a"), 0);
  const auto view = sheriff.View("a", bed.now_us());
  EXPECT_EQ(view->status, Status::kRunning);
  EXPECT_EQ(view->deputy, "dep2");
  EXPECT_NE(view->pid, 0);
  EXPECT_EQ(view->text, "runs on dep1; a start or restart moves it");
}

TEST_F(SheriffMovesTest, AStartEndsItOnTheOldDeputyFirst) {
  for (const std::string exec : {"run", "stubborn", "end 0 3000"}) {
    SCOPED_TRACE(exec);
    bed = SheriffBed({"dep1", "dep2"});
    most_copies = 0;
    Sheriff& sheriff = Moved(exec);
    sheriff.Start(Everything(), bed.now_us());
    bed.Step();
    EXPECT_EQ(bed.StatusOf(sheriff, "a"), Status::kMoving);
    bed.Run(5'000'000);

    EXPECT_EQ(most_copies, 1);
    EXPECT_FALSE(bed.deputy("dep1").Knows("a"));
    EXPECT_EQ(bed.deputy("dep2").StartsOf("a"), 1);
    EXPECT_TRUE(bed.deputy("dep1").IsUp("b"));
  }
}

TEST_F(SheriffMovesTest, ARespawnedCommandMovesToo) {
  Sheriff& sheriff = Moved("end 1 200", true);
  sheriff.Restart(TheCommand("a"), bed.now_us());
  bed.Run(5'000'000);

  EXPECT_EQ(most_copies, 1);
  EXPECT_FALSE(bed.deputy("dep1").Knows("a"));
  EXPECT_GT(bed.deputy("dep2").StartsOf("a"), 1);
}

TEST_F(SheriffMovesTest, AStopStopsItWhereItRuns) {
  Sheriff& sheriff = Moved("stubborn");
  sheriff.Stop(TheCommand("a"), bed.now_us());
  bed.Run(100'000);
  EXPECT_EQ(bed.StatusOf(sheriff, "a"), Status::kStopping);
  bed.Run(4'000'000);

  EXPECT_EQ(bed.Copies("a"), 0);
  EXPECT_EQ(bed.StatusOf(sheriff, "a"), Status::kStopped);
}

TEST_F(SheriffMovesTest, AStopWhileItMovesKeepsItFromStarting) {
  Sheriff& sheriff = Moved("stubborn");
  sheriff.Start(TheCommand("a"), bed.now_us());
  bed.Run(100'000);
  sheriff.Stop(TheCommand("a"), bed.now_us());
  bed.Run(5'000'000);

  EXPECT_EQ(bed.Copies("a"), 0);
  EXPECT_EQ(bed.deputy("dep2").StartsOf("a"), 0);
}

TEST_F(SheriffMovesTest, ASilentDeputyKeepsItFromStartingUnlessByForce) {
  Sheriff& sheriff = Moved();
  bed.Run(1'000'000);
  bed.cut_off = {"dep1"};
  bed.Run(4'000'000);
  sheriff.Start(TheCommand("a"), bed.now_us());
  bed.Run(10'000'000);
  EXPECT_EQ(bed.deputy("dep2").StartsOf("a"), 0);
  const auto view = sheriff.View("a", bed.now_us());
  EXPECT_EQ(view->status, Status::kMoving);
  EXPECT_NE(view->text.find("ran on dep1 when that was last heard"), std::string::npos);

  sheriff.Start(TheCommand("a"), bed.now_us(), true);
  bed.Run(1'000'000);

  EXPECT_EQ(bed.deputy("dep2").StartsOf("a"), 1);
}

TEST_F(SheriffMovesTest, TheCopyOfADeputyThatComesBackIsEnded) {
  Sheriff& sheriff = Moved();
  bed.Run(1'000'000);
  bed.cut_off = {"dep1"};
  bed.Run(4'000'000);
  sheriff.Start(TheCommand("a"), bed.now_us(), true);
  bed.Run(1'000'000);
  ASSERT_EQ(bed.Copies("a"), 2) << "that is what force means";

  bed.cut_off.clear();
  bed.Run(2'000'000);

  EXPECT_EQ(bed.Copies("a"), 1);
  EXPECT_TRUE(bed.deputy("dep2").IsUp("a"));
  EXPECT_EQ(bed.deputy("dep2").StartsOf("a"), 1);
}

TEST_F(SheriffMovesTest, ADeputyThatWasStartedAnewHoldsNothingBack) {
  Sheriff& sheriff = Moved();
  bed.Run(1'000'000);
  bed.cut_off = {"dep1"};
  bed.deputy("dep1").Reboot(bed.now_us());
  bed.Run(4'000'000);
  sheriff.Start(TheCommand("a"), bed.now_us());
  bed.Run(1'000'000);
  EXPECT_EQ(bed.deputy("dep2").StartsOf("a"), 0);

  bed.cut_off.clear();
  bed.Run(1'500'000);

  EXPECT_EQ(bed.deputy("dep2").StartsOf("a"), 1);
  EXPECT_EQ(bed.deputy("dep1").StartsOf("a"), 1);
}

TEST_F(SheriffMovesTest, ReloadingTheFileMovesNothingByItself) {
  Sheriff& sheriff = bed.AddSheriff("s");
  sheriff.Load(Deploying({Deployed("a", "dep1")}), bed.now_us());
  sheriff.Start(Everything(), bed.now_us());
  bed.Run(1'000'000);

  sheriff.Load(Deploying({Deployed("a", "dep2")}), bed.now_us());
  bed.Run(3'000'000);
  EXPECT_TRUE(bed.deputy("dep1").IsUp("a"));
  bed.check = [this] { most_copies = std::max(most_copies, bed.Copies("a")); };
  sheriff.Start(Everything(), bed.now_us());
  bed.Run(3'000'000);

  EXPECT_EQ(most_copies, 1);
  EXPECT_TRUE(bed.deputy("dep2").IsUp("a"));
}

TEST_F(SheriffMovesTest, ASecondCopyIsShownAndEndsWithTheNextAction) {
  Sheriff& sheriff = Moved();
  bed.Run(1'000'000);
  bed.cut_off = {"dep1"};
  bed.Run(4'000'000);
  sheriff.Start(TheCommand("a"), bed.now_us(), true);
  bed.Run(1'000'000);
  bed.RemoveSheriff(sheriff);
  bed.cut_off.clear();
  Sheriff& next = bed.AddSheriff("next");
  next.Load(Deploying({Deployed("a", "dep2")}), bed.now_us());
  bed.Run(2'000'000);

  EXPECT_EQ(bed.Copies("a"), 2) << "nobody asked for anything yet";
  const Snapshot snapshot = next.Look(bed.now_us());
  const auto strays = std::count_if(snapshot.commands.begin(),
                                    snapshot.commands.end(),
                                    [](const CommandView& view) { return view.is_stray; });
  EXPECT_EQ(strays, 1);
  next.Start(TheCommand("a"), bed.now_us());
  bed.Run(2'000'000);

  EXPECT_EQ(bed.Copies("a"), 1);
  EXPECT_EQ(bed.deputy("dep2").StartsOf("a"), 1);
}

}  // namespace
}  // namespace clearway::core::procman
