// SPDX-License-Identifier: BSD-3-Clause
#include "tools/replay/log_inputs.hpp"

#include <limits>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "common/io/read_error.hpp"
#include "tests/support/test_folder.hpp"

namespace clearway::replay {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

constexpr std::int64_t kStart = 1'700'000'000'000'000;

struct Event {
  std::int64_t utime;
  std::string channel = "LIDAR_POINTS";
};

struct ReadBack {
  std::vector<std::int64_t> times_us;  // After kStart.
  std::vector<std::string> channels;
  std::vector<int> numbers;  // Of the events, in the log's order.
  InputCounts counts;
  std::string channels_seen;
  double share_read = 0.0;
};

class LogInputsTest : public testing::Test {
 protected:
  ReadBack Read(const std::vector<Event>& events,
                const std::string& prefix = "",
                bool with_pose = true) {
    const auto file = folder_.path() / "inputs.log";
    {
      io::LcmLogWriter log(file);
      std::byte number{0};
      for (const Event& event : events) {
        log.Write(event.utime, event.channel, std::vector<std::byte>{number});
        number = static_cast<std::byte>(static_cast<int>(number) + 1);
      }
    }
    LogInputs inputs({.log = file, .channel_prefix = prefix, .with_pose = with_pose});
    ReadBack read;
    while (const auto input = inputs.Next()) {
      read.times_us.push_back(input->utime - kStart);
      read.channels.push_back(input->channel);
      read.numbers.push_back(static_cast<int>(input->bytes.at(0)));
    }
    read.counts = inputs.counts();
    read.channels_seen = inputs.ChannelsSeen();
    read.share_read = inputs.ShareRead();
    return read;
  }

 private:
  test::TestFolder folder_;
};

TEST_F(LogInputsTest, AreTheFourInputChannelsInTheOrderOfTheLog) {
  const ReadBack read = Read({{kStart, "ODOMETRY"},
                              {kStart + 1, "DETECTIONS"},
                              {kStart + 1, "LIDAR_POINTS"},
                              {kStart + 1, "POSE"},
                              {kStart + 2, "LIDAR_POINTS_RAW"},
                              {kStart + 3, "POSE_STATUS"}});

  EXPECT_THAT(read.channels, ElementsAre("ODOMETRY", "LIDAR_POINTS", "POSE", "POSE_STATUS"));
  EXPECT_THAT(read.numbers, ElementsAre(0, 2, 3, 5));
  EXPECT_THAT(read.times_us, ElementsAre(0, 1, 1, 3));
  EXPECT_EQ(read.counts.not_inputs, 2U);
  EXPECT_EQ(read.counts.fed.at("LIDAR_POINTS"), 1U);
  EXPECT_EQ(read.share_read, 1.0);
}

TEST_F(LogInputsTest, AreThoseOfThePrefixOnly) {
  const ReadBack read = Read({{kStart, "A_LIDAR_POINTS"}, {kStart, "LIDAR_POINTS"}}, "A_");

  EXPECT_THAT(read.channels, ElementsAre("LIDAR_POINTS"));
  EXPECT_THAT(read.numbers, ElementsAre(0));
  EXPECT_EQ(read.channels_seen, R"("A_LIDAR_POINTS", "LIDAR_POINTS")");
}

TEST_F(LogInputsTest, LeavePoseOutWhenTheGraphHasASourceOfItsOwn) {
  const ReadBack read =
      Read({{kStart, "POSE"}, {kStart, "LIDAR_POINTS"}, {kStart, "POSE_STATUS"}}, "", false);

  EXPECT_THAT(read.channels, ElementsAre("LIDAR_POINTS"));
  EXPECT_EQ(read.counts.left_out, 2U);
}

TEST_F(LogInputsTest, AStampThatGoesBackIsFedAtTheTimeOfTheOneBefore) {
  const ReadBack read =
      Read({{kStart + 100}, {kStart + 40}, {kStart + 70}, {kStart + 100}, {kStart + 101}});

  EXPECT_THAT(read.times_us, ElementsAre(100, 100, 100, 100, 101));
  EXPECT_EQ(read.counts.stepped_back, 2U);
  EXPECT_EQ(read.counts.largest_step_back_us, 60);
  EXPECT_EQ(read.counts.refused, 0U);
}

TEST_F(LogInputsTest, AStampFartherThanAnHourIsRefusedAndTheRestGoesOn) {
  constexpr std::int64_t kGap = LogInputs::kLargestGapUs;
  const ReadBack read = Read({{kStart},
                              {kStart + kGap + 1},
                              {kStart + 10},
                              {kStart + 10 - kGap - 1},
                              {kStart + 10 + kGap}});

  EXPECT_THAT(read.numbers, ElementsAre(0, 2, 4));
  EXPECT_EQ(read.counts.refused, 2U);
  EXPECT_EQ(read.counts.first_refused,
            "LIDAR_POINTS at " + std::to_string(kStart + kGap + 1) +
                " us, 3600 s after the input before");
}

TEST_F(LogInputsTest, AStampThatIsNoTimeIsRefusedAlsoAsTheFirst) {
  constexpr std::int64_t kMost = std::numeric_limits<std::int64_t>::max();
  constexpr std::int64_t kLeast = std::numeric_limits<std::int64_t>::min();

  const ReadBack read = Read({{0}, {-5}, {kMost}, {kLeast}, {kStart}, {kLeast}, {kStart + 1}});

  EXPECT_THAT(read.numbers, ElementsAre(4, 6));
  EXPECT_EQ(read.counts.refused, 5U);
  EXPECT_EQ(read.counts.first_refused, "LIDAR_POINTS at 0 us");
}

TEST_F(LogInputsTest, StampsOfOtherChannelsDoNotMatter) {
  const ReadBack read = Read({{kStart}, {0, "DETECTIONS"}, {kStart + 1}});

  EXPECT_THAT(read.times_us, ElementsAre(0, 1));
  EXPECT_EQ(read.counts.refused, 0U);
}

TEST_F(LogInputsTest, NameAFewOfManyChannelsAndMakeThemPrintable) {
  std::vector<Event> events{{kStart, "A\nB"}};
  for (int i = 0; i < 30; ++i) events.push_back({kStart, "CHANNEL_" + std::to_string(i)});

  const ReadBack read = Read(events);

  EXPECT_THAT(read.channels_seen, HasSubstr("A\\x0aB"));
  EXPECT_THAT(read.channels_seen, HasSubstr("CHANNEL_18\""));
  EXPECT_THAT(read.channels_seen, HasSubstr(", ..."));
}

TEST(LogInputsFileTest, AMissingFileIsAnError) {
  EXPECT_THROW(LogInputs({.log = "no/such.log", .channel_prefix = ""}), io::ReadError);
}

}  // namespace
}  // namespace clearway::replay
