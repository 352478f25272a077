// SPDX-License-Identifier: BSD-3-Clause
#include "tools/teleop/keys.hpp"

#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace clearway::teleop {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

TEST(KeyDecoder, KnowsLettersInBothCases) {
  KeyDecoder decoder;

  EXPECT_THAT(decoder.Decode("wsadWSAD qQ"),
              ElementsAre(Key::kForward,
                          Key::kBackward,
                          Key::kLeft,
                          Key::kRight,
                          Key::kForward,
                          Key::kBackward,
                          Key::kLeft,
                          Key::kRight,
                          Key::kStop,
                          Key::kQuit,
                          Key::kQuit));
}

TEST(KeyDecoder, KnowsArrowsOfBothKindsOfTerminals) {
  KeyDecoder decoder;

  EXPECT_THAT(decoder.Decode("\x1b[A\x1b[B\x1b[C\x1b[D\x1bOA\x1bOB\x1bOC\x1bOD"),
              ElementsAre(Key::kForward,
                          Key::kBackward,
                          Key::kRight,
                          Key::kLeft,
                          Key::kForward,
                          Key::kBackward,
                          Key::kRight,
                          Key::kLeft));
}

TEST(KeyDecoder, PutsTogetherWhatComesInPieces) {
  KeyDecoder decoder;

  EXPECT_THAT(decoder.Decode("\x1b"), IsEmpty());
  EXPECT_THAT(decoder.Decode("["), IsEmpty());
  EXPECT_THAT(decoder.Decode("Aw"), ElementsAre(Key::kForward, Key::kForward));
}

TEST(KeyDecoder, TakesOtherSequencesAsOneKeyThatDoesNothing) {
  KeyDecoder decoder;

  EXPECT_THAT(decoder.Decode("\x1b[15~"), ElementsAre(Key::kOther)) << "F5";
  EXPECT_THAT(decoder.Decode("\x1b[1;5A"), ElementsAre(Key::kOther)) << "Ctrl and up";
  EXPECT_THAT(decoder.Decode("\x1bw"), ElementsAre(Key::kOther)) << "Alt and w";
  EXPECT_THAT(decoder.Decode("\x1b[<0;10;20M"), ElementsAre(Key::kOther)) << "a mouse";
}

TEST(KeyDecoder, StopsAndQuitsAlsoAfterALoneEscape) {
  KeyDecoder decoder;

  EXPECT_THAT(decoder.Decode("\x1b "), ElementsAre(Key::kStop));
  EXPECT_THAT(decoder.Decode("\x1bq"), ElementsAre(Key::kQuit));
}

TEST(KeyDecoder, BeginsAnewWithAnEscapeWithinASequence) {
  KeyDecoder decoder;

  EXPECT_THAT(decoder.Decode("\x1b[1\x1b[A"), ElementsAre(Key::kForward));
}

// Only the seven keys mean something, whatever else comes.
TEST(KeyDecoder, TakesEveryOtherByteAsAKeyThatDoesNothing) {
  const std::string meaning = "wWsSaAdD qQ\x1b";
  for (int byte = 0; byte < 256; ++byte) {
    const auto c = static_cast<char>(byte);
    if (meaning.find(c) != std::string::npos) continue;
    KeyDecoder decoder;

    EXPECT_THAT(decoder.Decode(std::string(1, c)), ElementsAre(Key::kOther)) << byte;
  }
}

TEST(KeyDecoder, DoesNotGrowWithAnEndlessSequence) {
  KeyDecoder decoder;

  EXPECT_THAT(decoder.Decode("\x1b[" + std::string(100'000, '1')), IsEmpty());
  EXPECT_THAT(decoder.Decode("Aw"), ElementsAre(Key::kOther, Key::kForward));
}

}  // namespace
}  // namespace clearway::teleop
