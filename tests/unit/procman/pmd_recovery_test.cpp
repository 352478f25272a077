// SPDX-License-Identifier: BSD-3-Clause
// How reading goes on after a problem: all that can be told apart is reported, and no more.
#include <algorithm>
#include <random>
#include <regex>
#include <sstream>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/unit/procman/pmd_example.hpp"

namespace clearway::io {
namespace {

using test::kPmdExample;
using test::PmdRefusal;

std::vector<std::string> LinesOf(const std::string& text) {
  std::vector<std::string> lines;
  std::istringstream stream(text);
  for (std::string line; std::getline(stream, line);) lines.push_back(line);
  return lines;
}

// Either parses, or says where it does not in lines of this form, in the file's order.
void ExpectSoundRefusal(const std::string& text) {
  static const std::regex kForm("d\\.pmd:([0-9]+):([0-9]+): [ -~]+: expected [ -~]+");
  const std::vector<std::string> lines = LinesOf(PmdRefusal(text));
  const auto last_line = std::count(text.begin(), text.end(), '\n') + 1;
  long before = 0;
  for (const std::string& line : lines) {
    std::smatch found;
    ASSERT_TRUE(std::regex_match(line, found, kForm)) << line << "\nof\n" << text;
    const long number = std::stol(found[1]);
    EXPECT_GE(number, std::max(before, 1L)) << line;
    EXPECT_LE(number, last_line) << line;
    before = number;
  }
  EXPECT_LE(lines.size(), kMaxPmdProblems);
}

std::string WithoutAt(std::string text, std::size_t at) {
  return text.erase(at, 1);
}

TEST(PmdRecovery, EveryPrefixOfAFileParsesOrHasSoundProblems) {
  for (std::size_t length = 0; length <= kPmdExample.size(); ++length) {
    ExpectSoundRefusal(kPmdExample.substr(0, length));
  }
}

TEST(PmdRecovery, AnyDamageOfAFileGivesSoundProblems) {
  std::mt19937 random(5);
  for (int round = 0; round < 3000; ++round) {
    std::string text = kPmdExample;
    for (std::size_t i = 1 + random() % 8; i > 0; --i) {
      const std::size_t at = random() % text.size();
      const std::string part = kPmdExample.substr(random() % kPmdExample.size(), random() % 20);
      text.replace(at, random() % 20, part);
      text[random() % text.size()] = "\"{};=#\n\\\0\xff"[random() % 10];
    }
    ExpectSoundRefusal(text);
  }
}

TEST(PmdRecovery, ASymbolOrQuoteThatIsMissingGivesFewProblems) {
  // One where it is missing; what follows may be read otherwise than it was meant, but not wildly.
  constexpr std::size_t kFew = 3;
  // Within this string a symbol is just text.
  const std::size_t begin = kPmdExample.find("LCM_DEFAULT_URL");
  const std::size_t end = kPmdExample.find('"', begin);
  for (std::size_t at = 0; at < kPmdExample.size(); ++at) {
    if (std::string("{};=\"").find(kPmdExample[at]) == std::string::npos) continue;
    if (at >= begin && at < end) continue;
    const std::vector<std::string> lines = LinesOf(PmdRefusal(WithoutAt(kPmdExample, at)));
    EXPECT_GE(lines.size(), 1U) << at;
    EXPECT_LE(lines.size(), kFew) << PmdRefusal(WithoutAt(kPmdExample, at));
  }
}

TEST(PmdRecovery, ReportsProblemsOfSeveralPlacesInTheFilesOrder) {
  EXPECT_EQ(PmdRefusal("cmd \"a\" {\n"
                       "  exec = \"x\"\n"
                       "  deputy = \"h\";\n"
                       "  stop_signal = 99;\n"
                       "}\n"
                       "comand \"b\" { exec = \"x\"; deputy = \"h\"; }\n"
                       "group \"g\" {\n"
                       "  cmd \"a\" { exe = \"x\"; deputy = \"h\"; }\n"
                       "  cmd \"c\" { exec = \"x\"; }\n"
                       "}\n"
                       "script \"s\" { start cmd \"b\"; stop all; }\n"),
            "d.pmd:3:3: \"deputy\": expected ';'\n"
            "d.pmd:4:17: \"99\": expected a signal's number, a whole number from 1 to 64\n"
            "d.pmd:6:1: \"comand\": expected cmd, group or script\n"
            "d.pmd:8:7: cmd \"a\" is there already in line 1: expected another id\n"
            "d.pmd:8:13: \"exe\": expected exec, deputy, auto_respawn, stop_signal, "
            "stop_time_allowed or '}'\n"
            "d.pmd:9:3: cmd \"c\" without deputy: expected deputy = \"NAME\";\n"
            "d.pmd:11:34: \"all\": expected everything, cmd or group");
}

TEST(PmdRecovery, AQuoteThatIsMissingIsTheOnlyProblem) {
  const std::string body = " exec = \"x\";\n deputy = \"h\";\n}\nscript \"s\" { stop cmd \"a\"; }";

  EXPECT_EQ(PmdRefusal("cmd \"a {\n" + body),
            "d.pmd:1:5: string \"a\" without its second quote: expected '\"' in the same line");
  EXPECT_EQ(PmdRefusal("cmd \"a\" {\n exec = \"x;\n deputy = \"h\";\n}"),
            "d.pmd:2:9: string \"x\" without its second quote: expected '\"' in the same line");
  EXPECT_EQ(PmdRefusal("cmd \"a\" {\n exec = x\";\n deputy = \"h\";\n}"),
            "d.pmd:2:9: \"x\": expected the value of exec, in double quotes");
  EXPECT_EQ(PmdRefusal("cmd a\" {\n" + body),
            "d.pmd:1:5: \"a\": expected the command's id, in double quotes");
}

TEST(PmdRecovery, ABraceThatIsMissingIsTheOnlyProblem) {
  const std::string command = "cmd \"b\" { exec = \"x\"; deputy = \"h\"; }\n";
  const std::string attributes =
      "exec, deputy, auto_respawn, stop_signal, stop_time_allowed or '}'";

  EXPECT_EQ(PmdRefusal("cmd \"a\" {\n exec = \"x\";\n deputy = \"h\";\n" + command),
            "d.pmd:4:1: \"cmd\": expected " + attributes);
  EXPECT_EQ(PmdRefusal("cmd \"a\"\n exec = \"x\";\n deputy = \"h\";\n}\n" + command),
            "d.pmd:2:2: \"exec\": expected '{'");
  EXPECT_EQ(PmdRefusal("group \"g\"\n" + command + "}\n"), "d.pmd:2:1: \"cmd\": expected '{'");
  EXPECT_EQ(PmdRefusal("script \"s\" {\n wait ms 5;\n" + command),
            "d.pmd:3:1: \"cmd\": expected start, stop, restart, wait, run_script or '}'");
  EXPECT_EQ(PmdRefusal("script \"s\"\n wait ms 5;\n}\n" + command),
            "d.pmd:2:2: \"wait\": expected '{'");
  EXPECT_EQ(PmdRefusal(command + "}\n" + command.substr(0, 5) + "c" + command.substr(6)),
            "d.pmd:2:1: '}': expected cmd, group or script");
}

TEST(PmdRecovery, NoMoreThanTwentyProblemsAreReported) {
  std::string text;
  for (int i = 0; i < 50; ++i) text += "x;\n";

  const std::vector<std::string> lines = LinesOf(PmdRefusal(text));

  ASSERT_EQ(lines.size(), kMaxPmdProblems);
  EXPECT_EQ(lines.back(), "d.pmd:20:1: \"x\": expected cmd, group or script");
}

TEST(PmdRecovery, DeepNestingIsRefusedWithoutHarm) {
  for (const std::string opening : {"group \"g\" {", "{", "group \"g\"", "cmd \"a\" {", "x { "}) {
    std::string text;
    while (text.size() + opening.size() < kMaxPmdBytes) text += opening;
    ExpectSoundRefusal(text);
  }
  std::string nested;
  for (std::size_t i = 0; i <= kMaxPmdGroupDepth; ++i) nested += "group \"g\" {\n";
  EXPECT_EQ(PmdRefusal(nested + std::string(kMaxPmdGroupDepth + 1, '}') +
                       " cmd \"a\" {"
                       "exec = \"x\"; }"),
            "d.pmd:33:1: group \"g\" in 32 others: expected fewer\n"
            "d.pmd:34:35: cmd \"a\" without deputy: expected deputy = \"NAME\";");
}

}  // namespace
}  // namespace clearway::io
