// SPDX-License-Identifier: BSD-3-Clause
#include "common/core/mapping/wall_depth.hpp"

#include <random>

#include <gtest/gtest.h>

#include "tests/unit/mapping/random_grid.hpp"

namespace clearway::core {
namespace {

// By looking at all pairs of cells.
bool IsWithin(const OccupancyGrid& map, const CellIndex& cell, int squared_cells) {
  for (int row = 0; row < map.geometry.height; ++row) {
    for (int column = 0; column < map.geometry.width; ++column) {
      const int dx = column - cell.column;
      const int dy = row - cell.row;
      const std::uint8_t value = map.At({column, row});
      if (value >= 65 && value <= 100 && dx * dx + dy * dy <= squared_cells) return true;
    }
  }
  return false;
}

TEST(WallDepth, FillsExactlyTheUnknownCellsThatAreNearAnOccupiedOne) {
  std::mt19937 random(61);
  for (int seed = 0; seed < 30; ++seed) {
    OccupancyGrid map = MakeRandomGrid(17, 12, 0.5, 0.05, random);
    map.geometry.resolution_m = 0.05;
    map.geometry.origin_yaw_rad = 0.3 * seed;

    const OccupancyGrid deep = WithWallDepth(map, 0.15);

    ASSERT_EQ(deep.geometry.width, 17 + 6);
    ASSERT_EQ(deep.geometry.height, 12 + 6);
    for (int row = 0; row < deep.geometry.height; ++row) {
      for (int column = 0; column < deep.geometry.width; ++column) {
        const CellIndex old{column - 3, row - 3};
        const std::uint8_t before =
            map.geometry.Contains(old) ? map.At(old) : OccupancyGrid::kUnknown;
        const bool is_filled = before == OccupancyGrid::kUnknown && IsWithin(map, old, 9);
        EXPECT_EQ(deep.At({column, row}), is_filled ? OccupancyGrid::kOccupied : before);
      }
    }
  }
}

TEST(WallDepth, CellsStayWhereTheyAreInMap) {
  std::mt19937 random(62);
  OccupancyGrid map = MakeRandomGrid(9, 7, 0.5, 0.1, random);
  map.geometry = {9, 7, 0.1, -3.0, 2.0, 0.8};

  const OccupancyGrid deep = WithWallDepth(map, 0.3);

  EXPECT_TRUE(deep.geometry.CenterOf({3, 3}).isApprox(map.geometry.CenterOf({0, 0}), 1e-12));
  EXPECT_TRUE(deep.geometry.CenterOf({11, 9}).isApprox(map.geometry.CenterOf({8, 6}), 1e-12));
}

TEST(WallDepth, NoDepthChangesNothing) {
  std::mt19937 random(63);
  const OccupancyGrid map = MakeRandomGrid(20, 20, 0.4, 0.3, random);

  EXPECT_EQ(WithWallDepth(map, 0.0), map);
}

}  // namespace
}  // namespace clearway::core
