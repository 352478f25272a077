// SPDX-License-Identifier: BSD-3-Clause
#include "tools/plot/scan_picture.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <limits>
#include <memory>
#include <set>
#include <stdexcept>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/unit/plot/png_pixels.hpp"
#include "tools/plot/palette.hpp"

// The leak sanitizer asks for this: fontconfig keeps what it read about the fonts.
extern "C" const char* __lsan_default_suppressions();  // NOLINT(bugprone-reserved-identifier)
extern "C" const char* __lsan_default_suppressions() {
  return "leak:libfontconfig";
}

namespace clearway::plot {
namespace {

using testing::AllOf;
using testing::HasSubstr;

// A folder of the test's own, gone afterwards.
class ScanPictureTest : public testing::Test {
 protected:
  ScanPictureTest()
      : folder_(std::filesystem::path(testing::TempDir()) /
                ("clearway_plot_" +
                 std::string(testing::UnitTest::GetInstance()->current_test_info()->name()))) {
    std::filesystem::create_directories(folder_);
  }
  ~ScanPictureTest() override { std::filesystem::remove_all(folder_); }

  std::filesystem::path File(const std::string& name) const { return folder_ / name; }

 private:
  std::filesystem::path folder_;
};

struct Image {
  int width = 0;
  int height = 0;
  std::set<std::uint32_t> colours_left = {};   // Of the bird's eye panel.
  std::set<std::uint32_t> colours_right = {};  // Of the perspective panel.
};

Image Read(const std::filesystem::path& path) {
  const test::PngPixels pixels = test::ReadPng(path);
  Image image{.width = pixels.width, .height = pixels.height};
  for (int y = 70; y < std::min(680, pixels.height); ++y) {
    for (int x = 60; x < image.width - 30; ++x) {
      if (x < 780) image.colours_left.insert(pixels.At(x, y));
      if (x > 820) image.colours_right.insert(pixels.At(x, y));
    }
  }
  return image;
}

std::string Bytes(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

// A wall ahead, a floor, a box, a stop corridor.
ScanPicture SmallScene() {
  ScanPicture picture;
  picture.title = "small scene";
  for (int i = 0; i < 2000; ++i) {
    const float across = 0.002F * static_cast<float>(i) - 2.0F;
    const Eigen::Vector3f wall(5.0F, across, 0.001F * static_cast<float>(i % 50));
    picture.raw_points.push_back(wall);
    picture.obstacle_points.push_back(wall);
    picture.floor_points.emplace_back(0.002F * static_cast<float>(i), across, 0.0F);
  }
  picture.below_floor_points = {{2.0F, 1.0F, -0.3F}};
  picture.map_points = {{1.0F, 1.5F, 0.4F}};
  picture.outlier_points = {{1.5F, -1.5F, 0.4F}};
  picture.detections = {{.hull = {{2.9F, -0.1F}, {3.1F, -0.1F}, {3.0F, 0.1F}},
                         .center = {3.0F, 0.0F},
                         .length_m = 0.2F,
                         .width_m = 0.2F,
                         .centroid = {3.0F, 0.0F, 0.2F},
                         .z_max_m = 0.4F,
                         .label = "box"}};
  picture.corridors = {{.polygon = {{0.3F, -0.4F}, {2.8F, -0.4F}, {2.8F, 0.4F}, {0.3F, 0.4F}},
                        .state = CorridorState::kStop,
                        .label = "STOP"}};
  picture.footprint = {{-0.3F, -0.3F}, {0.3F, -0.3F}, {0.3F, 0.3F}, {-0.3F, 0.3F}};
  picture.truth_boxes = {{.center = {3.0F, 0.0F, 0.2F},
                          .length_m = 0.25F,
                          .width_m = 0.25F,
                          .height_m = 0.4F,
                          .label = "crate"}};
  picture.text_lines = {"scan 1", "permit: 0 m/s"};
  return picture;
}

// With a map of two cells. Drawing one takes its time under sanitizers.
ScanPicture SmallSceneOnMap() {
  ScanPicture picture = SmallScene();
  auto grid = std::make_shared<core::OccupancyGrid>();
  grid->geometry = {.width = 2, .height = 1, .resolution_m = 0.5, .origin_x_m = 1.0};
  grid->cells = {core::OccupancyGrid::kOccupied, core::OccupancyGrid::kFree};
  picture.map = PictureMap{.grid = grid};
  return picture;
}

TEST_F(ScanPictureTest, IsAPngOfTheStatedSizeWithSomethingInBothPanels) {
  WritePng(SmallScene(), File("scene.png"));

  const Image image = Read(File("scene.png"));
  EXPECT_EQ(image.width, kPictureWidth_px);
  EXPECT_EQ(image.height, kPictureHeight_px);
  EXPECT_GT(image.colours_left.size(), 20U);
  EXPECT_GT(image.colours_right.size(), 20U);
}

TEST_F(ScanPictureTest, HasTheSameBytesForTheSamePicture) {
  WritePng(SmallScene(), File("first.png"));
  WritePng(SmallScene(), File("second.png"));

  EXPECT_EQ(Bytes(File("first.png")), Bytes(File("second.png")));
}

TEST_F(ScanPictureTest, ShowsEveryPartOfThePicture) {
  WritePng(SmallScene(), File("all.png"));
  const std::string all = Bytes(File("all.png"));

  int part = 0;
  const auto expect_difference = [&](auto remove) {
    ScanPicture without = SmallScene();
    remove(without);
    WritePng(without, File("without.png"));
    EXPECT_NE(Bytes(File("without.png")), all) << "part " << part;
    ++part;
  };
  expect_difference([](ScanPicture& p) { p.title.clear(); });
  expect_difference([](ScanPicture& p) { p.raw_points.pop_back(); });
  expect_difference([](ScanPicture& p) { p.floor_points.pop_back(); });
  expect_difference([](ScanPicture& p) { p.obstacle_points.clear(); });
  expect_difference([](ScanPicture& p) { p.below_floor_points.clear(); });
  expect_difference([](ScanPicture& p) { p.map_points.clear(); });
  expect_difference([](ScanPicture& p) { p.outlier_points.clear(); });
  expect_difference([](ScanPicture& p) { p.detections.clear(); });
  expect_difference([](ScanPicture& p) { p.detections[0].label.clear(); });
  expect_difference([](ScanPicture& p) { p.detections[0].z_max_m = 0.8F; });
  expect_difference([](ScanPicture& p) { p.corridors[0].state = CorridorState::kFree; });
  expect_difference([](ScanPicture& p) { p.corridors[0].state = CorridorState::kLimited; });
  expect_difference([](ScanPicture& p) { p.footprint.clear(); });
  expect_difference([](ScanPicture& p) { p.sensor_origin.x() = 0.5F; });
  expect_difference([](ScanPicture& p) { p.truth_boxes.clear(); });
  expect_difference([](ScanPicture& p) { p.text_lines.pop_back(); });
}

TEST_F(ScanPictureTest, ShowsTheMapWhereThePoseSays) {
  ScanPicture picture = SmallSceneOnMap();
  WritePng(picture, File("here.png"));
  picture.map->T_map_vehicle.translation().x() = 1.0;
  WritePng(picture, File("there.png"));

  EXPECT_TRUE(Read(File("here.png")).colours_left.contains(test::ColourCode(kOccupiedGrey)));
  EXPECT_NE(Bytes(File("here.png")), Bytes(File("there.png")));
}

TEST_F(ScanPictureTest, LeavesOutTheLayersThatAreHiddenAndNothingElse) {
  // A colour in the bird's eye panel that only this layer has.
  struct Case {
    Layer layer;
    Colour colour;
  };
  constexpr Case kCases[] = {
      {Layer::kMap, kOccupiedGrey}, {Layer::kOutliers, kBrown}, {Layer::kObstacles, kOrange}};
  for (const Case& hidden : kCases) {
    ScanPicture picture = SmallSceneOnMap();
    picture.hidden = {hidden.layer};

    WritePng(picture, File("hidden.png"));

    const Image image = Read(File("hidden.png"));
    for (const Case& other : kCases) {
      EXPECT_EQ(image.colours_left.contains(test::ColourCode(other.colour)),
                other.layer != hidden.layer)
          << static_cast<int>(hidden.layer) << " " << static_cast<int>(other.layer);
    }
  }
}

TEST_F(ScanPictureTest, WithAllLayersHiddenHasNoneOfThem) {
  ScanPicture hidden = SmallSceneOnMap();
  for (const auto& [name, layer] : kLayerNames) hidden.hidden.Add(layer);
  ScanPicture poor;  // What is left: the vehicle, and the view that the points chose.
  poor.title = hidden.title;
  poor.raw_points = hidden.raw_points;
  poor.footprint = hidden.footprint;
  poor.text_lines = hidden.text_lines;
  poor.hidden = hidden.hidden;

  WritePng(hidden, File("hidden.png"));
  WritePng(poor, File("poor.png"));

  EXPECT_EQ(Bytes(File("hidden.png")), Bytes(File("poor.png")));
}

TEST_F(ScanPictureTest, SaysOfALayerThatItIsMissingInPlaceOfACount) {
  ScanPicture picture;
  WritePng(picture, File("none.png"));
  const std::string none = Bytes(File("none.png"));

  for (const Layer layer : {Layer::kRaw, Layer::kObstacles, Layer::kDetections, Layer::kMap}) {
    picture.missing = {layer};
    WritePng(picture, File("missing.png"));
    EXPECT_NE(Bytes(File("missing.png")), none) << static_cast<int>(layer);
  }
}

TEST_F(ScanPictureTest, OfNothingIsStillAPicture) {
  WritePng(ScanPicture{}, File("empty.png"));

  EXPECT_EQ(Read(File("empty.png")).width, kPictureWidth_px);
}

TEST_F(ScanPictureTest, BearsValuesThatAreNotFiniteOrHuge) {
  constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
  constexpr float kInfinity = std::numeric_limits<float>::infinity();
  constexpr float kHuge = std::numeric_limits<float>::max();
  ScanPicture picture = SmallScene();
  for (const float bad : {kNan, kInfinity, -kInfinity, kHuge, -kHuge}) {
    picture.raw_points.emplace_back(bad, 0.0F, 0.0F);
    picture.floor_points.emplace_back(0.0F, bad, 0.0F);
    picture.obstacle_points.emplace_back(0.0F, 0.0F, bad);
    picture.footprint.emplace_back(bad, 1.0F);
    picture.corridors.push_back(
        {.polygon = {{0.0F, 0.0F}, {1.0F, bad}, {bad, 1.0F}}, .label = "x"});
    PictureDetection detection = picture.detections[0];
    detection.center.x() = bad;
    detection.length_m = bad;
    detection.z_max_m = bad;
    detection.hull.emplace_back(bad, bad);
    picture.detections.push_back(detection);
    picture.truth_boxes.push_back({.center = {bad, 0.0F, 0.0F}, .height_m = bad, .label = "t"});
  }
  picture.sensor_origin.z() = kNan;

  WritePng(picture, File("bad.png"));

  EXPECT_GT(Read(File("bad.png")).colours_left.size(), 20U);
}

TEST_F(ScanPictureTest, BearsTextOfAnyBytesAndLength) {
  ScanPicture picture = SmallScene();
  picture.title = std::string("not UTF-8: \xC3\x28 \xED\xA0\x80 \xF5 \xE2\x82") + '\0' + "\t\n";
  picture.text_lines = std::vector<std::string>(30, std::string(5000, 'W'));
  picture.text_lines[1] = "gr\u00FC\u00DFe \u20AC \U0001F600";
  picture.detections[0].label = "\xFF";

  WritePng(picture, File("text.png"));

  EXPECT_GT(Read(File("text.png")).colours_left.size(), 20U);
}

TEST_F(ScanPictureTest, SaysWhichFileCannotBeWrittenAndWhy) {
  const std::filesystem::path missing = File("no_such_folder") / "scene.png";

  try {
    WritePng(SmallScene(), missing);
    FAIL() << "no exception";
  } catch (const std::runtime_error& error) {
    EXPECT_THAT(error.what(),
                AllOf(HasSubstr(missing.string()), HasSubstr("No such file or directory")));
  }
}

}  // namespace
}  // namespace clearway::plot
