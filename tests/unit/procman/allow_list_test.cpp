// SPDX-License-Identifier: BSD-3-Clause
#include "common/core/procman/allow_list.hpp"

#include <random>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace clearway::core::procman {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

ExecLine LineOf(const std::string& text) {
  const ParsedExecLine parsed =
      ParseExecLine(text, [](const std::string&) { return std::optional<std::string>(); });
  EXPECT_EQ(parsed.problem, "") << text;
  return parsed.line.value_or(ExecLine{});
}

std::string WhyRefused(const std::vector<AllowRule>& rules, const std::string& command) {
  for (const AllowRule& rule : rules) EXPECT_THAT(rule.Validate(), IsEmpty());
  return AllowList(rules).WhyRefused(LineOf(command));
}

AllowRule Arguments(const std::string& arguments) {
  return {.program = "p", .arguments = arguments, .environment = ""};
}

AllowRule Environment(const std::string& environment) {
  return {.program = "p", .arguments = "", .environment = environment};
}

// Tries all ways: slow, and hardly to be got wrong.
bool IsWildcardMatch(std::string_view pattern, std::string_view text) {
  if (pattern.empty()) return text.empty();
  if (pattern[0] == '*') {
    return IsWildcardMatch(pattern.substr(1), text) ||
           (!text.empty() && IsWildcardMatch(pattern, text.substr(1)));
  }
  return !text.empty() && (pattern[0] == '?' || pattern[0] == text[0]) &&
         IsWildcardMatch(pattern.substr(1), text.substr(1));
}

TEST(AllowList, MatchesAsTryingAllWaysDoes) {
  std::mt19937 random(17);
  const auto any_of = [&](std::string_view letters, std::size_t length) {
    std::string word;
    for (std::size_t i = 0; i < length; ++i) word += letters[random() % letters.size()];
    return word;
  };
  for (int round = 0; round < 20000; ++round) {
    const std::string pattern = any_of("a[]/.=*?", 1 + random() % 6);
    const std::string argument = any_of("a[]/.=", 1 + random() % 6);
    if (pattern == "...") continue;

    const std::string why = WhyRefused({Arguments(pattern)}, "p " + argument);

    ASSERT_EQ(why.empty(), IsWildcardMatch(pattern, argument)) << pattern << " and " << argument;
  }
}

TEST(AllowList, ARuleWithoutWildcardsAllowsItsOwnWordsOnly) {
  const std::vector<AllowRule> rules = {Arguments("--file 'my \"file\"' a\\ b")};

  EXPECT_EQ(WhyRefused(rules, "p --file 'my \"file\"' 'a b'"), "");
  EXPECT_NE(WhyRefused(rules, "p --file 'my file' 'a b'"), "");
  EXPECT_NE(WhyRefused(rules, "p '--file my \"file\" a b'"), "");
}

TEST(AllowList, NothingIsAllowedWithoutARule) {
  EXPECT_EQ(WhyRefused({}, "rm -rf /"), "no rule allows the program \"rm\"");
}

TEST(AllowList, TheProgramIsComparedExactly) {
  const std::vector<AllowRule> rules = {
      {.program = "lidar*", .arguments = "...", .environment = "*"}};

  EXPECT_EQ(WhyRefused(rules, "'lidar*'"), "");
  EXPECT_EQ(WhyRefused(rules, "lidar-driver"), "no rule allows the program \"lidar-driver\"");
  EXPECT_EQ(WhyRefused({Arguments("")}, "./p"), "no rule allows the program \"./p\"");
  EXPECT_EQ(WhyRefused({Arguments("")}, "/tmp/p"), "no rule allows the program \"/tmp/p\"");
}

TEST(AllowList, EmptyArgumentsAllowNone) {
  EXPECT_EQ(WhyRefused({Arguments("")}, "p"), "");
  EXPECT_EQ(WhyRefused({Arguments("")}, "p ''"), "argument 1 \"\" of \"p\" is not allowed");
}

TEST(AllowList, WildcardsStayWithinOneArgument) {
  const std::vector<AllowRule> rules = {Arguments("--config * -?")};

  EXPECT_EQ(WhyRefused(rules, "p --config /etc/a.xml -v"), "");
  EXPECT_EQ(WhyRefused(rules, "p --config '' -v"), "");
  EXPECT_EQ(WhyRefused(rules, "p --config a b -v"), "argument 3 \"b\" of \"p\" is not allowed");
  EXPECT_EQ(WhyRefused(rules, "p --config a -vv"), "argument 3 \"-vv\" of \"p\" is not allowed");
  EXPECT_EQ(WhyRefused(rules, "p --config a"), "\"p\" is not allowed without an argument 3");
}

TEST(AllowList, DotsAsTheLastWordAllowAnyFurtherArguments) {
  const std::vector<AllowRule> rules = {Arguments("--safe ...")};

  EXPECT_EQ(WhyRefused(rules, "p --safe"), "");
  EXPECT_EQ(WhyRefused(rules, "p --safe a '' b"), "");
  EXPECT_EQ(WhyRefused(rules, "p"), "\"p\" is not allowed without an argument 1");
  EXPECT_EQ(WhyRefused(rules, "p -x"), "argument 1 \"-x\" of \"p\" is not allowed");
}

TEST(AllowList, ABackslashMakesWildcardsAndDotsLiteral) {
  EXPECT_EQ(WhyRefused({Arguments("\\* a\\?")}, "p '*' 'a?'"), "");
  EXPECT_NE(WhyRefused({Arguments("\\* a\\?")}, "p x 'a?'"), "");
  EXPECT_NE(WhyRefused({Arguments("\\* a\\?")}, "p '*' ab"), "");
  EXPECT_EQ(WhyRefused({Arguments("'a *'")}, "p 'a b'"), "");
  EXPECT_EQ(WhyRefused({Arguments("a \\...")}, "p a ..."), "");
  EXPECT_NE(WhyRefused({Arguments("a \\...")}, "p a b"), "");
  EXPECT_EQ(WhyRefused({Arguments("\\\\d")}, "p '\\\\d'"), "");
}

TEST(AllowList, VariablesNeedAPatternOfTheirOwn) {
  const std::vector<AllowRule> rules = {Environment("LCM_DEFAULT_URL=udpm://* MY_*=* LEVEL")};

  EXPECT_EQ(WhyRefused(rules, "p"), "");
  EXPECT_EQ(WhyRefused(rules, "LCM_DEFAULT_URL=udpm://239.255.76.67:7667?ttl=0 MY_A= p"), "");
  EXPECT_EQ(WhyRefused(rules, "LEVEL=any p"), "");
  EXPECT_EQ(WhyRefused(rules, "LCM_DEFAULT_URL=tcpq://x p"),
            "variable \"LCM_DEFAULT_URL=tcpq://x\" of \"p\" is not allowed");
  EXPECT_EQ(WhyRefused(rules, "MY_A=1 OUR_A=2 p"), "variable \"OUR_A=2\" of \"p\" is not allowed");
  EXPECT_NE(WhyRefused(rules, "LEVEL2=any p"), "");
}

TEST(AllowList, DangerousVariablesAreAllowedOnlyWhereAPatternSaysSo) {
  for (const std::string setting : {"LD_PRELOAD=/tmp/x.so", "PATH=/tmp", "LD_LIBRARY_PATH=."}) {
    EXPECT_THAT(WhyRefused({Environment("")}, setting + " p"), HasSubstr(setting));
    EXPECT_NE(WhyRefused({Environment("CLEARWAY_*=* *_LEVEL=*")}, setting + " p"), "");
    EXPECT_EQ(WhyRefused({Environment("*")}, setting + " p"), "");
    EXPECT_EQ(WhyRefused({Environment("*=*")}, setting + " p"), "");
  }
  EXPECT_EQ(WhyRefused({Environment("LD_*=*")}, "LD_PRELOAD=/tmp/x.so p"), "");
}

TEST(AllowList, APatternOfAVariablesNameDoesNotReachIntoAnothersValue) {
  const std::vector<AllowRule> rules = {Environment("*_LEVEL=debug")};

  EXPECT_EQ(WhyRefused(rules, "MY_LEVEL=debug p"), "");
  EXPECT_NE(WhyRefused(rules, "LD_PRELOAD=/tmp/x_LEVEL=debug p"), "");
}

TEST(AllowList, WhatTheDeputyReadsItselfIsAlwaysAllowed) {
  EXPECT_EQ(WhyRefused({Environment("")},
                       "CLEARWAY_STATUS_CHANNEL=X_STATUS CLEARWAY_RESTART_UNHEALTHY=no p"),
            "");
  EXPECT_NE(WhyRefused({Environment("")}, "CLEARWAY_STATUS_CHANNEL2=X p"), "");
}

TEST(AllowList, OneRuleOfSeveralIsEnoughButItMustAllowEverything) {
  const std::vector<AllowRule> rules = {{.program = "p", .arguments = "--a *", .environment = ""},
                                        {.program = "q", .arguments = "...", .environment = "*"},
                                        {.program = "p", .arguments = "--b", .environment = "B=*"}};

  EXPECT_EQ(WhyRefused(rules, "p --a 1"), "");
  EXPECT_EQ(WhyRefused(rules, "B=2 p --b"), "");
  EXPECT_EQ(WhyRefused(rules, "B=2 p --a 1"), "variable \"B=2\" of \"p\" is not allowed");
  EXPECT_EQ(WhyRefused(rules, "p --b 1"), "argument 2 \"1\" of \"p\" is not allowed");
  EXPECT_EQ(WhyRefused(rules, "p --c 1"), "argument 1 \"--c\" of \"p\" is not allowed");
}

TEST(AllowList, AMessageIsOneReadableLine) {
  const std::string why =
      WhyRefused({Arguments("")}, "p 'a\n\x1b[31m\xff" + std::string(90, 'b') + "'");

  EXPECT_EQ(why, "argument 1 \"a??[31m?" + std::string(72, 'b') + "...\" of \"p\" is not allowed");
}

TEST(AllowRule, SaysWhatIsWrongWithItsPatterns) {
  const auto problems = [](const AllowRule& rule) { return rule.Validate(); };

  EXPECT_THAT(problems({.program = "", .arguments = "", .environment = ""}),
              ElementsAre("program must not be empty"));
  EXPECT_THAT(problems(Arguments("'a")),
              ElementsAre("arguments must be words as in a command, but the quote ' at byte 1 is "
                          "not closed"));
  EXPECT_THAT(problems(Arguments("a ... b ... c")),
              ElementsAre("arguments must have ... as the last word only"));
  EXPECT_THAT(problems(Environment("A=\\")),
              ElementsAre("environment must be words as in a command, but it ends in a backslash"));
  EXPECT_THAT(problems(Environment("A=* =b ''")),
              ElementsAre("environment must have a variable's name in each pattern, not \"=b\"",
                          "environment must have a variable's name in each pattern, not \"\""));
}

}  // namespace
}  // namespace clearway::core::procman
