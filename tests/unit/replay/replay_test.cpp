// SPDX-License-Identifier: BSD-3-Clause
#include "tools/replay/replay.hpp"

#include <fstream>
#include <iterator>
#include <map>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "common/io/read_error.hpp"
#include "common/process/log.hpp"
#include "tests/support/simulated_graph.hpp"
#include "tests/support/test_folder.hpp"
#include "tools/replay/report.hpp"

namespace clearway::replay {
namespace {

namespace channels = messages::channels;
namespace fs = std::filesystem;

constexpr std::size_t kScans = 5;
constexpr std::int64_t kStart = 1'700'000'000'000'000;

std::string ContentOf(const fs::path& file) {
  std::ifstream stream(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), {}};
}

std::map<std::string, std::size_t> ChannelsOf(const fs::path& log) {
  std::map<std::string, std::size_t> counts;
  io::LcmLogReader reader(log);
  while (const auto event = reader.Next()) ++counts[event->channel];
  return counts;
}

class ReplayTest : public testing::Test {
 protected:
  ReplayTest() { process::SetUpLog("test", "off"); }

  // What clearway-play --to-log writes of a free room.
  fs::path WriteLog(const std::string& prefix = "") {
    const fs::path file = folder_.path() / (prefix + "room.log");
    const auto source = test::FreeRoom(0.5);
    io::LcmLogWriter log(file);
    process::SimulatedRuntime runtime(kStart, {});
    runtime.SetTap([&](messages::BusId, const std::string& channel, auto bytes) {
      log.Write(runtime.UtimeNow(), prefix + channel, bytes);
    });
    process::Node node(runtime, {"play", "test", "digest"}, channels::kPlayStatus);
    bool done = false;
    const play::Player player(node, *source, {.sensor = "front"}, [&done] { done = true; });
    while (!done) runtime.RunUntil(runtime.MonotonicUs() + source->period_us());
    return file;
  }

  ReplayResult ReplayTo(const std::string& output, ReplaySettings settings) {
    settings.output = Path(output);
    settings.version = "test";
    return Replay(test::LabConfig(), settings);
  }

  // A map of 40 m x 40 m whose cells are all occupied, and a fixed pose in it.
  [[nodiscard]] graph::GraphConfig ConfigWithMap() const {
    folder_.Write("map.pgm", "P5 400 400 255\n" + std::string(400 * 400, '\0'));
    graph::GraphConfig config = test::LabConfig();
    config.folder = folder_.path();
    config.map_server.file =
        folder_.Write("map.yaml",
                      "image: map.pgm\nresolution: 0.1\norigin: [-20, -20, 0]\nnegate: 0\n"
                      "occupied_thresh: 0.65\nfree_thresh: 0.2\n");
    config.preprocessor.map_filter.enabled = true;
    config.pose_source.mode = core::PoseSourceMode::kFixed;
    return config;
  }

  [[nodiscard]] fs::path Path(const std::string& name) const { return folder_.path() / name; }

 private:
  test::TestFolder folder_;
};

TEST_F(ReplayTest, EveryScanGoesThroughTheGraph) {
  const ReplayResult result = ReplayTo("out.log", {.log = WriteLog()});

  EXPECT_EQ(result.summary.scans_played, kScans);
  EXPECT_EQ(result.summary.scans_detected, kScans);
  EXPECT_EQ(result.summary.scans_incomplete, 0U);
  EXPECT_EQ(result.summary.messages_lost, 0);
  EXPECT_EQ(result.dropped, 0);
  EXPECT_EQ(result.detections.Scans().size(), kScans);
  EXPECT_NEAR(result.recorded_s, 0.49, 1e-9);  // From the end of the first slice to the last's.
}

TEST_F(ReplayTest, TwiceWritesTheSameBytes) {
  const fs::path log = WriteLog();

  ReplayTo("first.log", {.log = log, .with_inputs = true});
  ReplayTo("second.log", {.log = log, .with_inputs = true});

  EXPECT_FALSE(ContentOf(Path("first.log")).empty());
  EXPECT_TRUE(ContentOf(Path("first.log")) == ContentOf(Path("second.log")));
}

TEST_F(ReplayTest, WritesWhatTheProcessesPublishAndTheInputsWhenAsked) {
  const fs::path log = WriteLog();

  ReplayTo("out.log", {.log = log});
  ReplayTo("all.log", {.log = log, .with_inputs = true});

  auto published = ChannelsOf(Path("out.log"));
  const auto all = ChannelsOf(Path("all.log"));
  for (const char* const channel : {"OBSTACLE_POINTS",
                                    "FLOOR",
                                    "DETECTIONS",
                                    "DRIVE_PERMIT",
                                    "PREPROCESSOR_STATUS",
                                    "CLUSTERER_STATUS",
                                    "STOP_GUARD_STATUS"}) {
    EXPECT_GT(published[channel], 0U) << channel;
  }
  EXPECT_FALSE(published.contains("LIDAR_POINTS"));
  EXPECT_FALSE(published.contains("PLAY_STATUS"));
  published["LIDAR_POINTS"] = ChannelsOf(log).at("LIDAR_POINTS");
  EXPECT_EQ(all, published);
}

TEST_F(ReplayTest, ThePrefixIsThatOfTheLogAndOfTheOutput) {
  const ReplayResult plain = ReplayTo("plain.log", {.log = WriteLog()});
  const ReplayResult prefixed =
      ReplayTo("prefixed.log", {.log = WriteLog("A_"), .channel_prefix = "A_"});

  EXPECT_TRUE(Compare(prefixed.detections, plain.detections).agrees());
  for (const auto& [channel, count] : ChannelsOf(Path("prefixed.log"))) {
    EXPECT_TRUE(channel.starts_with("A_")) << channel;
  }
}

TEST_F(ReplayTest, AnOutputWithInputsCanBeReplayedAgain) {
  const ReplayResult first = ReplayTo("first.log", {.log = WriteLog(), .with_inputs = true});

  const ReplayResult again = ReplayTo("again.log", {.log = Path("first.log")});

  EXPECT_TRUE(Compare(again.detections, ReadDetections(Path("first.log"), "")).agrees());
  EXPECT_TRUE(Compare(again.detections, first.detections).agrees());
}

TEST_F(ReplayTest, AnotherConfigurationDoesNotAgree) {
  const fs::path log = WriteLog();
  const ReplayResult shipped = ReplayTo("shipped.log", {.log = log});
  graph::GraphConfig config = test::LabConfig();
  config.clusterer.clustering.min_points = 40;

  const ReplayResult changed = Replay(config, {.log = log});

  const Comparison comparison = Compare(changed.detections, shipped.detections);
  EXPECT_FALSE(comparison.agrees());
  EXPECT_NE(comparison.first_difference, "");
}

TEST_F(ReplayTest, WithAMapEveryScanIsFilteredFromTheFirstOn) {
  const fs::path log = WriteLog();

  const ReplayResult result = Replay(ConfigWithMap(), {.log = log, .output = Path("first.log")});
  const ReplayResult again = Replay(ConfigWithMap(), {.log = log, .output = Path("second.log")});

  const auto scans = result.detections.Scans();
  EXPECT_EQ(scans.size(), kScans);
  for (const auto& [scan_utime, scan] : scans) {
    EXPECT_EQ(scan.whole.map_state, obstacle_points_t::MAP_FILTERED) << scan_utime;
  }
  EXPECT_LT(result.summary.points_map.value(), 0.5 * result.summary.points_floor.value());
  EXPECT_TRUE(Compare(again.detections, result.detections).agrees());
  EXPECT_TRUE(ContentOf(Path("first.log")) == ContentOf(Path("second.log")));
}

TEST_F(ReplayTest, MessagesAreStampedByVirtualTimeThatNeverGoesBack) {
  const fs::path log = WriteLog();
  ReplayTo("out.log", {.log = log});

  const std::int64_t first_input = LogInputs({.log = log, .channel_prefix = ""}).Next()->utime;
  io::LcmLogReader reader(Path("out.log"));
  std::int64_t last_utime = first_input - kSettleUs;
  while (const auto event = reader.Next()) {
    EXPECT_GE(event->utime, last_utime);
    last_utime = event->utime;
  }
  EXPECT_EQ(last_utime, first_input + 490'000 + kDrainUs);
}

TEST_F(ReplayTest, ALogWithoutInputsIsAnErrorThatNamesItsChannels) {
  const fs::path file = Path("none.log");
  io::LcmLogWriter(file).Write(kStart, "SOMETHING", {});

  try {
    ReplayTo("out.log", {.log = file});
    FAIL() << "no error";
  } catch (const io::ReadError& error) {
    EXPECT_THAT(error.what(), testing::HasSubstr("channels in this log: \"SOMETHING\""));
  }
}

TEST_F(ReplayTest, TheReportTellsWhatWasMeasuredAndNothingElse) {
  const ReplayResult result = ReplayTo("out.log", {.log = WriteLog()});
  const Report report{
      .result = result, .wall_s = 0.1, .comparison = Compare(result.detections, result.detections)};

  const auto json = nlohmann::json::parse(FormatJson(report));

  EXPECT_EQ(json.at("scans_played"), kScans);
  EXPECT_EQ(json.at("comparison").at("equal"), kScans);
  EXPECT_NEAR(json.at("speed"), 4.9, 1e-9);
  EXPECT_GT(json.at("points").at("voxel"), 0.0);
  EXPECT_FALSE(json.contains("latency_ms"));
  EXPECT_FALSE(json.at("stages").at("clusterer").contains("median_ms"));
  EXPECT_EQ(Problems(report), "");
}

TEST_F(ReplayTest, AReportWithoutScansOrAgreementTellsTheProblem) {
  ReplayResult result;
  result.channels = "\"ODOMETRY\"";
  result.inputs.refused = 3;
  result.inputs.first_refused = "LIDAR_POINTS at 0 us";

  const std::string problems =
      Problems({.result = result, .wall_s = 0.0, .comparison = Comparison{}});

  EXPECT_THAT(problems, testing::HasSubstr("no LIDAR_POINTS"));
  EXPECT_THAT(problems, testing::HasSubstr("\"ODOMETRY\""));
  EXPECT_THAT(problems, testing::HasSubstr("refused 3 inputs"));
  EXPECT_THAT(problems, testing::HasSubstr("nothing could be compared"));
}

}  // namespace
}  // namespace clearway::replay
