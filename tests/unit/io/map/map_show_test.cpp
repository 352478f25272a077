// SPDX-License-Identifier: BSD-3-Clause
#include <cmath>
#include <cstdint>
#include <stdexcept>
#include <string>
#include <utility>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "common/io/file_bytes.hpp"
#include "tests/support/test_folder.hpp"
#include "tools/map/show.hpp"
#include "tools/plot/map_picture.hpp"

namespace clearway::map_tool {
namespace {

using core::OccupancyGrid;
using testing::HasSubstr;

OccupancyGrid GridOf(int width, int height, std::uint8_t cell) {
  OccupancyGrid grid;
  grid.geometry.width = width;
  grid.geometry.height = height;
  grid.cells.assign(grid.geometry.num_cells(), cell);
  return grid;
}

// The part of a picture that shows cells, without legend, ticks and the axes at the origin.
std::size_t BlackPixels(const std::string& png) {
  const io::MapImage image = io::ParsePng(png, "picture");
  std::size_t count = 0;
  for (int line = 45; line < image.height - 120; ++line) {
    for (int column = 150; column < image.width - 350; ++column) {
      const auto pixel = static_cast<std::size_t>(line * image.width + column);
      if (image.brightness[pixel] == 0) ++count;
    }
  }
  return count;
}

class MapShow : public testing::Test {
 protected:
  std::string PictureOf(const OccupancyGrid& grid) {
    plot::WriteMapPng(grid, {}, folder_.path() / "a.png");
    return io::ReadFileBytes(folder_.path() / "a.png");
  }
  test::TestFolder folder_;
};

TEST_F(MapShow, ASingleOccupiedCellOfALargeMapStaysVisible) {
  constexpr int kSide = 3000;
  for (const double yaw_rad : {0.0, 0.7}) {
    for (const int at : {1500, 1501, 1502, 1777}) {
      for (const std::uint8_t around : {OccupancyGrid::kFree, OccupancyGrid::kUnknown}) {
        OccupancyGrid grid = GridOf(kSide, kSide, around);
        grid.geometry.origin_yaw_rad = yaw_rad;
        grid.cells[grid.geometry.IndexOf({at, at})] = OccupancyGrid::kOccupied;

        EXPECT_EQ(BlackPixels(PictureOf(grid)), 1U) << at << ", yaw " << yaw_rad;
      }
    }
  }
}

TEST_F(MapShow, EachCellOfASmallMapHasItsShareOfTheArea) {
  OccupancyGrid grid = GridOf(20, 20, OccupancyGrid::kFree);
  const std::size_t none = BlackPixels(PictureOf(grid));
  grid.cells[grid.geometry.IndexOf({10, 10})] = OccupancyGrid::kOccupied;
  const auto one = static_cast<double>(BlackPixels(PictureOf(grid)));
  grid.geometry.origin_yaw_rad = 0.5;
  const auto turned = static_cast<double>(BlackPixels(PictureOf(grid)));

  EXPECT_EQ(none, 0U);
  // 900 pixels for 20 cells and two margins of 3 % of them.
  const double expected = 900.0 / 1.06 / 20.0 * 900.0 / 1.06 / 20.0;
  EXPECT_NEAR(one, expected, 0.05 * expected);
  const double scale = std::cos(0.5) + std::sin(0.5);
  EXPECT_NEAR(turned, expected / (scale * scale), 0.05 * expected);
}

TEST_F(MapShow, TheSameMapGivesTheSameBytes) {
  const OccupancyGrid grid = GridOf(30, 7, 42);

  EXPECT_EQ(PictureOf(grid), PictureOf(grid));
}

TEST_F(MapShow, DrawsMapsOfOddShapes) {
  for (const auto& [width, height] : {std::pair(1, 1), std::pair(5000, 1), std::pair(1, 5000)}) {
    OccupancyGrid grid = GridOf(width, height, OccupancyGrid::kOccupied);
    grid.geometry.origin_x_m = 5e7;
    grid.geometry.origin_yaw_rad = -2.0;
    EXPECT_NO_THROW(PictureOf(grid));
  }
}

TEST_F(MapShow, RefusesToDrawBeyondTheLimits) {
  OccupancyGrid grid = GridOf(3, 3, OccupancyGrid::kFree);
  grid.geometry.resolution_m = 1e-300;
  EXPECT_THROW(PictureOf(grid), std::runtime_error);
  grid.geometry.resolution_m = 1e300;
  EXPECT_THROW(PictureOf(grid), std::runtime_error);
  grid.geometry.resolution_m = 1.0;
  grid.geometry.origin_y_m = -1e18;
  EXPECT_THROW(PictureOf(grid), std::runtime_error);
}

TEST_F(MapShow, CountsCellsByKind) {
  OccupancyGrid grid = GridOf(3, 2, 0);
  grid.cells = {0, 1, 99, 100, 255, 255};

  const plot::CellCounts counts = plot::CountCells(grid);

  EXPECT_EQ(counts.free, 1U);
  EXPECT_EQ(counts.between, 2U);
  EXPECT_EQ(counts.occupied, 1U);
  EXPECT_EQ(counts.unknown, 2U);
}

TEST_F(MapShow, WritesTheFiguresAsJsonAndAsALine) {
  io::LoadedMap map;
  map.grid = GridOf(3, 2, 0);
  map.grid.cells = {0, 1, 99, 100, 255, 255};
  map.grid.geometry.origin_yaw_rad = 1.5;
  map.description.mode = io::MapMode::kScale;
  map.description.ignored_keys = {"cost"};
  map.image_path = "a\xff.pgm";

  const auto json = nlohmann::json::parse(FormatJson(map));

  EXPECT_EQ(json["size"]["width"], 3);
  EXPECT_EQ(json["size"]["height"], 2);
  EXPECT_EQ(json["resolution_m"], 0.05);
  EXPECT_EQ(json["origin"]["yaw_rad"], 1.5);
  EXPECT_EQ(json["cells"]["between"], 2);
  EXPECT_EQ(json["cells"]["unknown"], 2);
  EXPECT_EQ(json["mode"], "scale");
  EXPECT_EQ(json["ignored_keys"][0], "cost");
  EXPECT_THAT(FormatLine(map), HasSubstr("scale: 1 free, 1 occupied, 2 between, 2 unknown"));
}

}  // namespace
}  // namespace clearway::map_tool
