// SPDX-License-Identifier: BSD-3-Clause
#include "processes/procman_sheriff/text_cells.hpp"

#include <numeric>
#include <random>

#include <gmock/gmock.h>

namespace clearway::screen {
namespace {

using testing::ElementsAre;

TEST(TextCells, ReadsEveryCharacterThatItWrites) {
  for (char32_t code = 1; code <= 0x10FFFF; ++code) {
    if (code >= 0xD800 && code <= 0xDFFF) continue;
    std::string text;
    AppendUtf8(code, text);

    const Utf8Step step = FirstCharacter(text);

    ASSERT_EQ(step.code, code);
    ASSERT_EQ(step.bytes, text.size());
    ASSERT_FALSE(step.is_cut);
  }
}

TEST(TextCells, SeesWhereACharacterIsCutAndWhereItIsWrong) {
  EXPECT_TRUE(FirstCharacter("\xe4\xb8").is_cut);
  EXPECT_FALSE(FirstCharacter("\xe4z").is_cut);
  for (const char* wrong :
       {"\xff", "\x80", "\xc0\xaf", "\xe4z", "\xed\xa0\x80", "\xf5\x80\x80\x80"}) {
    EXPECT_EQ(FirstCharacter(wrong).code, kReplacement) << wrong;
    EXPECT_GE(FirstCharacter(wrong).bytes, 1U);
  }
  EXPECT_EQ(FirstCharacter("").bytes, 0U);
}

TEST(TextCells, CountsWideCharactersTwiceAndUnseenOnesNotAtAll) {
  EXPECT_EQ(CellsOf(std::string_view("lidar")), 5);
  EXPECT_EQ(CellsOf(std::string_view("\u4e2d\u6587")), 4);
  EXPECT_EQ(CellsOf(std::string_view("\U0001F600")), 2);
  EXPECT_EQ(CellsOf(char32_t{0x301}), 0);
  EXPECT_EQ(CellsOf(char32_t{0x202E}), 0);
  EXPECT_EQ(CellsOf(kReplacement), 1);
}

TEST(TextCells, LeavesNothingThatSteersATerminal) {
  EXPECT_EQ(Printable("a\x1b[31mb\nc\td\xff\u202e\x7f"), "a[31mb c d\uFFFD");
}

TEST(TextCells, ShortensToWholeCharacters) {
  EXPECT_EQ(Shortened("abcdefgh", 6), "abcd..");
  EXPECT_EQ(Shortened("abcdef", 6), "abcdef");
  EXPECT_EQ(Shortened("\u4e2d\u4e2d\u4e2d\u4e2d", 7), "\u4e2d\u4e2d..");
  EXPECT_EQ(FirstCells("\u4e2d\u4e2d", 3), "\u4e2d");
  EXPECT_EQ(Shortened("abc", 0), "");
}

TEST(TextCells, WrapsAtBlanksWhereThatIsNotWasteful) {
  EXPECT_THAT(Wrapped("the quick brown fox", 10), ElementsAre("the quick", "brown fox"));
  EXPECT_THAT(Wrapped("a bcdefghijklmn", 10), ElementsAre("a bcdefghi", "jklmn"));
  EXPECT_THAT(Wrapped("", 10), ElementsAre(""));
}

TEST(TextCells, AnyBytesBecomeTextThatFits) {
  std::mt19937 random(7);
  for (int round = 0; round < 3000; ++round) {
    std::string bytes(random() % 60, ' ');
    for (char& byte : bytes) byte = static_cast<char>(random());

    const std::string text = Printable(bytes);

    EXPECT_EQ(Printable(text), text);
    const int width = 2 + static_cast<int>(random() % 20);
    EXPECT_LE(CellsOf(std::string_view(Shortened(text, width))), width);
    for (const std::string& piece : Wrapped(text, width)) {
      EXPECT_LE(CellsOf(std::string_view(piece)), width);
    }
  }
}

}  // namespace
}  // namespace clearway::screen
