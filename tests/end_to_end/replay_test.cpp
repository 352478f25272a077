// SPDX-License-Identifier: BSD-3-Clause
// Batch replay: the same bytes each time, and the detections of the live graph.
#include <fstream>
#include <iterator>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/support/command_line.hpp"
#include "tests/support/live_buses.hpp"
#include "tests/support/test_folder.hpp"

namespace clearway::test {
namespace {

constexpr std::size_t kScans = 20;
// A busy machine is not what is tested.
constexpr const char* kPatience = "preprocessor.assembler.grace_ms=2000";

std::string ContentOf(const std::filesystem::path& file) {
  std::ifstream stream(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), {}};
}

class ReplayProgramTest : public testing::Test {
 protected:
  std::filesystem::path WriteLog() {
    const ProgramResult result = RunProgram({Program("play"),
                                             "--config",
                                             ShippedConfig("lab_standing.xml"),
                                             "--input",
                                             ShippedConfig("lab_scene.xml"),
                                             "--scene-seconds",
                                             "2",
                                             "--to-log",
                                             Path("lab.log")},
                                            folder_.path());
    EXPECT_EQ(result.exit_status, 0) << result.err;
    return Path("lab.log");
  }

  ProgramResult Replay(const std::filesystem::path& log, const std::vector<std::string>& more) {
    return RunProgram(
        With({Program("replay"), log, "--config", ShippedConfig("lab_standing.xml")}, more),
        folder_.path(),
        120);
  }

  [[nodiscard]] nlohmann::json Figures() const {
    std::ifstream stream(Path("replay.json"));
    return nlohmann::json::parse(stream);
  }

  [[nodiscard]] std::filesystem::path Path(const std::string& name) const {
    return folder_.path() / name;
  }

  TestFolder folder_;
};

TEST_F(ReplayProgramTest, TwiceWritesTheSameBytes) {
  const auto log = WriteLog();

  const ProgramResult first = Replay(log, {"--output", Path("first.log")});
  const ProgramResult second = Replay(log,
                                      {"--output",
                                       Path("second.log"),
                                       "--compare",
                                       Path("first.log"),
                                       "--json",
                                       Path("replay.json")});

  EXPECT_EQ(first.exit_status, 0) << first.err;
  EXPECT_EQ(second.exit_status, 0) << second.err;
  EXPECT_EQ(Figures().at("scans_detected"), kScans);
  EXPECT_EQ(Figures().at("comparison").at("equal"), kScans);
  EXPECT_FALSE(ContentOf(Path("first.log")).empty());
  EXPECT_TRUE(ContentOf(Path("first.log")) == ContentOf(Path("second.log")));
}

TEST_F(ReplayProgramTest, AgreesWithTheLiveGraphOnEveryDetection) {
  if (kIsSanitized) GTEST_SKIP() << "clearway-run plays logs at their own speed only";
  const ProgramResult live = RunProgram({Program("run"),
                                         "--headless",
                                         "--config",
                                         ShippedConfig("lab_standing.xml"),
                                         "--lcm-url",
                                         TestUrl(17510),
                                         "--set",
                                         kPatience,
                                         "--output",
                                         Path("output"),
                                         "--log",
                                         Path("live.log"),
                                         "--input",
                                         WriteLog()},
                                        folder_.path(),
                                        120);
  ASSERT_EQ(live.exit_status, 0) << live.err;

  const ProgramResult result =
      Replay(Path("live.log"),
             {"--set", kPatience, "--compare", Path("live.log"), "--json", Path("replay.json")});

  EXPECT_EQ(result.exit_status, 0) << result.out << result.err;
  const auto comparison = Figures().at("comparison");
  EXPECT_EQ(comparison.at("equal"), kScans) << comparison.dump();
  EXPECT_EQ(comparison.at("incomplete"), 0);
}

TEST_F(ReplayProgramTest, ADifferenceIsToldAndEndsWithAFailure) {
  const auto log = WriteLog();
  ASSERT_EQ(Replay(log, {"--output", Path("first.log")}).exit_status, 0);

  const ProgramResult result = Replay(
      log, {"--set", "clusterer.clustering.tolerance_m=0.5", "--compare", Path("first.log")});

  EXPECT_EQ(result.exit_status, 70);
  EXPECT_THAT(result.err, testing::HasSubstr("differs from the reference: scan "));
}

TEST_F(ReplayProgramTest, NeverWritesOverWhatItReads) {
  const auto log = WriteLog();
  const std::string before = ContentOf(log);

  const ProgramResult result = Replay(log, {"--output", log});

  EXPECT_EQ(result.exit_status, 70);
  EXPECT_THAT(result.err, testing::HasSubstr("is read by this command"));
  EXPECT_TRUE(ContentOf(log) == before);
}

}  // namespace
}  // namespace clearway::test
