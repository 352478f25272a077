// SPDX-License-Identifier: BSD-3-Clause
#include "common/core/mapping/map_builder.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <random>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "tests/unit/mapping/random_grid.hpp"

namespace clearway::core {
namespace {

using Outcome = MapBuilder::Outcome;

constexpr double kResolution_m = 0.05;

// Puts the lower left cell of a grid at a column and row counted from map's origin.
OccupancyGrid At(OccupancyGrid grid, int column, int row) {
  grid.geometry.resolution_m = kResolution_m;
  grid.geometry.origin_x_m = kResolution_m * column;
  grid.geometry.origin_y_m = kResolution_m * row;
  return grid;
}

int ColumnOf(const OccupancyGrid& grid) {
  return static_cast<int>(std::lround(grid.geometry.origin_x_m / kResolution_m));
}
int RowOf(const OccupancyGrid& grid) {
  return static_cast<int>(std::lround(grid.geometry.origin_y_m / kResolution_m));
}

// Local maps all over the place, on both sides of map's origin.
std::vector<OccupancyGrid> MakeLocalMaps(int num, std::mt19937& random) {
  std::uniform_int_distribution<int> size(1, 40);
  std::uniform_int_distribution<int> place(-90, 60);
  std::vector<OccupancyGrid> maps;
  for (int i = 0; i < num; ++i) {
    const OccupancyGrid grid = MakeRandomGrid(size(random), size(random), 0.3, 0.4, random);
    maps.push_back(At(grid, place(random), place(random)));
  }
  return maps;
}

OccupancyGrid BuildFrom(const std::vector<OccupancyGrid>& maps, const MapBuilderConfig& config) {
  MapBuilder builder;
  for (const OccupancyGrid& map : maps) EXPECT_EQ(builder.Add(map), Outcome::kAdded);
  return builder.Build(config);
}

TEST(MapBuilder, CountsAsAListOfAllCellsDoes) {
  std::mt19937 random(41);
  const std::vector<OccupancyGrid> maps = MakeLocalMaps(60, random);
  std::map<std::pair<int, int>, std::pair<int, int>> evidence;  // Seen and hit by column and row.
  for (const OccupancyGrid& map : maps) {
    for (int row = 0; row < map.geometry.height; ++row) {
      for (int column = 0; column < map.geometry.width; ++column) {
        const std::uint8_t value = map.At({column, row});
        if (value == OccupancyGrid::kUnknown) continue;
        auto& [seen, hit] = evidence[{ColumnOf(map) + column, RowOf(map) + row}];
        ++seen;
        if (value == OccupancyGrid::kOccupied) ++hit;
      }
    }
  }

  const OccupancyGrid built = BuildFrom(maps, {.min_share = 0.5, .min_scans = 2});

  std::size_t num_known = 0;
  for (const auto& [cell, counts] : evidence) {
    const CellIndex index{cell.first - ColumnOf(built), cell.second - RowOf(built)};
    ASSERT_TRUE(built.geometry.Contains(index));
    const auto [seen, hit] = counts;
    const int expected = seen < 2 ? 255 : 2 * hit >= seen ? 100 : 0;
    EXPECT_EQ(built.At(index), expected);
    if (seen >= 2) ++num_known;
  }
  EXPECT_EQ(static_cast<std::size_t>(std::count_if(
                built.cells.begin(), built.cells.end(), [](std::uint8_t v) { return v != 255; })),
            num_known);
  const auto [first, last] = std::pair(evidence.begin()->first, evidence.rbegin()->first);
  EXPECT_EQ(ColumnOf(built), first.first);  // Cut to what was seen.
  EXPECT_EQ(built.geometry.width, last.first - first.first + 1);
}

TEST(MapBuilder, TheOrderOfLocalMapsDoesNotMatter) {
  std::mt19937 random(43);
  std::vector<OccupancyGrid> maps = MakeLocalMaps(40, random);
  const OccupancyGrid built = BuildFrom(maps, {});

  std::shuffle(maps.begin(), maps.end(), random);

  EXPECT_EQ(BuildFrom(maps, {}), built);
}

TEST(MapBuilder, SomebodyWhoWalksLeavesNoTraceAndAWallStays) {
  constexpr int kScans = 40;
  constexpr int kWall = 29;  // Column.
  MapBuilder builder;

  for (int scan = 0; scan < kScans; ++scan) {
    OccupancyGrid local = MakeGrid(30, 60);
    for (int row = 0; row < 60; ++row) SetCell(local, {kWall, row}, OccupancyGrid::kOccupied);
    // A person of 6 x 6 cells, 1 cell a scan: each cell is hit in 6 of 40 scans.
    for (int i = 0; i < 36; ++i) {
      SetCell(local, {10 + i % 6, scan + i / 6}, OccupancyGrid::kOccupied);
    }
    builder.Add(At(local, -7, 3));
  }
  const OccupancyGrid built = builder.Build({.min_share = 0.3, .min_scans = 2});

  for (int row = 0; row < 60; ++row) {
    for (int column = 0; column < 30; ++column) {
      ASSERT_EQ(built.At({column, row}), column == kWall ? 100 : 0);
    }
  }
}

TEST(MapBuilder, ACellHitInExactlyTheShareIsOccupied) {
  MapBuilder builder;
  for (int scan = 0; scan < 10; ++scan) {
    OccupancyGrid local = MakeGrid(2, 1);
    if (scan < 3) SetCell(local, {0, 0}, OccupancyGrid::kOccupied);
    if (scan < 2) SetCell(local, {1, 0}, OccupancyGrid::kOccupied);
    builder.Add(At(local, 0, 0));
  }

  EXPECT_EQ(builder.Build({.min_share = 0.3, .min_scans = 2}).cells,
            (std::vector<std::uint8_t>{100, 0}));
}

TEST(MapBuilder, ACellThatWasNeverHitIsFreeEvenWithAShareOfNought) {
  const OccupancyGrid built =
      BuildFrom({At(MakeGrid(1, 1), 0, 0)}, {.min_share = 0.0, .min_scans = 1});

  EXPECT_EQ(built.cells, std::vector<std::uint8_t>{0});
}

TEST(MapBuilder, CellsSeenTooSeldomAreUnknown) {
  OccupancyGrid first = MakeGrid(3, 1, OccupancyGrid::kOccupied);
  OccupancyGrid second = first;
  SetCell(second, {1, 0}, OccupancyGrid::kUnknown);

  const OccupancyGrid built = BuildFrom({At(first, 5, 5), At(second, 5, 5)}, {});

  EXPECT_EQ(built.cells, (std::vector<std::uint8_t>{100, 255, 100}));
}

TEST(MapBuilder, WhatWasNotSeenAddsNothing) {
  MapBuilder builder;

  EXPECT_EQ(builder.Add(At(MakeGrid(9, 9, OccupancyGrid::kUnknown), 0, 0)), Outcome::kAdded);
  EXPECT_EQ(builder.Add(OccupancyGrid{}), Outcome::kAdded);
  EXPECT_FALSE(builder.has_cells());
}

TEST(MapBuilder, IgnoresGridsThatDoNotFitTheFirst) {
  MapBuilder builder;
  builder.Add(At(MakeGrid(3, 3), -4, 8));
  OccupancyGrid coarse = At(MakeGrid(3, 3), 0, 0);
  coarse.geometry.resolution_m = 0.1;
  OccupancyGrid shifted = At(MakeGrid(3, 3), 0, 0);
  shifted.geometry.origin_y_m += 0.01;
  const OccupancyGrid before = builder.Build({.min_share = 0.3, .min_scans = 1});

  EXPECT_EQ(builder.Add(coarse), Outcome::kOtherGrid);
  EXPECT_EQ(builder.Add(shifted), Outcome::kOtherGrid);
  EXPECT_EQ(builder.Build({.min_share = 0.3, .min_scans = 1}), before);
}

TEST(MapBuilder, IgnoresGridsThatAreNotSound) {
  MapBuilder builder;
  OccupancyGrid turned = At(MakeGrid(3, 3), 0, 0);
  turned.geometry.origin_yaw_rad = 0.1;
  OccupancyGrid short_one = At(MakeGrid(3, 3), 0, 0);
  short_one.cells.pop_back();
  OccupancyGrid nowhere = At(MakeGrid(3, 3), 0, 0);
  nowhere.geometry.origin_x_m = std::numeric_limits<double>::quiet_NaN();

  EXPECT_EQ(builder.Add(turned), Outcome::kInvalid);
  EXPECT_EQ(builder.Add(short_one), Outcome::kInvalid);
  EXPECT_EQ(builder.Add(nowhere), Outcome::kInvalid);
  EXPECT_FALSE(builder.has_cells());
}

TEST(MapBuilder, DoesNotGrowWithoutBounds) {
  MapBuilder builder;
  builder.Add(At(MakeGrid(1, 1), 0, 0));
  OccupancyGrid beyond = At(MakeGrid(1, 1), 0, 0);
  beyond.geometry.origin_x_m = 1e300;

  EXPECT_EQ(builder.Add(At(MakeGrid(1, 1), 20'000, 20'000)), Outcome::kTooLarge);
  EXPECT_EQ(builder.Add(At(MakeGrid(1, 1), -900'000'000, 900'000'000)), Outcome::kTooLarge);
  EXPECT_EQ(builder.Add(beyond), Outcome::kTooLarge);
  // One row is far from too many cells, but not so the blocks that it takes.
  EXPECT_EQ(builder.Add(At(MakeGrid(3'200'000, 1), 0, 0)), Outcome::kTooLarge);
  EXPECT_EQ(builder.Build({.min_share = 0.3, .min_scans = 1}).cells.size(), 1U);
}

}  // namespace
}  // namespace clearway::core
