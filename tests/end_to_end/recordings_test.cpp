// SPDX-License-Identifier: BSD-3-Clause
// The main job on each kind of recording: every scan through every stage, nothing lost.
#include <cstddef>
#include <cstdio>
#include <fstream>
#include <ostream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/support/command_line.hpp"
#include "tests/support/live_buses.hpp"
#include "tests/support/test_folder.hpp"

namespace clearway::test {
namespace {

constexpr int kPort = 17300;
constexpr int kAttempts = 3;

struct Recording {
  std::string name;
  std::string path;  // Below the test data; empty: the generated lab.
  std::string config;
  std::size_t num_scans;
  // Off-line recordings may be played at any rate: slowly where instruments slow the programs.
  double sanitized_rate_hz = 1.0;

  friend void PrintTo(const Recording& recording, std::ostream* out) { *out << recording.name; }
};

nlohmann::json ReadJson(const std::filesystem::path& file) {
  std::ifstream stream(file);
  return nlohmann::json::parse(stream);
}

bool IsPng(const std::filesystem::path& file) {
  std::ifstream stream(file, std::ios::binary);
  std::string head(8, '\0');
  stream.read(head.data(), 8);
  return head == "\x89PNG\r\n\x1a\n" && std::filesystem::file_size(file) > 10'000;
}

class RecordingTest : public testing::TestWithParam<Recording> {
 protected:
  // The figures of a run; null when it failed.
  nlohmann::json Run(const std::vector<std::string>& arguments) {
    const auto json = folder_.path() / "run.json";
    std::vector<std::string> command = With({Program("run"),
                                             "--headless",
                                             "--config",
                                             ShippedConfig(GetParam().config),
                                             "--lcm-url",
                                             TestUrl(kPort),
                                             "--output",
                                             folder_.path() / "output",
                                             "--json",
                                             json},
                                            arguments);
    // A machine that is busy with other things keeps the player waiting for longer than the shipped
    // 50 ms now and then; this test is about what is lost, not about the machine.
    command = With(command, {"--set", "preprocessor.assembler.grace_ms=2000"});
    if (kIsSanitized) {
      command = With(command,
                     {"--set",
                      "recording.stamp=rate",
                      "--set",
                      "recording.rate_hz=" + std::to_string(GetParam().sanitized_rate_hz)});
    }
    const ProgramResult result = RunProgram(command, folder_.path(), 300);
    EXPECT_EQ(result.exit_status, 0) << result.err << result.out;
    EXPECT_THAT(result.out, testing::HasSubstr("scans with detections"));
    return result.exit_status == 0 ? ReadJson(json) : nlohmann::json();
  }

  // A machine that is busy with other things may stop a process for longer than the graph keeps old
  // scans for; that is told, and another run shows what the graph does when it is let.
  nlohmann::json RunInTime(const std::vector<std::string>& arguments) {
    nlohmann::json figures;
    for (int attempt = 1; attempt <= kAttempts; ++attempt) {
      figures = Run(arguments);
      if (!figures.is_object()) break;
      if (figures.at("scans_incomplete") == 0 && figures.at("messages_lost") == 0 &&
          figures.at("scans_detected") == figures.at("scans_played")) {
        break;
      }
      RecordProperty("late_in_attempt_" + std::to_string(attempt), figures.dump());
      std::printf("    attempt %d was late: %s\n", attempt, figures.dump().c_str());
    }
    return figures;
  }

  void ExpectNothingLost(const nlohmann::json& figures, bool is_cut) const {
    SCOPED_TRACE(figures.dump());
    const std::size_t scans_played = figures.at("scans_played");
    EXPECT_EQ(figures.at("scans_detected"), scans_played);
    EXPECT_LE(figures.at("scans_incomplete"), is_cut ? 1 : 0);
    EXPECT_EQ(figures.at("messages_lost"), 0);
    for (const char* stage : {"preprocessor", "clusterer", "stop_guard"}) {
      const auto& figures_of_stage = figures.at("stages").at(stage);
      EXPECT_GT(figures_of_stage.at("median_ms"), 0.0);
      EXPECT_GE(figures_of_stage.at("p99_ms"), figures_of_stage["median_ms"]);
      const std::size_t scans = figures_of_stage.at("scans");
      // Of the guard's work the runner sees what its permits name: several slices may share one.
      // That none of them was lost is told by its status, in messages_lost.
      EXPECT_GE(scans, stage == std::string("stop_guard") ? 1U : scans_played) << stage;
      // --for may end the input in the middle of a scan.
      EXPECT_LE(scans, scans_played + (is_cut ? 1U : 0U)) << stage;
    }
    const auto& points = figures.at("points");
    EXPECT_GT(points.at("in"), 0.0);
    EXPECT_LE(points.at("voxel"), points["in"]);
    EXPECT_LE(points.at("floor"), points["voxel"]);
    EXPECT_GT(figures.at("detections"), 0.0);
    EXPECT_GT(figures.at("latency_ms").at("scan_to_detections").at("median"), 0.0);
    EXPECT_GT(figures["latency_ms"].at("slice_to_permit").at("median"), 0.0);
    EXPECT_GT(figures.at("cpu_cores"), 0.0);
    EXPECT_GT(figures.at("pss_mb"), 0.0);
    EXPECT_TRUE(IsPng(folder_.path() / "output" / "last_scan.png"));
  }

  TestFolder folder_;
};

TEST_P(RecordingTest, EveryScanGoesThroughEveryStage) {
  const auto input = TestData(GetParam().path);
  if (!input) GTEST_SKIP() << MissingData(GetParam().path);

  const nlohmann::json figures = RunInTime({"--input", *input});

  ASSERT_TRUE(figures.is_object());
  EXPECT_EQ(figures.at("scans_played"), GetParam().num_scans);
  ExpectNothingLost(figures, false);
}

INSTANTIATE_TEST_SUITE_P(
    Recordings,
    RecordingTest,
    testing::Values(
        Recording{"IndoorPeople", "indoor_people/consecutive", "indoor_people.xml", 30, 5.0},
        Recording{"LivoxStreet", "livox/mid100_street.pcd", "livox_street.xml", 25, 5.0},
        Recording{"KittiObject", "kitti_object/velodyne_fov", "kitti.xml", 6, 2.0},
        Recording{"KittiTracking", "kitti_tracking", "kitti.xml", 8, 2.0},
        Recording{"KittiFull", "kitti_full", "kitti.xml", 2, 1.0},
        Recording{"OfficeRooms", "indoor/tier4_nebula", "office.xml", 4, 1.0}),
    [](const auto& test) { return test.param.name; });

class GeneratedLabTest : public RecordingTest {};

TEST_P(GeneratedLabTest, IsPlayedWithoutAnInputAndStopsAfterTheTimeGiven) {
  const nlohmann::json figures = RunInTime({"--for", "3"});

  ASSERT_TRUE(figures.is_object());
  EXPECT_GT(figures.at("scans_played"), 0);
  ExpectNothingLost(figures, true);
}

INSTANTIATE_TEST_SUITE_P(Scenes,
                         GeneratedLabTest,
                         testing::Values(Recording{"Lab", "", "lab_standing.xml", 0, 5.0}),
                         [](const auto& test) { return test.param.name; });

}  // namespace
}  // namespace clearway::test
