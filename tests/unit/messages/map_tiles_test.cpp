// SPDX-License-Identifier: BSD-3-Clause
#include "common/messages/map_tiles.hpp"

#include <functional>
#include <limits>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "common/messages/encoding.hpp"

namespace clearway::messages {
namespace {

using core::OccupancyGrid;

std::vector<std::uint8_t> RandomCells(std::size_t count, std::uint32_t seed) {
  constexpr std::uint8_t kValues[] = {0, 100, 255, 42};
  std::mt19937 random(seed);
  std::vector<std::uint8_t> cells;
  while (cells.size() < count) {
    cells.insert(cells.end(),
                 std::min<std::size_t>(count - cells.size(), 1 + random() % 9),
                 kValues[random() % 4]);
  }
  return cells;
}

core::MapTile Tile() {
  return {.version = {5, 7},
          .geometry = {40, 30, 0.05, -1.0, 2.0, 0.5},
          .index = 2,
          .count = 6,
          .rectangle = {0, 10, 40, 5},
          .cells = RandomCells(200, 1),
          .map_checksum = 0xFFFF0001U};
}

map_tile_t Message() {
  map_tile_t message = ToLcm(Tile());
  message.session = 5;
  return message;
}

TEST(MapTileMessageTest, GivesBackTheTileThatItWasMadeFrom) {
  const auto message = Decode<map_tile_t>(Encode(Message()));
  ASSERT_TRUE(message);

  const auto tile = FromLcm(*message);

  ASSERT_TRUE(tile);
  EXPECT_EQ(tile->version, Tile().version);
  EXPECT_EQ(tile->geometry, Tile().geometry);
  EXPECT_EQ(tile->index, 2);
  EXPECT_EQ(tile->count, 6);
  EXPECT_EQ(tile->rectangle, Tile().rectangle);
  EXPECT_EQ(tile->cells, Tile().cells);
  EXPECT_EQ(tile->map_checksum, 0xFFFF0001U);
}

TEST(MapTileMessageTest, TheHeaderTakesNoMoreThanItIsSaidTo) {
  const map_tile_t message = Message();

  EXPECT_LE(Encode(message).size() - message.data.size(), kMapTileHeaderBytes);
}

TEST(MapTileMessageTest, RefusesWhatBreaksARuleOfTheType) {
  const std::vector<std::pair<std::string, std::function<void(map_tile_t&)>>> damages = {
      {"no width", [](map_tile_t& m) { m.map_width = 0; }},
      {"huge map", [](map_tile_t& m) { m.map_width = m.map_height = 1 << 30; }},
      {"resolution", [](map_tile_t& m) { m.resolution_m = 0.0; }},
      {"origin", [](map_tile_t& m) { m.origin[2] = std::numeric_limits<double>::infinity(); }},
      {"left of the map", [](map_tile_t& m) { m.tile_x = -1; }},
      {"right of the map", [](map_tile_t& m) { m.tile_x = 1; }},
      {"above the map", [](map_tile_t& m) { m.tile_y = 26; }},
      {"overflow", [](map_tile_t& m) { m.tile_y = std::numeric_limits<int>::max(); }},
      {"empty tile", [](map_tile_t& m) { m.tile_height = 0; }},
      {"encoding", [](map_tile_t& m) { m.encoding = 2; }},
      {"short data", [](map_tile_t& m) { m.data.pop_back(); }},
      {"damaged data",
       [](map_tile_t& m) { m.data[1] = static_cast<std::uint8_t>(m.data[1] ^ 1U); }},
      {"checksum", [](map_tile_t& m) { ++m.tile_checksum; }},
  };
  for (const auto& [name, damage] : damages) {
    map_tile_t message = Message();
    damage(message);

    EXPECT_FALSE(FromLcm(message)) << name;
  }
}

TEST(MapTileMessageTest, RefusesValuesThatAreNoOccupancy) {
  core::MapTile tile = Tile();
  tile.cells[3] = 101;

  EXPECT_FALSE(FromLcm(ToLcm(tile)));
}

TEST(LocalMapMessageTest, SlicesOfAnySizeGiveBackTheCellsAndFitTheBus) {
  for (const std::size_t max_bytes : {400U, 1400U, 58'000U}) {
    core::LocalMap map;
    map.grid.geometry = {230, 170, 0.05, -4.0, 1.5, 0.0};
    map.grid.cells = RandomCells(map.grid.geometry.num_cells(), 2);
    map.sensor_origins_map = {{1.0, 2.0}, {3.0, 4.0}};

    const auto slices = ToLocalMap(map, {.utime = 9, .scan_id = 4}, max_bytes);

    OccupancyGrid again{map.grid.geometry, {}};
    again.cells.assign(map.grid.cells.size(), 77);
    for (const local_map_t& slice : slices) {
      EXPECT_LE(Encode(slice).size(), max_bytes);
      EXPECT_EQ(slice.slice_count, std::ssize(slices));
      const auto band = FromLcm(slice);
      ASSERT_TRUE(band);
      for (int row = 0; row < band->geometry.height; ++row) {
        for (int column = 0; column < band->geometry.width; ++column) {
          const auto cell = again.geometry.CellAt(band->geometry.CenterOf({column, row}));
          ASSERT_TRUE(cell);
          again.cells[again.geometry.IndexOf(*cell)] = band->At({column, row});
        }
      }
    }
    EXPECT_EQ(again, map.grid);
  }
}

TEST(LocalMapMessageTest, NothingSeenIsOneSliceWithoutCells) {
  core::LocalMap map;
  map.sensor_origins_map = {{1.0, 2.0}};

  const auto slices = ToLocalMap(map, {.utime = 9, .scan_id = 4}, 1400);

  ASSERT_EQ(slices.size(), 1U);
  EXPECT_EQ(slices.front().utime, 9);
  const auto grid = FromLcm(slices.front());
  ASSERT_TRUE(grid);
  EXPECT_TRUE(grid->cells.empty());
}

TEST(LocalMapMessageTest, RefusesCellsThatDoNotFitTheSize) {
  core::LocalMap map;
  map.grid.geometry = {10, 10, 0.05, 0.0, 0.0, 0.0};
  map.grid.cells = RandomCells(100, 3);
  local_map_t message = ToLocalMap(map, {}, 1400).front();
  ++message.height;

  EXPECT_FALSE(FromLcm(message));
}

}  // namespace
}  // namespace clearway::messages
