// SPDX-License-Identifier: BSD-3-Clause
#include "tools/doctor/report.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

namespace clearway::doctor {
namespace {

using testing::ElementsAre;

const Finding kOk{"port", State::kOk, "can be bound", {}};
const Finding kWarned{"user", State::kWarning, "a", {}};
const Finding kUnknown{"digests", State::kNotChecked, "nobody was heard", {}};
const Finding kBad{"receive_buffer",
                   State::kProblem,
                   "too small",
                   {"sudo sysctl -w net.core.rmem_max=1", "echo 'x' | sudo tee /etc/x"}};

TEST(Report, HasALineForEachFindingAndItsCommands) {
  EXPECT_EQ(FormatText({kOk, kWarned, kBad, kUnknown}),
            "[ok]      port             can be bound\n"
            "[warning] user             a\n"
            "[PROBLEM] receive_buffer   too small\n"
            "          mend: sudo sysctl -w net.core.rmem_max=1\n"
            "          mend: echo 'x' | sudo tee /etc/x\n"
            "[-]       digests          not checked: nobody was heard\n"
            "1 problem, 1 warning\n");
}

TEST(Report, PrintsNoControlCharactersOfOthers) {
  EXPECT_EQ(FormatText({{"port", State::kOk, "a\x1b[2J\nb", {}}}),
            "[ok]      port             a?[2J?b\n0 problems, 0 warnings\n");
}

TEST(Report, OnlyProblemsMakeTheExitStatus) {
  EXPECT_EQ(ExitStatusOf({kOk, kWarned, kUnknown}), 0);
  EXPECT_EQ(ExitStatusOf({kOk, kBad}), 1);
  EXPECT_EQ(ExitStatusOf({}), 0);
}

TEST(Report, JsonHasAllOfIt) {
  const auto json =
      nlohmann::json::parse(FormatJson({"1.0", "h\xff", "d"}, {kBad, kWarned, kUnknown}));

  EXPECT_EQ(json["version"], "1.0");
  EXPECT_EQ(json["deputy"], "d");
  EXPECT_EQ(json["problems"], 1);
  EXPECT_EQ(json["warnings"], 1);
  ASSERT_EQ(json["findings"].size(), 3U);
  EXPECT_EQ(json["findings"][0]["check"], "receive_buffer");
  EXPECT_EQ(json["findings"][0]["state"], "problem");
  EXPECT_EQ(json["findings"][0]["mend"][0], "sudo sysctl -w net.core.rmem_max=1");
  EXPECT_EQ(json["findings"][2]["state"], "not checked");
}

TEST(Mend, RootNeedsNoSudo) {
  EXPECT_THAT(ForRoot(kBad).mend,
              ElementsAre("sysctl -w net.core.rmem_max=1", "echo 'x' | tee /etc/x"));
}

TEST(Mend, WordsAreQuotedForTheShell) {
  EXPECT_EQ(ShellWord("/etc/a-b.xml"), "/etc/a-b.xml");
  EXPECT_EQ(ShellWord("a b"), "'a b'");
  EXPECT_EQ(ShellWord("it's"), "'it'\\''s'");
  EXPECT_EQ(ShellWord("$(reboot)"), "'$(reboot)'");
  EXPECT_EQ(ShellWord(""), "''");
}

TEST(Mend, LongListsAreCut) {
  EXPECT_EQ(Join({"a", "b"}), "a, b");
  EXPECT_EQ(Join(std::vector<std::string>(10, "x")), "x, x, x, x, x, x, x, x and 2 more");
}

}  // namespace
}  // namespace clearway::doctor
