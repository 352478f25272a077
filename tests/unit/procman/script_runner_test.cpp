// SPDX-License-Identifier: BSD-3-Clause
#include "common/core/procman/script_runner.hpp"

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
using test::TheGroup;
using Kind = ScriptAction::Kind;
using Wait = ScriptAction::Status;
using State = ScriptRunner::State;

ScriptAction Action(Kind kind, const Target& target = {}, Wait wait = Wait::kNone) {
  ScriptAction action;
  action.kind = kind;
  action.target = target;
  action.wait = wait;
  return action;
}

ScriptAction Pause(std::int64_t duration_ms) {
  ScriptAction action;
  action.kind = Kind::kWaitTime;
  action.duration_ms = duration_ms;
  return action;
}

ScriptAction RunScript(const std::string& name) {
  ScriptAction action;
  action.kind = Kind::kRunScript;
  action.script = name;
  return action;
}

Script Named(const std::string& name, std::vector<ScriptAction> actions) {
  Script script;
  script.name = name;
  script.actions = std::move(actions);
  return script;
}

// The same on the reference's deputy and on ours.
class ScriptRunnerTest : public testing::TestWithParam<std::string> {
 protected:
  ScriptRunnerTest() {
    own = &bed.AddOwn("own");
    bed.check = [this] { runner.Tick(bed.now_us()); };
  }

  void Load(std::vector<DeployedCommand> commands, std::vector<Script> scripts = {}) {
    Deployment deployment = Deploying(std::move(commands));
    deployment.scripts = std::move(scripts);
    sheriff.Load(std::move(deployment), bed.now_us());
    bed.Run(100'000);
  }

  // How long it took [us].
  std::int64_t Run(const Script& script, std::int64_t limit_us = 60'000'000) {
    const std::int64_t start_us = bed.now_us();
    runner.Run(script, {.timeout_us = 10'000'000}, bed.now_us());
    bed.RunUntil([this] { return runner.state() != State::kRunning; }, limit_us);
    return bed.now_us() - start_us;
  }

  [[nodiscard]] bool IsUp(const std::string& id) {
    return own->IsUp(id) || bed.deputy("ref").IsUp(id);
  }
  [[nodiscard]] bool is_own() const { return GetParam() == "own"; }

  SheriffBed bed{{"ref"}};
  test::MemoryDeputy* own = nullptr;
  Sheriff& sheriff = bed.AddSheriff("commands");
  ScriptRunner runner{sheriff};
};

TEST_P(ScriptRunnerTest, StartsInOrderAndEachWaitsForItsOwn) {
  Load({Deployed("a", GetParam(), "run", "low"), Deployed("b", GetParam(), "run", "high")});

  Run(Named("up",
            {Action(Kind::kStart, TheGroup("low"), Wait::kRunning),
             Action(Kind::kStart, TheCommand("b"), Wait::kRunning)}));

  EXPECT_EQ(runner.state(), State::kDone) << runner.text();
  EXPECT_TRUE(IsUp("a") && IsUp("b"));
  EXPECT_TRUE(runner.awaited().empty());
}

TEST_P(ScriptRunnerTest, WhatRunsAlreadyIsNotWaitedFor) {
  Load({Deployed("a", GetParam())});
  Run(Named("up", {Action(Kind::kStart, Everything(), Wait::kRunning)}));

  EXPECT_LE(Run(Named("up", {Action(Kind::kStart, Everything(), Wait::kRunning)})), 1'100'000);
  EXPECT_EQ(runner.state(), State::kDone);
}

TEST_P(ScriptRunnerTest, ACrashAtOnceIsAFailureNotSuccess) {
  Load({Deployed("good", GetParam()), Deployed("bad", GetParam(), "end 3 100")});

  const std::int64_t took_us =
      Run(Named("up", {Action(Kind::kStart, Everything(), Wait::kRunning)}));

  EXPECT_EQ(runner.state(), State::kFailed);
  EXPECT_EQ(runner.text(), "bad: Failed, exited with 3");
  EXPECT_LT(took_us, 1'000'000);
}

TEST_P(ScriptRunnerTest, ACommandThatIsDoneCountsAsRunning) {
  Load({Deployed("once", GetParam(), "end 0 100"), Deployed("instant", GetParam(), "end 0 0")});

  Run(Named("up", {Action(Kind::kStart, Everything(), Wait::kRunning)}));
  EXPECT_EQ(runner.state(), State::kDone) << runner.text();
  Run(Named("up", {Action(Kind::kRestart, Everything(), Wait::kRunning)}));

  EXPECT_EQ(runner.state(), State::kDone) << runner.text();
}

TEST_P(ScriptRunnerTest, ACommandThatKeepsDyingIsGivenUp) {
  Load({Deployed("loop", GetParam(), "end 1 20", "", true)});

  const std::int64_t took_us =
      Run(Named("up", {Action(Kind::kStart, Everything(), Wait::kRunning)}));

  EXPECT_EQ(runner.state(), State::kFailed);
  EXPECT_THAT(runner.text(), testing::StartsWith("loop: Backing off, exited with 1"));
  EXPECT_LT(took_us, 2'000'000);
}

TEST_P(ScriptRunnerTest, ARestartWaitsForTheNewRun) {
  Load({Deployed("a", GetParam(), "stubborn")});
  Run(Named("up", {Action(Kind::kStart, Everything(), Wait::kRunning)}));
  Run(Named("again", {Action(Kind::kRestart, Everything(), Wait::kRunning)}));

  EXPECT_EQ(runner.state(), State::kDone);
  EXPECT_EQ(own->StartsOf("a") + bed.deputy("ref").StartsOf("a"), 2);
}

TEST_P(ScriptRunnerTest, AStopWaitsUntilNothingRuns) {
  Load({Deployed("a", GetParam(), "stubborn", "", true), Deployed("b", GetParam())});
  Run(Named("up", {Action(Kind::kStart, Everything(), Wait::kRunning)}));
  Run(Named("down", {Action(Kind::kStop, Everything(), Wait::kStopped)}));

  EXPECT_EQ(runner.state(), State::kDone);
  EXPECT_FALSE(IsUp("a") || IsUp("b"));
}

TEST_P(ScriptRunnerTest, AStopOfWhatIsBetweenTwoStartsHolds) {
  Load({Deployed("loop", GetParam(), "end 1 300", "", true)});
  sheriff.Start(Everything(), bed.now_us());
  bed.Run(3'000'000);
  bed.RunUntil([this] { return !IsUp("loop"); });
  bed.Step();

  Run(Named("down", {Action(Kind::kStop, Everything(), Wait::kStopped)}));
  EXPECT_EQ(runner.state(), State::kDone);
  bed.check = [this] { EXPECT_FALSE(IsUp("loop")); };
  bed.Run(3'000'000);
}

TEST_P(ScriptRunnerTest, WhatIsNotThereInTimeIsNamedWithTheReason) {
  Load({Deployed("a", GetParam()), Deployed("far", "nobody")});

  const std::int64_t took_us =
      Run(Named("up", {Action(Kind::kStart, Everything(), Wait::kRunning)}));

  EXPECT_EQ(runner.state(), State::kTimedOut);
  EXPECT_EQ(runner.text(), "not running after 10 s: far: Unknown, deputy nobody is not heard");
  EXPECT_EQ(runner.awaited(), std::vector<std::string>{"far"});
  EXPECT_NEAR(static_cast<double>(took_us), 10e6, 20e3);
}

TEST_P(ScriptRunnerTest, ScriptsNestPauseAndWaitForOthers) {
  Load({Deployed("a", GetParam()), Deployed("b", GetParam())},
       {Named("inner", {Action(Kind::kStart, TheCommand("a")), Pause(700)}),
        Named("outer",
              {RunScript("inner"),
               RunScript("inner"),
               Action(Kind::kWaitStatus, TheCommand("a"), Wait::kRunning),
               Action(Kind::kStop, TheCommand("a"), Wait::kStopped),
               Action(Kind::kStart, TheCommand("b"), Wait::kRunning)})});

  const std::int64_t took_us = Run(sheriff.deployment().scripts.at(1));

  EXPECT_EQ(runner.state(), State::kDone) << runner.text();
  EXPECT_GE(took_us, 1'400'000);
  EXPECT_FALSE(IsUp("a"));
  EXPECT_TRUE(IsUp("b"));
}

TEST_P(ScriptRunnerTest, ScriptsThatRunEachOtherEndAllTheSame) {
  Load({Deployed("a", GetParam())}, {Named("x", {RunScript("y")}), Named("y", {RunScript("x")})});

  Run(sheriff.deployment().scripts.at(0));
  EXPECT_EQ(runner.state(), State::kFailed);
  Run(Named("z", {RunScript("gone")}));
  EXPECT_EQ(runner.state(), State::kFailed);
  EXPECT_EQ(runner.text(), "there is no script \"gone\"");
}

TEST_P(ScriptRunnerTest, ANewScriptAbortsTheOldOne) {
  Load({Deployed("a", GetParam())});
  runner.Run(Named("long", {Pause(100000), Action(Kind::kStart, Everything())}), {}, bed.now_us());
  EXPECT_EQ(runner.state(), State::kRunning);
  runner.Abort();
  EXPECT_EQ(runner.state(), State::kAborted);

  runner.Run(Named("long", {Pause(100000), Action(Kind::kStart, Everything())}), {}, bed.now_us());
  Run(Named("short", {Pause(10)}));
  EXPECT_EQ(runner.state(), State::kDone);
  EXPECT_EQ(runner.script(), "short");
  bed.Run(1'000'000);
  EXPECT_FALSE(IsUp("a"));
}

TEST_P(ScriptRunnerTest, ReadinessAndRefusalAreWaitedForWhereTheyAreTold) {
  if (!is_own()) GTEST_SKIP() << "the reference's deputy tells neither";
  Load({Deployed("slow", GetParam(), "ready 2000"),
        Deployed("mute", GetParam(), "mute"),
        Deployed("forbidden", GetParam(), "forbidden")});

  const std::int64_t took_us =
      Run(Named("slow", {Action(Kind::kStart, TheCommand("slow"), Wait::kRunning)}));
  EXPECT_EQ(runner.state(), State::kDone);
  EXPECT_GE(took_us, 2'000'000);
  EXPECT_LE(took_us, 2'100'000);
  Run(Named("mute", {Action(Kind::kStart, TheCommand("mute"), Wait::kRunning)}));
  EXPECT_EQ(runner.state(), State::kTimedOut);
  EXPECT_THAT(runner.text(), testing::HasSubstr("mute: Getting ready, no status yet"));
  Run(Named("forbidden", {Action(Kind::kStart, TheCommand("forbidden"), Wait::kRunning)}));
  EXPECT_EQ(runner.state(), State::kFailed);
  EXPECT_EQ(runner.text(), "forbidden: Refused, no rule allows it");
}

INSTANTIATE_TEST_SUITE_P(Deputies, ScriptRunnerTest, testing::Values("own", "ref"));

}  // namespace
}  // namespace clearway::core::procman
