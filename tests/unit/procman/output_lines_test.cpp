// SPDX-License-Identifier: BSD-3-Clause
#include "processes/procman_sheriff/output_lines.hpp"

#include <random>
#include <string>
#include <vector>

#include <gmock/gmock.h>

#include "processes/procman_sheriff/text_cells.hpp"

namespace clearway::screen {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

std::vector<std::string> TextsOf(const OutputLines& lines) {
  std::vector<std::string> texts;
  for (std::int64_t i = lines.first(); i < lines.end(); ++i) texts.push_back(lines.At(i).text);
  return texts;
}

std::vector<std::string> LinesOf(std::string_view bytes) {
  OutputLines lines;
  lines.Add(bytes);
  return TextsOf(lines);
}

TEST(OutputLines, SplitsWhatATerminalGivesIntoLines) {
  EXPECT_THAT(LinesOf("one\r\ntwo\n\r\nopen"), ElementsAre("one", "two", "", "open"));
  EXPECT_THAT(LinesOf(""), IsEmpty());
}

TEST(OutputLines, LeavesOutWhatSteersATerminal) {
  EXPECT_THAT(LinesOf("\x1b[1;31mred\x1b[0m \x1b]0;title\x07ok\n"), ElementsAre("red ok"));
  EXPECT_THAT(LinesOf("\x1b]8;;http://x\x1b\\link\x1b]8;;\x1b\\"), ElementsAre("link"));
  EXPECT_THAT(LinesOf("\x1b(Ba\x1b"
                      "7b\x1bPq#1\x1b\\c\x07\x0e"),
              ElementsAre("abc"));
  EXPECT_THAT(LinesOf("\xc2\x9b"
                      "31mx"),
              ElementsAre("x"));
}

TEST(OutputLines, NothingUnfinishedSwallowsTheNextLine) {
  EXPECT_THAT(LinesOf("a\x1b]0;never ended\nb\n"), ElementsAre("a", "b"));
  EXPECT_THAT(LinesOf("a\x1b[12;\nb\n"), ElementsAre("a", "b"));
  EXPECT_THAT(LinesOf("a\x1b\nb\n"), ElementsAre("a", "b"));
}

TEST(OutputLines, AProgressBarIsOneLine) {
  EXPECT_THAT(LinesOf("10 %\r20 %\r\x1b[K100 %\r\ndone\n"), ElementsAre("100 %", "done"));
  EXPECT_THAT(LinesOf("wait |\b/\b-\bready"), ElementsAre("wait ready"));
}

TEST(OutputLines, TabsReachTheNextStop) {
  EXPECT_THAT(LinesOf("a\tb\n12345678\tc"), ElementsAre("a       b", "12345678        c"));
}

TEST(OutputLines, BytesThatAreNoUtf8AreShownAsSuch) {
  EXPECT_THAT(LinesOf("a\xff\xfe"
                      "b\xe4z\n"),
              ElementsAre("a\uFFFD\uFFFDb\uFFFDz"));
}

TEST(OutputLines, IsTheSameHoweverTheBytesAreCut) {
  const std::string bytes =
      "caf\u00e9 \u4e2d\u6587\r\n\x1b[38;5;1mred\x1b[m\x1b]0;t\x1b\\x\r50 %\rall\tdone\n\xe4\xb8";
  const std::vector<std::string> whole = LinesOf(bytes);
  for (std::size_t cut = 0; cut <= bytes.size(); ++cut) {
    OutputLines lines;

    lines.Add(std::string_view(bytes).substr(0, cut));
    lines.Add(std::string_view(bytes).substr(cut));

    EXPECT_EQ(TextsOf(lines), whole) << cut;
  }
}

TEST(OutputLines, ALongLineGoesOnInTheNext) {
  std::string bytes(1000, 'x');
  bytes += "\ny";

  const std::vector<std::string> lines = LinesOf(bytes);

  EXPECT_THAT(
      lines, ElementsAre(std::string(400, 'x'), std::string(400, 'x'), std::string(200, 'x'), "y"));
}

TEST(OutputLines, MarksStandBetweenTheLines) {
  OutputLines lines;

  lines.Add("half");
  lines.AddMark("ended\x1b[2J");
  lines.Add("new\n");

  EXPECT_THAT(TextsOf(lines), ElementsAre("half", "ended[2J", "new"));
  EXPECT_TRUE(lines.At(1).is_mark);
  EXPECT_FALSE(lines.At(2).is_mark);
}

TEST(OutputLines, KeepsTheNewestAndTheirNumbers) {
  OutputLines lines;
  for (int i = 0; i < 5000; ++i) lines.Add(std::to_string(i) + "\n");

  EXPECT_EQ(lines.end(), 5000);
  EXPECT_EQ(lines.first(), 3000);
  EXPECT_EQ(lines.At(4321).text, "4321");

  lines.Add(std::string(3'000'000, '\n'));
  EXPECT_EQ(lines.end() - lines.first(), 2000);
}

TEST(OutputLines, BoundsTheMemoryOfLongLines) {
  OutputLines lines;
  for (int i = 0; i < 3000; ++i) lines.Add(std::string(399, 'x') + "\n");

  std::size_t bytes = 0;
  for (const std::string& text : TextsOf(lines)) bytes += text.size();
  EXPECT_LE(bytes, OutputLines::kMaxBytes);
  EXPECT_GT(bytes, OutputLines::kMaxBytes - 1000);
}

TEST(OutputLines, AnyBytesBecomePrintableLines) {
  std::mt19937 random(11);
  const std::string likely = "\x1b[]P\\;m0\r\n\t\b\x07\xe4\xb8\xad\xc2\x9b";
  for (int round = 0; round < 2000; ++round) {
    std::string bytes(random() % 300, ' ');
    for (char& byte : bytes) {
      byte = random() % 2 == 0 ? likely[random() % likely.size()] : static_cast<char>(random());
    }
    for (const std::string& text : LinesOf(bytes)) {
      EXPECT_EQ(Printable(text), text);
      EXPECT_LE(CellsOf(std::string_view(text)), OutputLines::kMaxCells);
    }
  }
}

TEST(OutputStore, ForgetsTheCommandThatWasSilentForLongest) {
  OutputStore store;
  store.Of("first").Add("a");
  store.Of("second").Add("b");
  for (std::size_t i = 0; i + 2 < OutputStore::kMaxCommands; ++i)
    store.Of(std::to_string(i)).Add("x");
  store.Of("first").Add("a");

  store.Of("one more").Add("c");

  EXPECT_NE(store.Find("first"), nullptr);
  EXPECT_EQ(store.Find("second"), nullptr);
  EXPECT_NE(store.Find("one more"), nullptr);
}

}  // namespace
}  // namespace clearway::screen
