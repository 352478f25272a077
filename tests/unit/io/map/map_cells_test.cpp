// SPDX-License-Identifier: BSD-3-Clause
#include <cstdint>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "common/io/map/map_file.hpp"

namespace clearway::io {
namespace {

using testing::Each;
using testing::ElementsAre;

constexpr std::uint8_t kFree = core::OccupancyGrid::kFree;
constexpr std::uint8_t kOccupied = core::OccupancyGrid::kOccupied;
constexpr std::uint8_t kUnknown = core::OccupancyGrid::kUnknown;

MapDescription Description(MapMode mode, bool negate = false) {
  MapDescription map;
  map.image = "a.pgm";
  map.resolution_m = 0.1;
  map.origin = {1.0, -2.0, 0.5};
  map.mode = mode;
  map.negate = negate;
  return map;
}

// One line of gray pixels of 8 bits.
MapImage Line(const std::vector<std::uint16_t>& shades) {
  MapImage image;
  image.width = static_cast<int>(shades.size());
  image.height = 1;
  image.brightness = shades;
  return image;
}

std::vector<std::uint8_t> Cells(const MapImage& image, const MapDescription& map) {
  return ToGrid(image, map).cells;
}

TEST(MapCells, TheLastLineIsRowZero) {
  MapImage image = Line({0, 1, 2, 3, 4, 5});
  image.width = 3;
  image.height = 2;

  const core::OccupancyGrid grid = ToGrid(image, Description(MapMode::kRaw));

  EXPECT_THAT(grid.cells, ElementsAre(3, 4, 5, 0, 1, 2));
  EXPECT_EQ(grid.geometry.width, 3);
  EXPECT_EQ(grid.geometry.height, 2);
  EXPECT_EQ(grid.geometry.resolution_m, 0.1);
  EXPECT_EQ(grid.geometry.origin_x_m, 1.0);
  EXPECT_EQ(grid.geometry.origin_y_m, -2.0);
  EXPECT_EQ(grid.geometry.origin_yaw_rad, 0.5);
}

TEST(MapCells, TrinaryComparesStrictlyWithBothThresholds) {
  // 205 is what map_saver writes for unknown: 1 - 205 / 255 = 0.19608 is not below 0.196.
  EXPECT_THAT(Cells(Line({0, 89, 90, 205, 206, 254, 255}), Description(MapMode::kTrinary)),
              ElementsAre(kOccupied, kOccupied, kUnknown, kUnknown, kFree, kFree, kFree));
  MapDescription map = Description(MapMode::kTrinary);
  map.free_threshold = 0.25;
  EXPECT_THAT(Cells(Line({205}), map), ElementsAre(kFree));
  map.free_threshold = map.occupied_threshold = 1.0;
  EXPECT_THAT(Cells(Line({0, 1}), map), ElementsAre(kUnknown, kFree));
  map.free_threshold = map.occupied_threshold = 0.0;
  EXPECT_THAT(Cells(Line({255, 254}), map), ElementsAre(kUnknown, kOccupied));
}

TEST(MapCells, NegateTurnsBlackAndWhite) {
  const MapDescription map = Description(MapMode::kTrinary, true);

  EXPECT_THAT(Cells(Line({0, 49, 50, 165, 166, 255}), map),
              ElementsAre(kFree, kFree, kUnknown, kUnknown, kOccupied, kOccupied));
}

TEST(MapCells, NegateOfTheNegativeIsTheSame) {
  for (const MapMode mode : {MapMode::kTrinary, MapMode::kScale}) {
    for (std::uint16_t shade = 0; shade <= 255; ++shade) {
      const auto negative = static_cast<std::uint16_t>(255 - shade);
      EXPECT_EQ(Cells(Line({shade}), Description(mode)),
                Cells(Line({negative}), Description(mode, true)))
          << shade;
    }
  }
}

TEST(MapCells, ScaleIsLinearBetweenTheThresholds) {
  MapDescription map = Description(MapMode::kScale);
  map.occupied_threshold = 0.8;
  map.free_threshold = 0.2;

  // 1 - 0.5 is the middle; 102 / 255 = 0.4 gives (0.6 - 0.2) / 0.6.
  EXPECT_THAT(Cells(Line({0, 50, 102, 153, 206, 255}), map),
              ElementsAre(kOccupied, kOccupied, 67, 33, kFree, kFree));
}

TEST(MapCells, ScaleOverTheWholeRangeGivesEveryShadeItsPercentage) {
  MapDescription map = Description(MapMode::kScale);
  map.occupied_threshold = 1.0;
  map.free_threshold = 0.0;
  for (std::uint16_t shade = 0; shade <= 255; ++shade) {
    const int percent = (2 * 100 * (255 - shade) + 255) / (2 * 255);
    EXPECT_THAT(Cells(Line({shade}), map), ElementsAre(percent)) << shade;
  }
}

TEST(MapCells, ScaleWithEqualThresholdsLeavesEqualityUnknown) {
  MapDescription map = Description(MapMode::kScale);
  map.occupied_threshold = map.free_threshold = 0.5;
  MapImage image = Line({1, 2, 3});
  image.full_scale = 4;

  EXPECT_THAT(Cells(image, map), ElementsAre(kOccupied, kUnknown, kFree));
}

TEST(MapCells, RawKeepsUpToAHundredWhateverElseIsSaid) {
  for (const bool negate : {false, true}) {
    MapDescription map = Description(MapMode::kRaw, negate);
    map.occupied_threshold = map.free_threshold = 0.0;
    EXPECT_THAT(Cells(Line({0, 1, 99, 100, 101, 254, 255}), map),
                ElementsAre(0, 1, 99, 100, kUnknown, kUnknown, kUnknown));
  }
}

TEST(MapCells, RawOfOtherDepthsIsRounded) {
  MapImage image = Line({0, 1, 2, 3});
  image.full_scale = 10;
  EXPECT_THAT(Cells(image, Description(MapMode::kRaw)), ElementsAre(0, 26, 51, 77));
  image.full_scale = 65535;
  image.brightness = {25700, 25828, 25829, 65535};
  EXPECT_THAT(Cells(image, Description(MapMode::kRaw)), ElementsAre(100, 100, kUnknown, kUnknown));
}

TEST(MapCells, TrinaryTakesOpacityIntoTheMean) {
  MapImage image = Line({0, 255, 205, 0, 255, 255});
  image.opacity = {MapImage::kOpaque, MapImage::kOpaque, MapImage::kOpaque, 0, 0, 257};

  // The means: 0.25, 1, 0.853, -, -, 0.751.
  EXPECT_THAT(Cells(image, Description(MapMode::kTrinary)),
              ElementsAre(kOccupied, kFree, kFree, kUnknown, kUnknown, kUnknown));
}

TEST(MapCells, AnOpaqueChannelIsNotTheSameAsNone) {
  MapImage image = Line({102});
  EXPECT_THAT(Cells(image, Description(MapMode::kTrinary)), ElementsAre(kUnknown));
  MapDescription map = Description(MapMode::kTrinary);
  map.occupied_threshold = 0.5;
  EXPECT_THAT(Cells(image, map), ElementsAre(kOccupied));

  image.opacity = {MapImage::kOpaque};

  // (3 * 0.4 + 1) / 4 = 0.55.
  EXPECT_THAT(Cells(image, map), ElementsAre(kUnknown));
}

TEST(MapCells, ScaleLeavesWhateverIsNotOpaqueUnknown) {
  MapImage image = Line({0, 0, 0});
  image.opacity = {MapImage::kOpaque, MapImage::kOpaque - 1, 0};

  EXPECT_THAT(Cells(image, Description(MapMode::kScale)),
              ElementsAre(kOccupied, kUnknown, kUnknown));
}

TEST(MapCells, RawDoesNotLookAtOpacity) {
  MapImage image = Line({7, 7});
  image.opacity = {MapImage::kOpaque, 0};

  EXPECT_THAT(Cells(image, Description(MapMode::kRaw)), Each(7));
}

}  // namespace
}  // namespace clearway::io
