// SPDX-License-Identifier: BSD-3-Clause
#include "common/io/procman/pmd_reader.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/test_folder.hpp"
#include "tests/unit/procman/pmd_example.hpp"

namespace clearway::io {
namespace {

using core::procman::CommandSpec;
using core::procman::DeployedCommand;
using core::procman::Deployment;
using core::procman::ScriptAction;
using core::procman::Target;
using testing::IsEmpty;
using testing::SizeIs;
using testing::StartsWith;
using Status = ScriptAction::Status;

Deployment Parsed(const std::string& text) {
  EXPECT_EQ(test::PmdRefusal(text), "");
  return ParsePmd(text, "d.pmd");
}

DeployedCommand OnlyCommand(const std::string& attributes) {
  const Deployment deployment =
      Parsed("cmd \"a\" { exec = \"x\"; deputy = \"h\"; " + attributes + " }");
  return deployment.commands.at(0);
}

TEST(PmdReader, ReadsTheCommandsOfTheExample) {
  const Deployment deployment = Parsed(test::kPmdExample);

  EXPECT_EQ(deployment.file, "d.pmd");
  ASSERT_THAT(deployment.commands, SizeIs(4));
  EXPECT_EQ(deployment.commands[0].spec,
            (CommandSpec{.id = "lidar-driver",
                         .exec = "LCM_DEFAULT_URL=udpm://239.255.76.67:7667?ttl=0 lidar_driver "
                                 "--config ${RIG_CFG}",
                         .group = "sense",
                         .auto_respawn = true,
                         .stop_signal = 2,
                         .stop_time_allowed_s = 3.0F}));
  EXPECT_EQ(deployment.commands[0].deputy, "rig");
  EXPECT_EQ(deployment.commands[0].line, 3);
  EXPECT_EQ(deployment.commands[1].spec.group, "sense/perceive");
  EXPECT_EQ(deployment.commands[2].spec.exec, "clusterer --min-points 10");
  EXPECT_EQ(deployment.commands[3].spec.id, "stop-guard");
  EXPECT_EQ(deployment.commands[3].spec.group, "");
  EXPECT_EQ(deployment.commands[3].spec.stop_signal, 15);
  EXPECT_EQ(deployment.commands[3].line, 10);
}

TEST(PmdReader, ReadsTheScriptsOfTheExample) {
  const Deployment deployment = Parsed(test::kPmdExample);

  ASSERT_THAT(deployment.scripts, SizeIs(3));
  const auto& up = deployment.scripts[0];
  EXPECT_EQ(up.name, "bring-up");
  EXPECT_EQ(up.line, 11);
  ASSERT_THAT(up.actions, SizeIs(4));
  EXPECT_EQ(up.actions[0].kind, ScriptAction::Kind::kStart);
  EXPECT_EQ(up.actions[0].target, (Target{Target::Kind::kCommand, "stop-guard"}));
  EXPECT_EQ(up.actions[0].wait, Status::kRunning);
  EXPECT_EQ(up.actions[2].kind, ScriptAction::Kind::kWaitTime);
  EXPECT_EQ(up.actions[2].duration_ms, 500);
  EXPECT_EQ(up.actions[3].target, (Target{Target::Kind::kGroup, "sense/perceive"}));
  const auto& down = deployment.scripts[1].actions.at(0);
  EXPECT_EQ(down.kind, ScriptAction::Kind::kStop);
  EXPECT_EQ(down.target, (Target{Target::Kind::kEverything, ""}));
  EXPECT_EQ(down.wait, Status::kStopped);
  const auto& again = deployment.scripts[2].actions;
  EXPECT_EQ(again[0].kind, ScriptAction::Kind::kRunScript);
  EXPECT_EQ(again[0].script, "down");
  EXPECT_EQ(again[1].kind, ScriptAction::Kind::kRestart);
  EXPECT_EQ(again[1].wait, Status::kNone);
  EXPECT_EQ(again[1].line, 13);
  EXPECT_EQ(again[2].kind, ScriptAction::Kind::kWaitStatus);
  EXPECT_EQ(again[2].wait, Status::kStopped);
}

TEST(PmdReader, AFileMayHoldNothing) {
  for (const char* text : {"", "\n", "# nothing", " \t\r\n# a\n#b\n"}) {
    const Deployment deployment = Parsed(text);

    EXPECT_THAT(deployment.commands, IsEmpty());
    EXPECT_THAT(deployment.scripts, IsEmpty());
  }
}

TEST(PmdReader, WhatACommandDoesNotSayHasTheReferencesDefault) {
  EXPECT_EQ(OnlyCommand("").spec,
            (CommandSpec{.id = "a",
                         .exec = "x",
                         .group = "",
                         .auto_respawn = false,
                         .stop_signal = 2,
                         .stop_time_allowed_s = 7.0F}));
}

TEST(PmdReader, AutoRespawnIsTrueOrYesInAnyCase) {
  for (const std::string word : {"true", "TRUE", "yes", "Yes"}) {
    EXPECT_TRUE(OnlyCommand("auto_respawn = \"" + word + "\";").spec.auto_respawn) << word;
  }
  for (const std::string word : {"false", "False", "no", "NO"}) {
    EXPECT_FALSE(OnlyCommand("auto_respawn = \"" + word + "\";").spec.auto_respawn) << word;
  }
}

TEST(PmdReader, NumbersReachTheirBounds) {
  EXPECT_EQ(OnlyCommand("stop_signal = 1;").spec.stop_signal, 1);
  EXPECT_EQ(OnlyCommand("stop_signal = 0064;").spec.stop_signal, 64);
  EXPECT_EQ(OnlyCommand("stop_time_allowed = 1;").spec.stop_time_allowed_s, 1.0F);
  EXPECT_EQ(OnlyCommand("stop_time_allowed = 3600;").spec.stop_time_allowed_s, 3600.0F);
  const Deployment deployment = Parsed("script \"s\" { wait ms 0; wait ms 86400000; }");
  EXPECT_EQ(deployment.scripts[0].actions[0].duration_ms, 0);
  EXPECT_EQ(deployment.scripts[0].actions[1].duration_ms, 86'400'000);
}

TEST(PmdReader, HostIsAnotherWordForDeputy) {
  EXPECT_EQ(Parsed("cmd \"a\" { exec = \"x\"; host = \"h\"; }").commands[0].deputy, "h");
}

TEST(PmdReader, TheGroupsAroundACommandCountNotItsAttribute) {
  const Deployment deployment = Parsed(
      "cmd \"a\" { exec = \"x\"; deputy = \"h\"; group = \"g\"; }\n"
      "group \"o\" { cmd \"b\" { exec = \"x\"; deputy = \"h\"; group = \"g/h\"; } }");

  EXPECT_EQ(deployment.commands[0].spec.group, "");
  EXPECT_EQ(deployment.commands[1].spec.group, "o");
}

TEST(PmdReader, AGroupMayBeWrittenInSeveralPlacesAndBeEmpty) {
  const Deployment deployment = Parsed(
      "group \"o\" { group \"i\" {} cmd \"a\" { exec = \"x\"; deputy = \"h\"; } }\n"
      "group \"o\" { group \"i\" { cmd \"b\" { exec = \"x\"; deputy = \"h\"; } } }\n"
      "script \"s\" { start group \"o/i\"; stop group \"o\"; }");

  EXPECT_EQ(deployment.commands[0].spec.group, "o");
  EXPECT_EQ(deployment.commands[1].spec.group, "o/i");
}

TEST(PmdReader, SurplusSlashesInATargetDoNotCount) {
  const Deployment deployment = Parsed(
      "group \"o\" { group \"i\" {} }\n"
      "script \"s\" { start group \"/o//i/\"; wait group \"///o\" status \"running\"; }");

  EXPECT_EQ(deployment.scripts[0].actions[0].target.name, "o/i");
  EXPECT_EQ(deployment.scripts[0].actions[1].target.name, "o");
}

TEST(PmdReader, AStringHasEscapesAndMayHoldSymbolsAndHashes) {
  const Deployment deployment =
      Parsed(R"(cmd "a\"b\\ # {;}" { exec = "x \'\$A\' a\tb\nc\rd\q"; deputy = "ü"; })");

  EXPECT_EQ(deployment.commands[0].spec.id, "a\"b\\ # {;}");
  EXPECT_EQ(deployment.commands[0].spec.exec, "x '$A' a\tb\nc\rdq");
  EXPECT_EQ(deployment.commands[0].deputy, "ü");
}

TEST(PmdReader, WhiteSpaceIsFree) {
  EXPECT_THAT(
      Parsed("cmd\"a\"{exec=\"x\";deputy=\"h\";stop_signal=9;}script\"s\"{wait ms 1;}").scripts,
      SizeIs(1));
  EXPECT_THAT(
      Parsed("\r\ncmd # c\r\n\"a\"\n\n{ exec\n=\t\"x\"# {\n;\vdeputy =\"h\"\f; }#").commands,
      SizeIs(1));
}

TEST(PmdReader, AScriptMayRunAnotherMoreThanOnceAndOneBehindIt) {
  EXPECT_THAT(Parsed("script \"a\" { run_script \"b\"; run_script \"b\"; run_script \"c/d\"; }\n"
                     "script \"b\" { run_script \"c/d\"; }\n"
                     "script \"c/d\" { }")
                  .scripts,
              SizeIs(3));
}

TEST(PmdReader, GroupsNestAsDeepAsIsAllowed) {
  std::string text;
  for (std::size_t i = 0; i < kMaxPmdGroupDepth; ++i) text += "group \"g\" { ";
  text += "cmd \"a\" { exec = \"x\"; deputy = \"h\"; }" + std::string(kMaxPmdGroupDepth, '}');

  EXPECT_THAT(Parsed(text).commands[0].spec.group, SizeIs(2 * kMaxPmdGroupDepth - 1));
}

TEST(PmdReader, ReadsAFileAndNamesItAsItWasNamed) {
  const test::TestFolder folder;
  const auto path = folder.Write("rig.pmd", test::kPmdExample);

  EXPECT_EQ(ReadPmd(path).file, path.string());
  EXPECT_THAT(ReadPmd(path).commands, SizeIs(4));
}

TEST(PmdReader, AFileThatCannotBeReadIsNamed) {
  const test::TestFolder folder;
  const auto missing = folder.path() / "none.pmd";
  const auto broken = folder.Write("broken.pmd", "cmd {");

  EXPECT_THAT(test::RefusalOf([&] { return ReadPmd(missing); }),
              StartsWith(missing.string() + ": "));
  EXPECT_THAT(test::RefusalOf([&] { return ReadPmd(broken); }),
              StartsWith(broken.string() + ":1:1: "));
}

}  // namespace
}  // namespace clearway::io
