// SPDX-License-Identifier: BSD-3-Clause
// Recordings as LCM logs: written at once, played into the graph by LCM's own player.
#include <algorithm>
#include <fstream>
#include <iterator>
#include <map>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "common/io/lcm_log.hpp"
#include "common/messages/encoding.hpp"
#include "tests/support/command_line.hpp"
#include "tests/support/graph_listener.hpp"
#include "tests/support/live_buses.hpp"
#include "tests/support/test_folder.hpp"

namespace clearway::test {
namespace {

namespace channels = messages::channels;

constexpr std::size_t kScans = 15;
constexpr const char* kGraph[] = {"preprocessor", "clusterer", "stop_guard"};
constexpr const char* kSpeed = kIsSanitized ? "0.3" : "1";

class LogTest : public testing::Test {
 protected:
  std::filesystem::path WriteLog() {
    const auto log = folder_.path() / "free_room.log";
    const ProgramResult result =
        RunProgram({Program("play"),
                    "--config",
                    ShippedConfig("lab_standing.xml"),
                    "--input",
                    SourceFolder() / "tests" / "support" / "free_room_scene.xml",
                    "--scene-seconds",
                    "1.5",
                    "--to-log",
                    log},
                   folder_.path());
    EXPECT_EQ(result.exit_status, 0) << result.err;
    return log;
  }

  std::vector<std::string> RunCommand(const std::string& url, const std::string& input) {
    return {Program("run"),
            "--headless",
            "--config",
            ShippedConfig("lab_standing.xml"),
            "--lcm-url",
            url,
            "--set",  // As in the test of the recordings: a busy machine is not what is tested.
            "preprocessor.assembler.grace_ms=2000",
            "--output",
            folder_.path() / "output",
            "--json",
            Json(),
            "--input",
            input};
  }
  [[nodiscard]] std::filesystem::path Json() const { return folder_.path() / "run.json"; }

  void ExpectEveryScan() const {
    std::ifstream stream(Json());
    const auto figures = nlohmann::json::parse(stream);
    SCOPED_TRACE(figures.dump());
    EXPECT_EQ(figures.at("scans_played"), kScans);
    EXPECT_EQ(figures.at("scans_detected"), kScans);
    EXPECT_EQ(figures.at("scans_incomplete"), 0);
    EXPECT_EQ(figures.at("messages_lost"), 0);
  }

  TestFolder folder_;
};

TEST_F(LogTest, HoldsEverySliceInOrderStampedByTheTimeOfItsEnd) {
  io::LcmLogReader reader(WriteLog());
  std::map<std::int64_t, std::int32_t> slices;  // By scan.
  std::int64_t last_utime = 0;
  std::int64_t next_sequence = 0;

  while (const auto event = reader.Next()) {
    EXPECT_GE(event->utime, last_utime);
    last_utime = event->utime;
    if (event->channel != channels::kLidarPoints.name) continue;
    const auto slice = messages::Decode<lidar_points_t>(event->bytes);
    ASSERT_TRUE(slice.has_value());
    EXPECT_EQ(slice->sequence, next_sequence++);
    EXPECT_EQ(slice->slice_index, slices[slice->scan_id]++);
    const std::int64_t period_us = slice->scan_end_utime - slice->scan_utime;
    EXPECT_EQ(event->utime,
              slice->scan_utime + period_us * (slice->slice_index + 1) / slice->slice_count);
  }

  EXPECT_EQ(slices.size(), kScans);
}

TEST_F(LogTest, WrittenTwiceHoldsTheSamePoints) {
  const auto points = [](const std::filesystem::path& file) {
    io::LcmLogReader reader(file);
    std::vector<std::vector<std::byte>> messages;
    while (auto event = reader.Next()) {
      if (event->channel == channels::kLidarPoints.name) messages.push_back(event->bytes);
    }
    return messages;
  };

  const auto first = points(WriteLog());
  const auto second = points(WriteLog());

  EXPECT_FALSE(first.empty());
  EXPECT_TRUE(first == second);
}

TEST_F(LogTest, AsAnInputGivesEveryScan) {
  if (kIsSanitized) GTEST_SKIP() << "clearway-run plays logs at their own speed only";
  const auto log = WriteLog();

  const ProgramResult result = RunProgram(RunCommand(TestUrl(17500), log), folder_.path(), 120);

  ASSERT_EQ(result.exit_status, 0) << result.err;
  ExpectEveryScan();
}

TEST_F(LogTest, PlayedIntoAGraphThatListensGivesEveryScan) {
  const auto log = WriteLog();
  const std::string url = TestUrl(17501);
  GraphListener listener(url);
  host::ChildProcess run("run", RunCommand(url, "live"), folder_.path() / "run.log");
  ASSERT_TRUE(listener.Await([&] {
    return std::all_of(std::begin(kGraph), std::end(kGraph), [&](const char* process) {
      const auto status = listener.statuses.find(process);
      return status != listener.statuses.end() && status->second.message.ready != 0;
    });
  })) << run.LastWords();

  host::ChildProcess player(
      "lcm-logplayer",
      {"lcm-logplayer", "-l", url + "?ttl=0", "-s", kSpeed, "-e", "LIDAR_POINTS", log},
      folder_.path() / "logplayer.log");

  EXPECT_EQ(player.WaitOrKill(60'000), 0) << player.LastWords();
  ASSERT_EQ(run.WaitOrKill(60'000), 0) << run.LastWords();
  ExpectEveryScan();
}

}  // namespace
}  // namespace clearway::test
