// SPDX-License-Identifier: BSD-3-Clause
#include "common/core/procman/exec_string.hpp"

#include <map>
#include <random>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace clearway::core::procman {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;
using testing::Pair;

using Words = std::vector<std::string>;

std::optional<std::string> SomeAreSet(const std::string& name) {
  static const std::map<std::string, std::string> kVariables = {
      {"RIG", "/opt/my rig"}, {"A1", "one"}, {"_", "low"}, {"EMPTY", ""}, {"DOLLAR", "$A1"}};
  const auto found = kVariables.find(name);
  if (found == kVariables.end()) return std::nullopt;
  return found->second;
}

ExecLine Parsed(const std::string& text) {
  ParsedExecLine parsed = ParseExecLine(text, SomeAreSet);
  EXPECT_TRUE(parsed.line.has_value()) << text << ": " << parsed.problem;
  return parsed.line.value_or(ExecLine{});
}

Words ArgumentsOf(const std::string& text) {
  return Parsed(text).arguments;
}

std::string ProblemOf(const std::string& text) {
  const ParsedExecLine parsed = ParseExecLine(text, SomeAreSet);
  EXPECT_EQ(parsed.line.has_value(), parsed.problem.empty());
  return parsed.problem;
}

// Writes words in all the ways that the grammar knows, chosen at random.
class RandomQuoter {
 public:
  explicit RandomQuoter(unsigned seed) : random_(seed) {}

  std::size_t Below(std::size_t bound) { return random_() % bound; }

  std::string Word(std::size_t max_length) {
    // Everything that means something, and some that does not.
    constexpr std::string_view kLetters = " \t\n\v\f\r'\"\\$={}aZ_9*?;|~#-/\x80\xff\x01";
    std::string word;
    for (std::size_t i = Below(max_length + 1); i > 0; --i)
      word += kLetters[Below(kLetters.size())];
    return word;
  }

  std::string Quote(const std::string& word) {
    if (word.empty()) return Below(2) == 0 ? "''" : "\"\"";
    std::string quoted;
    std::size_t at = 0;
    while (at < word.size()) {
      const std::string part = word.substr(at, 1 + Below(4));
      at += part.size();
      const char quote = "'\"\0"[Below(3)];
      quoted += quote == '\0' ? Escape(part, true) : quote + Escape(part, false) + quote;
    }
    return quoted;
  }

  std::string Space() {
    std::string space;
    do {
      space += " \t\n\v\f\r"[Below(6)];
    } while (Below(3) == 0);
    return space;
  }

 private:
  std::string Escape(const std::string& part, bool is_bare) {
    const std::string special = is_bare ? "'\"\\$ \t\n\v\f\r" : "'\"\\$";
    std::string escaped;
    for (const char character : part) {
      const bool must = special.find(character) != std::string::npos;
      if (must || Below(4) == 0) escaped += '\\';
      escaped += character;
    }
    return escaped;
  }

  std::mt19937 random_;
};

TEST(ExecString, QuotingAnyWordsAndParsingGivesThemBack) {
  RandomQuoter random(41);
  for (int round = 0; round < 3000; ++round) {
    Words words = {"prog"};
    for (std::size_t i = random.Below(6); i > 0; --i) words.push_back(random.Word(8));
    std::string text = random.Below(2) == 0 ? "" : random.Space();
    text += "prog";
    for (std::size_t i = 1; i < words.size(); ++i) text += random.Space() + random.Quote(words[i]);
    if (random.Below(2) == 0) text += random.Space();

    const ExecLine line = Parsed(text);

    EXPECT_EQ(line.arguments, words) << testing::PrintToString(text);
    EXPECT_THAT(line.environment, IsEmpty());
  }
}

TEST(ExecString, AnyTextEitherParsesOrHasAProblem) {
  RandomQuoter random(42);
  for (int round = 0; round < 20000; ++round) {
    const std::string text = random.Word(30);

    const ParsedExecLine parsed = ParseExecLine(text, SomeAreSet);

    ASSERT_EQ(parsed.line.has_value(), parsed.problem.empty()) << testing::PrintToString(text);
    if (parsed.line) {
      EXPECT_FALSE(parsed.line->arguments.empty());
      EXPECT_FALSE(parsed.line->arguments[0].empty());
    }
  }
}

TEST(ExecString, SettingsComeBackWithTheirOrder) {
  RandomQuoter random(43);
  for (int round = 0; round < 1000; ++round) {
    std::vector<std::pair<std::string, std::string>> settings;
    std::string text;
    for (std::size_t i = random.Below(4); i > 0; --i) {
      settings.emplace_back("N" + std::to_string(i), random.Word(8));
      text += random.Quote(settings.back().first + "=" + settings.back().second) + random.Space();
    }

    const ExecLine line = Parsed(text + "prog A=1");

    EXPECT_EQ(line.environment, settings) << testing::PrintToString(text);
    EXPECT_THAT(line.arguments, ElementsAre("prog", "A=1"));
  }
}

TEST(ExecString, WhatIsFormattedIsParsedIntoTheSameLineAndNothingIsExpanded) {
  const auto all_are_set = [](const std::string&) {
    return std::optional<std::string>("expanded");
  };
  RandomQuoter random(44);
  for (int round = 0; round < 5000; ++round) {
    ExecLine line{.environment = {}, .arguments = {}};
    for (std::size_t i = random.Below(4); i > 0; --i) {
      line.environment.emplace_back("N " + std::to_string(i), random.Word(8));
    }
    line.arguments.push_back("/opt/it's a $HOME \\/" + std::to_string(random.Below(9)));
    for (std::size_t i = random.Below(6); i > 0; --i) line.arguments.push_back(random.Word(12));

    const std::string text = FormatExecLine(line);
    const ParsedExecLine parsed = ParseExecLine(text, all_are_set);

    ASSERT_TRUE(parsed.line.has_value()) << testing::PrintToString(text) << parsed.problem;
    EXPECT_EQ(*parsed.line, line) << testing::PrintToString(text);
  }
}

TEST(ExecString, FormatsPlainWordsAsTheyAre) {
  EXPECT_EQ(FormatExecLine({.environment = {{"A", "1"}}, .arguments = {"prog", "--set", "b.c=d"}}),
            "A=1 prog --set b.c=d");
}

TEST(ExecString, RefusesToFormatWhatTheGrammarCannotSay) {
  const std::vector<ExecLine> lines = {{.environment = {}, .arguments = {}},
                                       {.environment = {}, .arguments = {""}},
                                       {.environment = {}, .arguments = {"a=b/prog"}},
                                       {.environment = {}, .arguments = {"prog", {"a\0b", 3}}},
                                       {.environment = {{"", "1"}}, .arguments = {"prog"}},
                                       {.environment = {{"A=B", "1"}}, .arguments = {"prog"}}};
  for (const ExecLine& line : lines)
    EXPECT_THROW((void)FormatExecLine(line), std::invalid_argument);
}

TEST(ExecString, KeepsALastArgumentOfOneCharacter) {
  EXPECT_THAT(ArgumentsOf("sleep 5"), ElementsAre("sleep", "5"));
  EXPECT_THAT(ArgumentsOf("x"), ElementsAre("x"));
  EXPECT_THAT(ArgumentsOf("a b c"), ElementsAre("a", "b", "c"));
}

TEST(ExecString, WhiteSpaceSeparatesAndQuotesJoin) {
  EXPECT_THAT(ArgumentsOf("  a \t b\nc\v\f\rd  "), ElementsAre("a", "b", "c", "d"));
  EXPECT_THAT(ArgumentsOf("a 'b c' \"d e\""), ElementsAre("a", "b c", "d e"));
  EXPECT_THAT(ArgumentsOf("a x'b c'y\"d e\"z"), ElementsAre("a", "xb cyd ez"));
  EXPECT_THAT(ArgumentsOf("a '\"' \"'\""), ElementsAre("a", "\"", "'"));
  EXPECT_THAT(ArgumentsOf("a '' b \"\""), ElementsAre("a", "", "b", ""));
}

TEST(ExecString, ABackslashTakesTheNextCharacterLiterallyAlsoInQuotes) {
  EXPECT_THAT(ArgumentsOf("a b\\ c"), ElementsAre("a", "b c"));
  EXPECT_THAT(ArgumentsOf("a 'b\\'c' \"d\\\"e\""), ElementsAre("a", "b'c", "d\"e"));
  EXPECT_THAT(ArgumentsOf("a \\n '\\n' \\\\"), ElementsAre("a", "n", "n", "\\"));
}

TEST(ExecString, NoShellIsInvolved) {
  EXPECT_THAT(ArgumentsOf("a *.c | b; ~ > c && #d"),
              ElementsAre("a", "*.c", "|", "b;", "~", ">", "c", "&&", "#d"));
}

TEST(ExecString, ExpandsVariablesThatAreSet) {
  EXPECT_THAT(ArgumentsOf("a $A1 ${A1}x $A1-x $_"),
              ElementsAre("a", "one", "onex", "one-x", "low"));
  EXPECT_THAT(ArgumentsOf("a '$A1' \"${A1}\""), ElementsAre("a", "one", "one"));
  EXPECT_THAT(ArgumentsOf("$RIG/bin --x $RIG"),
              ElementsAre("/opt/my rig/bin", "--x", "/opt/my rig"));
  EXPECT_THAT(ArgumentsOf("a $EMPTY b"), ElementsAre("a", "", "b"));
  EXPECT_THAT(ArgumentsOf("a $DOLLAR"), ElementsAre("a", "$A1"));
}

TEST(ExecString, AVariableThatIsNotSetStaysAsItIsWritten) {
  EXPECT_THAT(ArgumentsOf("a $NOPE_X ${NOPE} $A1x $NOPE$A1"),
              ElementsAre("a", "$NOPE_X", "${NOPE}", "$A1x", "$NOPEone"));
  EXPECT_THAT(ArgumentsOf("a $ $$ $1 ${} ${A1 ${A1-x} $'A1'"),
              ElementsAre("a", "$", "$$", "$1", "${}", "${A1", "${A1-x}", "one"));
}

TEST(ExecString, ALiteralDollarIsNotExpandedAndKeepsItself) {
  EXPECT_THAT(ArgumentsOf("a \\$A1 \\${A1} '\\$A1' \\\\$A1"),
              ElementsAre("a", "$A1", "${A1}", "$A1", "\\one"));
  EXPECT_THAT(ArgumentsOf("a $\\A1 $A\\1 $\\{A1}"), ElementsAre("a", "$A1", "$A1", "${A1}"));
}

TEST(ExecString, LeadingWordsWithAnEqualsSignAreSettingsAndAreNotExpanded) {
  const ExecLine line = Parsed("A=$A1 'B=x y' C= D=e=f prog E=5");

  EXPECT_THAT(line.environment,
              ElementsAre(Pair("A", "$A1"), Pair("B", "x y"), Pair("C", ""), Pair("D", "e=f")));
  EXPECT_THAT(line.arguments, ElementsAre("prog", "E=5"));
}

TEST(ExecString, SaysWhatIsWrong) {
  EXPECT_EQ(ProblemOf(""), "it names no program");
  EXPECT_EQ(ProblemOf(" \t\n"), "it names no program");
  EXPECT_EQ(ProblemOf("A=1 B=2"), "it names no program");
  EXPECT_EQ(ProblemOf("'' x"), "it names no program");
  EXPECT_EQ(ProblemOf("$EMPTY x"), "it names no program");
  EXPECT_EQ(ProblemOf("a 'b"), "the quote ' at byte 3 is not closed");
  EXPECT_EQ(ProblemOf("a 'b' c\"d'"), "the quote \" at byte 8 is not closed");
  EXPECT_EQ(ProblemOf("a b\\"), "it ends in a backslash");
  EXPECT_EQ(ProblemOf("a 'b\\"), "it ends in a backslash");
  EXPECT_EQ(ProblemOf(std::string("a\0b", 3)), "byte 2 is NUL");
  EXPECT_EQ(ProblemOf(std::string("a\\\0b", 4)), "byte 3 is NUL");
  EXPECT_EQ(ProblemOf("=1 a"), "a setting has no variable's name before its =");
}

TEST(ExecString, RefusesWhatIsTooLong) {
  const std::string longest = "a " + std::string(kMaxExecBytes - 2, 'b');

  EXPECT_EQ(ProblemOf(longest), "");
  EXPECT_EQ(ProblemOf(longest + "b"), "it has 16385 bytes: at most 16384 are allowed");
}

TEST(ExecString, RefusesVariablesThatMakeItTooLong) {
  const auto lookup = [](const std::string&) { return std::string(1000, 'v'); };
  std::string text = "a";
  for (int i = 0; i < 131; ++i) text += " $V";

  EXPECT_TRUE(ParseExecLine(text, lookup).line.has_value());
  EXPECT_EQ(ParseExecLine(text + "$V$V", lookup).problem,
            "with its variables' values it has more than 131072 bytes");
  EXPECT_EQ(ParseExecLine(text + " $V", lookup).problem,
            "with its variables' values it has more than 131072 bytes");
}

}  // namespace
}  // namespace clearway::core::procman
