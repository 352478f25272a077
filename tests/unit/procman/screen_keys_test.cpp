// SPDX-License-Identifier: BSD-3-Clause
#include <gmock/gmock.h>

#include "tests/unit/procman/screen_bed.hpp"

namespace clearway::screen {
namespace {

using core::procman::ScriptRunner;
using testing::HasSubstr;
using testing::IsEmpty;
using Kind = KeyPress::Kind;

TEST(ScreenKeys, OneKeyStartsStopsAndRestartsOneCommand) {
  ScreenBed bed;
  bed.Select("preprocessor");

  for (const auto& [key, kind] : {std::pair{'s', Intent::Kind::kStart},
                                  std::pair{'t', Intent::Kind::kStop},
                                  std::pair{'r', Intent::Kind::kRestart}}) {
    const Intent intent = bed.Press(key);

    EXPECT_EQ(intent.kind, kind);
    EXPECT_EQ(intent.target, (Target{Target::Kind::kCommand, "preprocessor"}));
    EXPECT_FALSE(intent.force);
  }
}

TEST(ScreenKeys, AGroupStartsAtOnceAndIsAskedAboutBeforeItStops) {
  ScreenBed bed;
  bed.Select("perceive");

  EXPECT_EQ(bed.Press('s').kind, Intent::Kind::kStart);
  EXPECT_EQ(bed.Press('t').kind, Intent::Kind::kNone);
  EXPECT_THAT(bed.model.question(),
              HasSubstr("Stop group sense/perceive (2 commands, 1 running)?"));
  EXPECT_EQ(bed.Press('t').kind, Intent::Kind::kNone);  // No answer.
  const Intent intent = bed.Press('y');

  EXPECT_EQ(intent.kind, Intent::Kind::kStop);
  EXPECT_EQ(intent.target, (Target{Target::Kind::kGroup, "sense/perceive"}));
  EXPECT_THAT(bed.model.question(), IsEmpty());
}

TEST(ScreenKeys, NoAnswersAQuestionWithNothing) {
  for (const KeyPress& no : {KeyPress{Kind::kCharacter, 'n'}, KeyPress{Kind::kEscape}}) {
    ScreenBed bed;
    bed.Press('r');
    ASSERT_THAT(bed.model.question(), HasSubstr("Restart everything (5 commands"));

    EXPECT_EQ(bed.Press(no).kind, Intent::Kind::kNone);

    EXPECT_THAT(bed.model.question(), IsEmpty());
    EXPECT_EQ(bed.Press('y').kind, Intent::Kind::kNone);
  }
}

TEST(ScreenKeys, ACommandThatWaitsForASilentHostIsStartedElsewhereOnlyWhenSomebodySaysSo) {
  ScreenContent content = SmallRobot();
  content.snapshot.commands[0].status = Status::kMoving;
  content.snapshot.commands[0].text = "deputy arm is silent and may still run it";
  ScreenBed bed(content);
  bed.Select("lidar-driver");

  EXPECT_EQ(bed.Press('s').kind, Intent::Kind::kNone);
  EXPECT_THAT(bed.model.question(),
              HasSubstr("Deputy arm is silent and may still run it. Start it"));
  const Intent intent = bed.Press('y');

  EXPECT_EQ(intent.kind, Intent::Kind::kStart);
  EXPECT_TRUE(intent.force);
}

TEST(ScreenKeys, AnObserverGivesNoOrders) {
  ScreenContent content = SmallRobot();
  content.snapshot.is_observer = true;
  ScreenBed bed(content);
  bed.Select("preprocessor");

  for (const char key : {'s', 't', 'r'}) {
    EXPECT_EQ(bed.Press(key).kind, Intent::Kind::kNone);
    EXPECT_THAT(bed.model.question(), IsEmpty());
    EXPECT_THAT(bed.model.notice(), HasSubstr("c to take command"));
  }
  bed.Press('x');
  EXPECT_EQ(bed.Press(Kind::kEnter).kind, Intent::Kind::kNone);
}

TEST(ScreenKeys, AnObserverTakesCommandAtOnceWhereNobodyHasIt) {
  ScreenContent content = SmallRobot();
  content.snapshot.is_observer = true;
  ScreenBed bed(content);

  EXPECT_EQ(bed.Press('c').kind, Intent::Kind::kTakeCommand);
}

TEST(ScreenKeys, AnObserverIsToldFromWhomItWouldTakeCommand) {
  ScreenContent content = SmallRobot();
  content.snapshot.is_observer = true;
  content.snapshot.other = core::procman::OtherSheriff{.id = "cart:77:1", .age_us = 100};
  ScreenBed bed(content);

  EXPECT_EQ(bed.Press('c').kind, Intent::Kind::kNone);
  EXPECT_THAT(bed.model.question(), HasSubstr("cart:77"));
  EXPECT_EQ(bed.Press('y').kind, Intent::Kind::kTakeCommand);
}

TEST(ScreenKeys, OGivesCommandUp) {
  ScreenBed bed;

  EXPECT_EQ(bed.Press('o').kind, Intent::Kind::kNone);
  EXPECT_EQ(bed.Press('y').kind, Intent::Kind::kStepBack);
}

TEST(ScreenKeys, QuitsAtOnceWhereNothingIsHalfDone) {
  ScreenBed bed;

  EXPECT_EQ(bed.Press('q').kind, Intent::Kind::kQuit);
}

TEST(ScreenKeys, AsksBeforeItLeavesOrdersHalfDone) {
  ScreenContent content = SmallRobot();
  content.snapshot.commands[1].status = Status::kRestarting;
  ScreenBed bed(content);

  EXPECT_EQ(bed.Press('q').kind, Intent::Kind::kNone);
  EXPECT_THAT(bed.model.question(), HasSubstr("preprocessor: Restarting"));
  EXPECT_EQ(bed.Press('y').kind, Intent::Kind::kQuit);
}

TEST(ScreenKeys, AsksBeforeItLeavesAScriptHalfDone) {
  ScreenContent content = SmallRobot();
  content.progress = {.state = ScriptRunner::State::kRunning, .script = "bring-up"};
  ScreenBed bed(content);

  EXPECT_EQ(bed.Press('q').kind, Intent::Kind::kNone);
  EXPECT_THAT(bed.model.question(), HasSubstr("bring-up"));
  EXPECT_EQ(bed.Press('n').kind, Intent::Kind::kNone);

  EXPECT_EQ(bed.Press(Kind::kInterrupt).kind, Intent::Kind::kNone);
  EXPECT_EQ(bed.Press(Kind::kInterrupt).kind, Intent::Kind::kQuit);
}

TEST(ScreenKeys, AnObserverLeavesNothingBehind) {
  ScreenContent content = SmallRobot();
  content.snapshot.is_observer = true;
  content.snapshot.commands[1].status = Status::kRestarting;
  ScreenBed bed(content);

  EXPECT_EQ(bed.Press('q').kind, Intent::Kind::kQuit);
}

TEST(ScreenKeys, RunsTheSelectedScriptAndAbortsIt) {
  ScreenContent content = SmallRobot();
  ScreenBed bed(content);
  bed.Press('x');
  ASSERT_EQ(bed.model.mode(), ScreenModel::Mode::kScripts);
  bed.Press(Kind::kDown);

  const Intent run = bed.Press(Kind::kEnter);

  EXPECT_EQ(run.kind, Intent::Kind::kRunScript);
  EXPECT_EQ(run.script, "down");
  content.progress = {.state = ScriptRunner::State::kRunning, .script = "down"};
  bed.model.Take(content);
  EXPECT_EQ(bed.Press(Kind::kEnter).kind, Intent::Kind::kNone);
  EXPECT_THAT(bed.model.question(), HasSubstr("Abort it and run down"));
  bed.Press('n');
  EXPECT_EQ(bed.Press(Kind::kEscape).kind, Intent::Kind::kAbortScript);
  content.progress.state = ScriptRunner::State::kAborted;
  bed.model.Take(content);
  EXPECT_EQ(bed.Press(Kind::kEscape).kind, Intent::Kind::kNone);
  EXPECT_EQ(bed.model.mode(), ScreenModel::Mode::kTable);
}

TEST(ScreenKeys, TheEndOfAScriptIsShownUntilItIsPutAway) {
  ScreenContent content = SmallRobot();
  content.progress = {
      .state = ScriptRunner::State::kFailed, .script = "up", .text = "clusterer failed"};
  ScreenBed bed(content);
  ASSERT_THAT(bed.Text(), HasSubstr("script up FAILED: clusterer failed"));

  bed.Press(Kind::kEscape);

  EXPECT_THAT(bed.Text(), testing::Not(HasSubstr("FAILED")));
}

TEST(ScreenKeys, TheSelectionStaysWithItsCommand) {
  ScreenContent content = SmallRobot();
  ScreenBed bed(content);
  bed.Select("stop-guard");
  std::rotate(content.snapshot.commands.begin(),
              content.snapshot.commands.begin() + 3,
              content.snapshot.commands.end());
  CountGroups(content.snapshot);

  bed.model.Take(content);

  EXPECT_EQ(bed.Selected(), "stop-guard");
  content.snapshot.commands.clear();
  CountGroups(content.snapshot);
  bed.model.Take(content);
  EXPECT_EQ(bed.Selected(), "everything");
}

TEST(ScreenKeys, FoldsAndUnfoldsGroups) {
  ScreenBed bed;
  bed.Select("clusterer");

  bed.Press(Kind::kLeft);

  EXPECT_EQ(bed.Selected(), "perceive");
  EXPECT_TRUE(bed.model.lines()[bed.model.selected()].is_folded);
  bed.Press(Kind::kEnter);
  EXPECT_FALSE(bed.model.lines()[bed.model.selected()].is_folded);
  bed.Press('!');
  EXPECT_EQ(bed.Selected(), "clusterer");
}

TEST(ScreenKeys, FindsByAPartOfTheName) {
  ScreenBed bed;
  bed.Press('/');
  for (const char c : std::string("GRi")) bed.Press(c);
  EXPECT_EQ(bed.Selected(), "gripper");
  EXPECT_THAT(bed.Text(), HasSubstr("Find: GRi_"));

  bed.Press(Kind::kBackspace);
  bed.Press(Kind::kBackspace);
  bed.Press(Kind::kBackspace);
  bed.Press('l');
  EXPECT_EQ(bed.Selected(), "lidar-driver");
  bed.Press(Kind::kEnter);
  bed.Press('n');

  EXPECT_EQ(bed.Selected(), "clusterer");
  EXPECT_EQ(bed.Press('t').kind, Intent::Kind::kStop);
}

TEST(ScreenKeys, OutputFollowsUntilItIsScrolled) {
  ScreenBed bed;
  for (int i = 0; i < 100; ++i) bed.output.Of("clusterer").Add(std::to_string(i) + "\n");
  bed.Select("clusterer");

  bed.Press(Kind::kEnter);
  EXPECT_EQ(bed.model.mode(), ScreenModel::Mode::kOutput);
  EXPECT_THAT(bed.Text(), HasSubstr("\n99\n"));
  bed.Press(Kind::kPageUp);
  const std::string paused = bed.Text();
  EXPECT_THAT(paused, HasSubstr("WAITS: 20 newer lines"));
  bed.output.Of("clusterer").Add("100\n");

  EXPECT_THAT(bed.Text(), HasSubstr("\n79\n"));
  EXPECT_THAT(bed.Text(), HasSubstr("WAITS: 21 newer lines"));
  bed.Press(Kind::kHome);
  EXPECT_THAT(bed.Text(), HasSubstr("\n0\n1\n"));
  EXPECT_THAT(bed.Text(), HasSubstr("\n20\n"));  // A full page.
  bed.Press(Kind::kEnd);
  EXPECT_THAT(bed.Text(), HasSubstr("\n100\n"));
  EXPECT_TRUE(bed.model.follows());
  bed.Press('q');
  EXPECT_EQ(bed.model.mode(), ScreenModel::Mode::kTable);
}

TEST(ScreenKeys, APausedOutputIsNotLostWhenItsLinesAreDropped) {
  ScreenBed bed;
  bed.Select("clusterer");
  for (int i = 0; i < 100; ++i) bed.output.Of("clusterer").Add(std::to_string(i) + "\n");
  bed.Press(Kind::kEnter);
  bed.Press(Kind::kHome);

  for (int i = 0; i < 9000; ++i) bed.output.Of("clusterer").Add("more\n");

  EXPECT_THAT(bed.Text(), HasSubstr("more"));
  bed.Press(Kind::kDown);
  EXPECT_THAT(bed.Text(), HasSubstr("more\nmore\nmore"));
}

TEST(ScreenKeys, OrdersAreGivenWhileOutputIsRead) {
  ScreenBed bed;
  bed.Select("clusterer");
  bed.Press(Kind::kEnter);

  EXPECT_EQ(bed.Press('r').kind, Intent::Kind::kRestart);
  EXPECT_EQ(bed.model.mode(), ScreenModel::Mode::kOutput);
}

TEST(ScreenKeys, HelpScrollsAndGoesAway) {
  ScreenBed bed;
  bed.Press('?');
  ASSERT_THAT(bed.Text(), HasSubstr("HELP"));

  bed.Press(Kind::kEnd);
  EXPECT_THAT(bed.Text(), HasSubstr("CPU%"));
  bed.Press(Kind::kUp);
  bed.Press('q');

  EXPECT_EQ(bed.model.mode(), ScreenModel::Mode::kTable);
}

TEST(ScreenKeys, AnyKeysInAnyOrderAreSurvived) {
  ScreenContent content = SmallRobot();
  ScreenBed bed(content);
  std::uint32_t state = 5;
  const auto random = [&state](std::uint32_t n) {
    state = state * 1664525U + 1013904223U;
    return (state >> 8U) % n;
  };
  for (int i = 0; i < 20'000; ++i) {
    KeyPress key{.kind = static_cast<Kind>(random(static_cast<std::uint32_t>(Kind::kOther) + 1))};
    if (random(2) == 0) key = {.kind = Kind::kCharacter, .character = 0x20 + random(100)};
    bed.size = {20 + static_cast<int>(random(100)), 4 + static_cast<int>(random(40))};
    if (random(50) == 0) {
      content.snapshot.commands.resize(random(5) + 1, Command("new", "a/b", Status::kFailed));
      content.scripts.resize(random(3));
      CountGroups(content.snapshot);
      bed.model.Take(content);
    }
    bed.output.Of("clusterer").Add("line\n");

    bed.Press(key);

    ASSERT_EQ(bed.Lines().size(), static_cast<std::size_t>(bed.size.rows));
    ASSERT_LT(bed.model.selected(), bed.model.lines().size());
  }
}

}  // namespace
}  // namespace clearway::screen
