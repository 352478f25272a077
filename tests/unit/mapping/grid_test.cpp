// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <random>

#include <gtest/gtest.h>

#include "common/core/mapping/distance_field.hpp"
#include "common/core/mapping/occupancy_grid.hpp"
#include "tests/unit/mapping/random_grid.hpp"

namespace clearway::core {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinity = std::numeric_limits<double>::infinity();

GridGeometry MakeGeometry(double yaw_rad) {
  GridGeometry geometry;
  geometry.width = 40;
  geometry.height = 25;
  geometry.resolution_m = 0.05;
  geometry.origin_x_m = -0.7;
  geometry.origin_y_m = 3.2;
  geometry.origin_yaw_rad = yaw_rad;
  return geometry;
}

class GridGeometryYawTest : public testing::TestWithParam<double> {};

TEST_P(GridGeometryYawTest, TheMiddleOfEachCellLiesInThatCell) {
  const GridGeometry geometry = MakeGeometry(GetParam());

  for (int row = 0; row < geometry.height; ++row) {
    for (int column = 0; column < geometry.width; ++column) {
      const CellIndex cell{column, row};
      ASSERT_EQ(geometry.CellAt(geometry.CenterOf(cell)), cell);
    }
  }
}

TEST_P(GridGeometryYawTest, TheMiddlesOfTheCellsAroundTheGridAreOffIt) {
  const GridGeometry geometry = MakeGeometry(GetParam());

  for (int i = -1; i <= geometry.width; ++i) {
    EXPECT_FALSE(geometry.CellAt(geometry.CenterOf({i, -1})));
    EXPECT_FALSE(geometry.CellAt(geometry.CenterOf({i, geometry.height})));
  }
  for (int i = -1; i <= geometry.height; ++i) {
    EXPECT_FALSE(geometry.CellAt(geometry.CenterOf({-1, i})));
    EXPECT_FALSE(geometry.CellAt(geometry.CenterOf({geometry.width, i})));
  }
}

TEST_P(GridGeometryYawTest, AWindowHoldsTheCellOfEachOfItsPoints) {
  const GridGeometry geometry = MakeGeometry(GetParam());
  std::mt19937 random(11);
  std::uniform_real_distribution<double> along(-3.0, 6.0);
  for (int run = 0; run < 300; ++run) {
    const Eigen::Vector2d a(along(random), along(random));
    const Eigen::Vector2d b(along(random), along(random));
    const Eigen::Vector2d low = a.cwiseMin(b);
    const Eigen::Vector2d high = a.cwiseMax(b);

    const CellRectangle window = CellsInWindow(geometry, low, high);

    const CellRectangle whole{0, 0, geometry.width, geometry.height};
    EXPECT_EQ(Intersection(window, whole), window);
    std::uniform_real_distribution<double> share(0.0, 1.0);
    for (int i = 0; i < 20; ++i) {
      const Eigen::Vector2d inside(std::lerp(low.x(), high.x(), share(random)),
                                   std::lerp(low.y(), high.y(), share(random)));
      const auto cell = geometry.CellAt(inside);
      if (!cell) continue;
      EXPECT_EQ(Intersection(window, {cell->column, cell->row, 1, 1}).num_cells(), 1);
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Turned,
                         GridGeometryYawTest,
                         testing::Values(0.0, 0.4, std::numbers::pi / 2.0, -2.5));

TEST(GridGeometry, AQuarterTurnLetsColumnsRunAlongY) {
  GridGeometry geometry = MakeGeometry(std::numbers::pi / 2.0);
  geometry.origin_x_m = 0.0;
  geometry.origin_y_m = 0.0;

  EXPECT_EQ(geometry.CellAt({-0.12, 0.32}), (CellIndex{6, 2}));
}

TEST(GridGeometry, TheLowerLeftCornerBelongsToTheGridAndTheUpperRightDoesNot) {
  GridGeometry geometry = MakeGeometry(0.0);
  geometry.resolution_m = 0.5;  // Exact in binary, as is the origin.
  geometry.origin_x_m = -1.0;
  geometry.origin_y_m = 2.0;

  EXPECT_EQ(geometry.CellAt({-1.0, 2.0}), (CellIndex{0, 0}));
  EXPECT_EQ(geometry.CellAt({-0.5, 2.0}), (CellIndex{1, 0}));
  EXPECT_FALSE(geometry.CellAt({19.0, 2.0}));
  EXPECT_FALSE(geometry.CellAt({-1.0, 14.5}));
}

TEST(GridGeometry, PointsThatAreNotFiniteOrHugeAreOffTheGrid) {
  const GridGeometry geometry = MakeGeometry(0.3);

  for (const double bad : {kNan, kInfinity, -kInfinity, 1e300, -1e300}) {
    EXPECT_FALSE(geometry.CellAt({bad, 3.5}));
    EXPECT_FALSE(geometry.CellAt({0.0, bad}));
  }
}

TEST(GridGeometry, OnlySoundGeometriesAreValid) {
  const GridGeometry good = MakeGeometry(0.1);
  EXPECT_TRUE(good.IsValid());
  const auto is_valid_with = [&](auto change) {
    GridGeometry geometry = good;
    change(geometry);
    return geometry.IsValid();
  };

  EXPECT_FALSE(is_valid_with([](GridGeometry& g) { g.width = 0; }));
  EXPECT_FALSE(is_valid_with([](GridGeometry& g) { g.height = -1; }));
  EXPECT_FALSE(is_valid_with([](GridGeometry& g) { g.width = g.height = -5; }));
  EXPECT_FALSE(is_valid_with([](GridGeometry& g) { g.resolution_m = 0.0; }));
  EXPECT_FALSE(is_valid_with([](GridGeometry& g) { g.resolution_m = kNan; }));
  EXPECT_FALSE(is_valid_with([](GridGeometry& g) { g.origin_x_m = kInfinity; }));
  EXPECT_FALSE(is_valid_with([](GridGeometry& g) { g.origin_yaw_rad = kNan; }));
  EXPECT_TRUE(is_valid_with([](GridGeometry& g) { g.width = g.height = 10'000; }));
  EXPECT_FALSE(
      is_valid_with([](GridGeometry& g) { g.width = g.height = std::numeric_limits<int>::max(); }));
}

TEST(CellsInWindow, IsTheLeastRectangleOnAStraightGrid) {
  const GridGeometry geometry = MakeGeometry(0.0);

  const CellRectangle window = CellsInWindow(geometry, {-0.62, 3.33}, {-0.44, 3.41});

  EXPECT_EQ(window, (CellRectangle{1, 2, 5, 3}));
}

TEST(CellsInWindow, IsNothingOffTheGridAndForBadCorners) {
  const GridGeometry geometry = MakeGeometry(0.2);
  const CellRectangle nothing;

  EXPECT_EQ(CellsInWindow(geometry, {-9.0, -9.0}, {-8.0, -8.0}), nothing);
  EXPECT_EQ(CellsInWindow(geometry, {8.0, 8.0}, {9.0, 9.0}), nothing);
  EXPECT_EQ(CellsInWindow(geometry, {kNan, 0.0}, {1.0, 1.0}), nothing);
  EXPECT_EQ(CellsInWindow(geometry, {0.0, 0.0}, {1.0, kInfinity}), nothing);
}

TEST(CellsInWindow, AHugeWindowHoldsTheWholeGrid) {
  for (const double yaw_rad : {0.0, 0.7}) {
    const GridGeometry geometry = MakeGeometry(yaw_rad);

    const CellRectangle window = CellsInWindow(geometry, {-1e300, -1e300}, {1e300, 1e300});

    EXPECT_EQ(window, (CellRectangle{0, 0, geometry.width, geometry.height}));
  }
}

TEST(Intersection, OfHugeRectanglesDoesNotOverflow) {
  constexpr int kMost = std::numeric_limits<int>::max();

  EXPECT_EQ(Intersection({5, 5, kMost, kMost}, {7, 6, 10, 10}), (CellRectangle{7, 6, 10, 10}));
  EXPECT_EQ(Intersection({0, 0, 4, 4}, {4, 0, 4, 4}), CellRectangle{});
}

TEST(CellsOf, ReadsARectangleRowByRow) {
  OccupancyGrid grid = MakeGrid(4, 3);
  for (std::size_t i = 0; i < grid.cells.size(); ++i) {
    grid.cells[i] = static_cast<std::uint8_t>(i);
  }

  EXPECT_EQ(CellsOf(grid, {1, 1, 2, 2}), (std::vector<std::uint8_t>{5, 6, 9, 10}));
  EXPECT_TRUE(CellsOf(grid, {}).empty());
}

// Squared distance to the nearest cell of at least `from`, over all cells.
int NearestByAllCells(const OccupancyGrid& grid, const CellIndex& cell, int from = 65) {
  int least = DistanceField::kFar;
  for (int row = 0; row < grid.geometry.height; ++row) {
    for (int column = 0; column < grid.geometry.width; ++column) {
      const std::uint8_t value = grid.At({column, row});
      if (value == OccupancyGrid::kUnknown || value < from) continue;
      const int dx = column - cell.column;
      const int dy = row - cell.row;
      least = std::min(least, dx * dx + dy * dy);
    }
  }
  return least;
}

void ExpectExact(const OccupancyGrid& grid) {
  const DistanceField field(grid);
  for (int row = 0; row < grid.geometry.height; ++row) {
    for (int column = 0; column < grid.geometry.width; ++column) {
      ASSERT_EQ(field.SquaredCells({column, row}), NearestByAllCells(grid, {column, row}))
          << column << ", " << row << " of " << grid.geometry.width << " x "
          << grid.geometry.height;
    }
  }
}

TEST(DistanceField, IsWhatASearchOverAllCellsFinds) {
  std::mt19937 random(3);
  std::uniform_int_distribution<int> size(1, 24);
  for (const double share : {0.002, 0.02, 0.1, 0.5, 0.95}) {
    for (int run = 0; run < 12; ++run) {
      ExpectExact(MakeRandomGrid(size(random), size(random), share, 0.04, random));
    }
  }
}

TEST(DistanceField, IsExactUpToTheCapAndFarFromThere) {
  OccupancyGrid wide = MakeGrid(600, 3);
  SetCell(wide, {40, 1}, OccupancyGrid::kOccupied);
  OccupancyGrid tall = MakeGrid(3, 600);
  SetCell(tall, {1, 40}, OccupancyGrid::kOccupied);

  ExpectExact(wide);
  ExpectExact(tall);
  EXPECT_EQ(DistanceField(wide).SquaredCells({295, 1}), 255 * 255);
  EXPECT_EQ(DistanceField(wide).SquaredCells({296, 1}), DistanceField::kFar);
}

TEST(DistanceField, IsExactOnTheDiagonalNearTheCap) {
  OccupancyGrid grid = MakeGrid(260, 200);
  SetCell(grid, {0, 0}, OccupancyGrid::kOccupied);
  const DistanceField field(grid);

  EXPECT_EQ(field.SquaredCells({172, 189}), 172 * 172 + 189 * 189);
  EXPECT_EQ(field.SquaredCells({181, 181}), 181 * 181 * 2);
  EXPECT_EQ(field.SquaredCells({182, 182}), DistanceField::kFar);
}

TEST(DistanceField, OfAGridWithoutOccupiedCellsIsFarEverywhere) {
  for (const std::uint8_t value : {OccupancyGrid::kFree, OccupancyGrid::kUnknown}) {
    const OccupancyGrid grid = MakeGrid(7, 5, value);

    EXPECT_EQ(DistanceField(grid).SquaredCells({3, 2}), DistanceField::kFar);
  }
}

TEST(DistanceField, OfAFullGridIsNoughtEverywhere) {
  const OccupancyGrid grid = MakeGrid(7, 5, OccupancyGrid::kOccupied);

  ExpectExact(grid);
  EXPECT_EQ(DistanceField(grid).SquaredCells({6, 4}), 0);
}

TEST(DistanceField, OccupiedBeginsWhereItIsTold) {
  OccupancyGrid grid = MakeGrid(5, 1);
  SetCell(grid, {0, 0}, 64);
  SetCell(grid, {4, 0}, 65);

  EXPECT_EQ(DistanceField(grid).SquaredCells({0, 0}), 16);
  EXPECT_EQ(DistanceField(grid, 64).SquaredCells({0, 0}), 0);
  EXPECT_EQ(DistanceField(grid, 66).SquaredCells({0, 0}), DistanceField::kFar);
}

}  // namespace
}  // namespace clearway::core
