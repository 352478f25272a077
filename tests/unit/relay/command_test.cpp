// SPDX-License-Identifier: BSD-3-Clause
#include "tools/relay/command.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace clearway::relay {
namespace {

using Verb = Command::Verb;

TEST(CommandTest, AFaultIsForAllDirectionsUnlessOneIsNamed) {
  const Command all = ParseCommand("loss 0.5");
  const Command one = ParseCommand("  delay-ms   2.5 robot:laptop ");
  const Command half = ParseCommand("jitter-ms 1 *:laptop");

  EXPECT_EQ(all.verb, Verb::kLoss);
  EXPECT_EQ(all.value, 0.5);
  EXPECT_EQ(all.from + ':' + all.to, "*:*");
  EXPECT_EQ(one.verb, Verb::kDelay);
  EXPECT_EQ(one.value, 2.5);
  EXPECT_EQ(one.from + ':' + one.to, "robot:laptop");
  EXPECT_EQ(half.verb, Verb::kJitter);
  EXPECT_EQ(half.from + ':' + half.to, "*:laptop");
}

TEST(CommandTest, APortIsCutAndMended) {
  EXPECT_EQ(ParseCommand("cut laptop").verb, Verb::kCut);
  EXPECT_EQ(ParseCommand("cut laptop").from, "laptop");
  EXPECT_EQ(ParseCommand("mend laptop").verb, Verb::kMend);
}

TEST(CommandTest, SomeAreOneWord) {
  EXPECT_EQ(ParseCommand("stats").verb, Verb::kStatistics);
  EXPECT_EQ(ParseCommand("quit").verb, Verb::kQuit);
}

TEST(CommandTest, TheBoundsOfValuesAreValues) {
  EXPECT_EQ(ParseCommand("duplicate 0").value, 0.0);
  EXPECT_EQ(ParseCommand("duplicate 1").value, 1.0);
  EXPECT_EQ(ParseCommand("delay-ms 60000").value, 60'000.0);
}

TEST(CommandTest, AllElseIsRefused) {
  for (const char* line : {"",
                           "   ",
                           "los 1",
                           "loss",
                           "loss x",
                           "loss 0.5x",
                           "loss -1",
                           "loss 1.01",
                           "loss nan",
                           "loss inf",
                           "delay-ms 60001",
                           "loss 0.5 a",
                           "loss 1 :",
                           "loss 1 a:",
                           "loss 1 :b",
                           "loss 1 a:b c",
                           "cut",
                           "cut a b",
                           "stats 1",
                           "quit please",
                           "LOSS 1",
                           "duplicate 1e9",
                           "mend"}) {
    EXPECT_THROW((void)ParseCommand(line), CommandError) << line;
  }
}

TEST(CommandTest, ARefusalSaysWhatIsKnownOrExpected) {
  EXPECT_THAT([] { (void)ParseCommand("los 1"); },
              testing::ThrowsMessage<CommandError>(
                  testing::AllOf(testing::HasSubstr("\"los\""), testing::HasSubstr("loss"))));
  EXPECT_THAT([] { (void)ParseCommand("loss 2"); },
              testing::ThrowsMessage<CommandError>(testing::HasSubstr("[0, 1], not \"2\"")));
}

}  // namespace
}  // namespace clearway::relay
