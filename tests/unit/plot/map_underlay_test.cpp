// SPDX-License-Identifier: BSD-3-Clause
#include "tools/plot/map_underlay.hpp"

#include <cmath>
#include <cstdint>
#include <fstream>
#include <memory>
#include <random>

#include <gtest/gtest.h>

#include "tests/support/test_folder.hpp"
#include "tests/unit/plot/png_pixels.hpp"
#include "tools/plot/camera.hpp"
#include "tools/plot/palette.hpp"

namespace clearway::plot {
namespace {

using core::OccupancyGrid;

// Coordinates this near to the side of a cell may fall on either side of it.
constexpr double kSide_cells = 1e-6;

// A grid with a yaw of its own, seen by a vehicle with another.
constexpr double kGridYaw_rad = 0.4;
constexpr double kYaw_rad = 2.1;
constexpr double kX_m = 3.0;
constexpr double kY_m = -2.0;

PictureMap Map(int width, int height, double resolution_m, double grid_yaw_rad) {
  auto grid = std::make_shared<OccupancyGrid>();
  grid->geometry = {width, height, resolution_m, -4.0, -5.0, grid_yaw_rad};
  grid->cells.assign(grid->geometry.num_cells(), OccupancyGrid::kFree);
  PictureMap map;
  map.grid = grid;
  map.T_map_vehicle.translation() = Eigen::Vector3d(kX_m, kY_m, 0.0);
  map.T_map_vehicle.linear() =
      Eigen::AngleAxisd(kYaw_rad, Eigen::Vector3d::UnitZ()).toRotationMatrix();
  return map;
}

OccupancyGrid& CellsOf(PictureMap& map) {
  return const_cast<OccupancyGrid&>(*map.grid);  // NOLINT: made by Map() as not const.
}

TEST(GroundAt, FollowsThePoseAndTheGridsOwnYaw) {
  std::mt19937 random(7);
  PictureMap map = Map(40, 30, 0.3, kGridYaw_rad);
  constexpr std::uint8_t kValues[] = {0, 0, 30, 65, 100, OccupancyGrid::kUnknown};
  for (std::uint8_t& cell : CellsOf(map).cells) cell = kValues[random() % std::size(kValues)];
  std::uniform_real_distribution<double> coordinate(-12.0, 12.0);
  int on_map = 0;

  for (int i = 0; i < 5000; ++i) {
    const double x = coordinate(random);
    const double y = coordinate(random);
    // By hand: vehicle -> map -> axes of the grid.
    const double x_map = kX_m + std::cos(kYaw_rad) * x - std::sin(kYaw_rad) * y;
    const double y_map = kY_m + std::sin(kYaw_rad) * x + std::cos(kYaw_rad) * y;
    const double range = std::hypot(x_map + 4.0, y_map + 5.0) / 0.3;
    const double bearing = std::atan2(y_map + 5.0, x_map + 4.0) - kGridYaw_rad;
    const double column = range * std::cos(bearing);
    const double row = range * std::sin(bearing);
    if (std::abs(column - std::round(column)) < kSide_cells) continue;
    if (std::abs(row - std::round(row)) < kSide_cells) continue;
    MapGround expected = MapGround::kUnknown;
    if (column > 0.0 && column < 40.0 && row > 0.0 && row < 30.0) {
      ++on_map;
      const std::uint8_t value = map.grid->At({static_cast<int>(column), static_cast<int>(row)});
      if (value == 0) expected = MapGround::kFree;
      if (value == 30) expected = MapGround::kBetween;
      if (value == 65 || value == 100) expected = MapGround::kOccupied;
    }

    EXPECT_EQ(GroundAt(map, {x, y}), expected) << x << " " << y;
  }
  EXPECT_GT(on_map, 500);
}

// One pixel is 0.1 m; x to the right and y down, the vehicle in the middle.
FloorView TestView() {
  return {
      .floor_at =
          [](const Eigen::Vector2d& pixel) {
            return std::optional<Eigen::Vector2d>(0.1 * (pixel - Eigen::Vector2d(100.0, 100.0)));
          },
      .pixel_at =
          [](const Eigen::Vector2d& point) {
            return std::optional<Eigen::Vector2d>(10.0 * point + Eigen::Vector2d(100.0, 100.0));
          },
      .low = {-10.0, -10.0},
      .high = {10.0, 10.0}};
}

test::PngPixels Drawn(const PictureMap& map) {
  const test::TestFolder folder;
  Canvas canvas(200, 200);
  DrawMap(canvas, {0.0, 0.0, 200.0, 200.0}, map, TestView());
  const std::vector<unsigned char> png = canvas.EncodePng();
  return test::ReadPng(folder.Write("map.png", std::string(png.begin(), png.end())));
}

TEST(DrawMap, LaysTheCellsWhereTheVehicleSeesThem) {
  PictureMap map = Map(20, 20, 0.5, 0.0);
  CellsOf(map).cells[map.grid->geometry.IndexOf({12, 9})] = OccupancyGrid::kOccupied;
  CellsOf(map).cells[map.grid->geometry.IndexOf({3, 4})] = OccupancyGrid::kUnknown;
  // Where the middles of the cells are: map -> vehicle, by hand.
  const auto pixel_of = [](int column, int row) {
    const double dx = -4.0 + 0.5 * (column + 0.5) - kX_m;
    const double dy = -5.0 + 0.5 * (row + 0.5) - kY_m;
    return Eigen::Vector2i(
        static_cast<int>(100.0 + 10.0 * (std::cos(kYaw_rad) * dx + std::sin(kYaw_rad) * dy)),
        static_cast<int>(100.0 + 10.0 * (std::cos(kYaw_rad) * dy - std::sin(kYaw_rad) * dx)));
  };

  const test::PngPixels pixels = Drawn(map);

  const auto colour_of = [&](int column, int row) {
    const Eigen::Vector2i pixel = pixel_of(column, row);
    return pixels.At(pixel.x(), pixel.y());
  };
  EXPECT_EQ(colour_of(12, 9), test::ColourCode(kOccupiedGrey));
  EXPECT_EQ(colour_of(11, 9), 0xFFFFFFU);
  EXPECT_EQ(colour_of(12, 10), 0xFFFFFFU);
  const std::uint32_t unknown = colour_of(3, 4);
  EXPECT_TRUE(unknown == test::ColourCode(kUnknownTint) ||
              unknown == test::ColourCode(kUnknownHatch));
}

TEST(DrawMap, LosesNoOccupiedCellThatIsSmallerThanAPixel) {
  PictureMap map = Map(1000, 1000, 0.01, kGridYaw_rad);
  for (int i = 0; i < 1000; i += 100) {
    CellsOf(map).cells[map.grid->geometry.IndexOf({i, 500})] = OccupancyGrid::kOccupied;
  }

  const test::PngPixels pixels = Drawn(map);

  // All ten are within the view: the map is 10 m wide, and turns about its corner.
  EXPECT_EQ(pixels.Count(test::ColourCode(kOccupiedGrey), {0.0, 0.0, 200.0, 200.0}), 10U);
}

TEST(CameraFloor, IsWhereThePixelsOfTheFloorComeFrom) {
  const ViewRegion region{.x_min_m = -2.0,
                          .x_max_m = 8.0,
                          .y_min_m = -4.0,
                          .y_max_m = 5.0,
                          .anchors = {{0.0F, 0.0F, 0.0F}, {8.0F, -4.0F, 0.0F}}};
  const Camera camera({10.0, 20.0, 700.0, 600.0}, region);

  for (const Eigen::Vector2d& point :
       {Eigen::Vector2d(0.0, 0.0), Eigen::Vector2d(7.5, -3.0), Eigen::Vector2d(2.0, 4.5)}) {
    const auto pixel = camera.Project({point.x(), point.y(), 0.0});
    ASSERT_TRUE(pixel.has_value());
    const auto floor = camera.FloorAt(*pixel);
    ASSERT_TRUE(floor.has_value());
    EXPECT_LT((*floor - point).norm(), 1e-9);
  }
  EXPECT_FALSE(camera.FloorAt({360.0, -1e5}).has_value());
}

}  // namespace
}  // namespace clearway::plot
