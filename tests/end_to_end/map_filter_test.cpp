// SPDX-License-Identifier: BSD-3-Clause
// From a recording to a map, and back to the recording filtered with it: a real room, and the lab
// in a running graph.
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/support/command_line.hpp"
#include "tests/support/live_buses.hpp"
#include "tests/support/test_folder.hpp"

namespace clearway::test {
namespace {

constexpr char kRoom[] = "indoor_people/consecutive";

class MapFilterTest : public testing::Test {
 protected:
  ProgramResult Run(const std::vector<std::string>& command) {
    const ProgramResult result = RunProgram(command, folder_.path(), 300);
    EXPECT_EQ(result.exit_status, 0) << command.front() << ": " << result.err;
    return result;
  }

  [[nodiscard]] std::string Path(const std::string& name) const { return folder_.path() / name; }

  [[nodiscard]] nlohmann::json Figures(const std::string& name) const {
    std::ifstream stream(Path(name));
    return nlohmann::json::parse(stream);
  }

  TestFolder folder_;
};

class RoomTest : public MapFilterTest {
 protected:
  void SetUp() override {
    if (!TestData(kRoom)) GTEST_SKIP() << MissingData(kRoom);
    recording_ = *TestData(kRoom);
    Run({Program("play"), "--config", config_, "--input", recording_, "--to-log", Path("in.log")});
    Run({Program("replay"), Path("in.log"), "--config", config_, "--output", Path("seen.log")});
    Run({Program("map"), "build", Path("seen.log"), "--output", Path("room.yaml")});
  }

  // What clearway-evaluate says of the map filter at a pose that is off.
  nlohmann::json FilterWithPose(const std::string& setting) {
    Run({Program("replay"),
         Path("in.log"),
         "--config",
         config_,
         "--map",
         Path("room.yaml"),
         "--set",
         setting,
         "--set",
         "preprocessor.removed_points=true",
         "--output",
         Path("filtered.log")});
    Run({Program("evaluate"),
         "--config",
         config_,
         "--log",
         Path("filtered.log"),
         "--labels",
         recording_ + "/boxes.json",
         "--input",
         recording_,
         "--json",
         Path("figures.json")});
    return Figures("figures.json").at("map_filter").at(0);
  }

  std::string config_ = ShippedConfig("indoor_people.xml");
  std::string recording_;
};

TEST_F(RoomTest, ItsMapTakesOutTheRoomAndLeavesThePerson) {
  const nlohmann::json figures = FilterWithPose("pose_source.x_m=0");

  EXPECT_GT(figures.at("removal"), 0.95);
  EXPECT_LT(figures.at("swallow"), 0.01);
  EXPECT_EQ(figures.at("found"), 30);
  EXPECT_LT(figures.at("detections_per_scan"), 20.0);
}

TEST_F(RoomTest, APoseThatIsOffByTenCentimetresStillFindsThePersonAndLittleElse) {
  for (const char* setting : {"pose_source.x_m=0.1", "pose_source.y_m=-0.1"}) {
    const nlohmann::json figures = FilterWithPose(setting);

    EXPECT_GT(figures.at("removal"), 0.93) << setting;
    EXPECT_LT(figures.at("swallow"), 0.01) << setting;
    EXPECT_EQ(figures.at("found"), 30) << setting;
  }
}

TEST_F(MapFilterTest, TheRunnerServesAMapThatWasBuiltFromItsOwnLog) {
  const std::vector<std::string> run{Program("run"),
                                     "--headless",
                                     "--config",
                                     ShippedConfig("lab_standing.xml"),
                                     "--lcm-url",
                                     TestUrl(17'800),
                                     "--output",
                                     Path("output"),
                                     "--set",
                                     "pose_source.mode=fixed",
                                     "--for",
                                     "2"};

  Run(With(run, {"--log", Path("run.log")}));
  Run({Program("map"), "build", Path("run.log"), "--output", Path("lab.yaml")});
  Run(With(run, {"--map", Path("lab.yaml"), "--json", Path("run.json")}));

  const nlohmann::json figures = Figures("run.json");
  EXPECT_EQ(figures.at("messages_lost"), 0);
  EXPECT_LT(figures.at("points").at("map"), 0.5 * figures.at("points").at("floor").get<double>());
}

TEST_F(MapFilterTest, NoToolWritesOverWhatItReads) {
  Run({Program("play"),
       "--config",
       ShippedConfig("lab_standing.xml"),
       "--input",
       ShippedConfig("lab_scene.xml"),
       "--scene-seconds",
       "1",
       "--to-log",
       Path("lab.log")});
  const auto size = std::filesystem::file_size(Path("lab.log"));
  std::filesystem::copy(ShippedConfig("lab_scene.xml"), Path("scene.xml"));
  std::filesystem::create_symlink(Path("lab.log"), Path("lab.yaml"));
  const std::vector<std::vector<std::string>> commands = {
      {Program("run"),
       "--headless",
       "--config",
       ShippedConfig("lab_standing.xml"),
       "--input",
       Path("lab.log"),
       "--log",
       Path("lab.log"),
       "--output",
       Path("output")},
      {Program("map"), "build", Path("lab.log"), "--output", Path("lab.yaml")},
      {Program("play"),
       "--config",
       ShippedConfig("lab_standing.xml"),
       "--input",
       Path("scene.xml"),
       "--to-log",
       Path("scene.xml")},
  };

  for (const std::vector<std::string>& command : commands) {
    const ProgramResult result = RunProgram(command, folder_.path());
    EXPECT_EQ(result.exit_status, 70) << command.front();
    EXPECT_THAT(result.err, testing::HasSubstr("is read by this command"));
  }
  EXPECT_EQ(std::filesystem::file_size(Path("lab.log")), size);
  EXPECT_EQ(std::filesystem::file_size(Path("scene.xml")),
            std::filesystem::file_size(ShippedConfig("lab_scene.xml")));
}

}  // namespace
}  // namespace clearway::test
