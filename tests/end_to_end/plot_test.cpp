// SPDX-License-Identifier: BSD-3-Clause
// The lab, recorded, replayed with a map and drawn.
#include <filesystem>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/command_line.hpp"
#include "tests/support/test_folder.hpp"
#include "tests/unit/plot/png_pixels.hpp"
#include "tools/plot/panels.hpp"

namespace clearway::test {
namespace {

using testing::HasSubstr;

constexpr plot::Rect kBirdsEye{56.0, 66.0, 730.0, 612.0};
constexpr plot::Rect kPerspective{812.0, 66.0, 768.0, 614.0};
constexpr int kRounding = 2;  // Of a blended channel.

// The lab's room, 8 x 6 m, as the map file that Nav2 would have of it: free, with walls around.
std::string RoomImage() {
  constexpr int kWidth = 170;
  constexpr int kHeight = 130;
  std::string image = "P5\n170 130\n255\n";
  for (int row = 0; row < kHeight; ++row) {
    for (int column = 0; column < kWidth; ++column) {
      const bool is_wall = row < 5 || row >= kHeight - 5 || column < 5 || column >= kWidth - 5;
      image += is_wall ? '\0' : '\xFE';
    }
  }
  return image;
}

class PlotProgramTest : public testing::Test {
 protected:
  ProgramResult Run(const std::vector<std::string>& command) {
    return RunProgram(command, folder_.path());
  }

  // Half a second of the lab and what the graph makes of it.
  std::filesystem::path WriteLog() {
    const std::string config = ShippedConfig("lab_standing.xml");
    const ProgramResult played = Run({Program("play"),
                                      "--config",
                                      config,
                                      "--input",
                                      ShippedConfig("lab_scene.xml"),
                                      "--scene-seconds",
                                      "0.5",
                                      "--to-log",
                                      Path("lab.log")});
    EXPECT_EQ(played.exit_status, 0) << played.err;
    folder_.Write("room.pgm", RoomImage());
    const ProgramResult replayed =
        Run({Program("replay"),
             Path("lab.log"),
             "--config",
             config,
             "--map",
             folder_.Write("room.yaml",
                           "image: room.pgm\nresolution: 0.05\norigin: [-0.25, -0.25, 0]\n"
                           "negate: 0\noccupied_thresh: 0.65\nfree_thresh: 0.196\n"),
             "--set",
             "pose_source.mode=fixed",
             "--set",
             "pose_source.x_m=0.5",
             "--set",
             "pose_source.y_m=3",
             "--set",
             "preprocessor.removed_points=true",
             "--output",
             Path("out.log"),
             "--with-inputs"});
    EXPECT_EQ(replayed.exit_status, 0) << replayed.err;
    return Path("out.log");
  }

  ProgramResult Plot(const std::string& log, const std::vector<std::string>& more) {
    return Run(With({Program("plot"), log, "--config", ShippedConfig("lab_standing.xml")}, more));
  }

  [[nodiscard]] std::string Path(const std::string& name) const { return folder_.path() / name; }

  TestFolder folder_;
};

TEST_F(PlotProgramTest, DrawsEachLayerOfAReplayedScanAndNoOther) {
  const std::string log = WriteLog();
  plot::ScanPicture all;
  all.outlier_points.resize(1);
  std::vector<std::pair<std::string, plot::Colour>> layers = {{"map", plot::kOccupiedGrey}};
  for (const char* const name : {"floor", "removed_by_map", "obstacles"}) {
    for (const plot::PointLayer& layer : plot::LayersOf(all)) {
      const bool is_it = std::string(name) == plot::kLayerNames[std::size_t(layer.layer)].first;
      if (is_it && layer.name != std::string("below the floor")) {
        layers.emplace_back(name, Over(layer.colour, plot::kPanel));
      }
    }
  }
  ASSERT_EQ(layers.size(), 4U);

  for (const auto& [shown, shown_colour] : layers) {
    const ProgramResult result =
        Plot(log, {"--output", Path("scan.png"), "--scan", "3", "--layers", shown});

    ASSERT_EQ(result.exit_status, 0) << result.err;
    EXPECT_THAT(result.out, HasSubstr("scan 3: "));
    const PngPixels pixels = ReadPng(Path("scan.png"));
    ASSERT_EQ(pixels.width, plot::kPictureWidth_px);
    ASSERT_EQ(pixels.height, plot::kPictureHeight_px);
    for (const plot::Rect& panel : {kBirdsEye, kPerspective}) {
      for (const auto& [other, colour] : layers) {
        const std::size_t count = pixels.Count(ColourCode(colour), panel, kRounding);
        if (other == shown) {
          EXPECT_GT(count, 100U) << shown << " in the panel at " << panel.x;
        } else {
          EXPECT_LT(count, 5U) << other << " where only " << shown << " is to be seen";
        }
      }
    }
  }
}

TEST_F(PlotProgramTest, DrawsEveryNthScanOfAFolder) {
  const std::string log = WriteLog();

  const ProgramResult result = Plot(log, {"--every", "2", "--output-folder", Path("pictures")});

  EXPECT_EQ(result.exit_status, 0) << result.err;
  for (const char* const name : {"scan_000000.png", "scan_000002.png", "scan_000004.png"}) {
    EXPECT_EQ(ReadPng(folder_.path() / "pictures" / name).width, plot::kPictureWidth_px) << name;
  }
}

TEST_F(PlotProgramTest, SaysWhatIsWrong) {
  const std::string log = WriteLog();
  struct Case {
    std::vector<std::string> arguments;
    int exit_status;
    const char* message;
  };
  const Case cases[] = {
      {{"--output", Path("x.png"), "--scan", "99"}, 70, "5 scans from 0 to 4"},
      {{"--output", Path("x.png"), "--time", "1000"}, 70, "no scan at 1000.00 s"},
      {{"--output", Path("x.png"), "--channel-prefix", "Q_"}, 70, "channels in it:"},
      {{"--output", log}, 70, "is read by this command"},
      {{"--output", Path("none") + "/x.png"}, 70, "cannot write the picture"},
      {{"--output", Path("x.png"), "--set", "recording.rate_hz=-1"}, 78, "rate_hz"},
      {{"--output", Path("x.png"), "--layers", "dreams"}, 64, "dreams"},
      {{"--output", Path("x.png"), "--scan", "1", "--last"}, 64, "--last"},
      {{"--every", "2"}, 64, "--output-folder"},
      {{}, 64, "--output"}};

  for (const Case& wrong : cases) {
    const ProgramResult result = Plot(log, wrong.arguments);

    EXPECT_EQ(result.exit_status, wrong.exit_status) << result.err;
    EXPECT_THAT(result.err, HasSubstr(wrong.message));
  }
  EXPECT_FALSE(std::filesystem::exists(Path("x.png")));
  EXPECT_EQ(Plot(Path("no_such.log"), {"--output", Path("x.png")}).exit_status, 70);
}

}  // namespace
}  // namespace clearway::test
