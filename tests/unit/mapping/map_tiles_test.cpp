// SPDX-License-Identifier: BSD-3-Clause
#include "common/core/mapping/map_tiles.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <utility>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "common/core/mapping/run_length.hpp"
#include "tests/unit/mapping/random_grid.hpp"

namespace clearway::core {
namespace {

using Outcome = MapAssembler::Outcome;
using testing::ElementsAre;
using testing::IsEmpty;

struct CutCase {
  int width;
  int height;
  double occupied;
  std::size_t max_bytes;
};
class CutTilesTest : public testing::TestWithParam<CutCase> {
 protected:
  static OccupancyGrid MakeLayer() {
    std::mt19937 random(17);
    const CutCase& layer = GetParam();
    return MakeRandomGrid(layer.width, layer.height, layer.occupied, 0.5 * layer.occupied, random);
  }
};

TEST_P(CutTilesTest, TilesCoverTheLayerWithoutOverlapAndFit) {
  const OccupancyGrid grid = MakeLayer();

  const std::vector<CellRectangle> tiles = CutTiles(grid, GetParam().max_bytes);

  std::vector<int> num_tiles(grid.cells.size(), 0);
  for (const CellRectangle& tile : tiles) {
    ASSERT_GT(tile.num_cells(), 0);
    ASSERT_LE(EncodedSize(CellsOf(grid, tile)), GetParam().max_bytes);
    for (int row = tile.row; row < tile.row + tile.height; ++row) {
      for (int column = tile.column; column < tile.column + tile.width; ++column) {
        ASSERT_TRUE(grid.geometry.Contains({column, row}));
        ++num_tiles[grid.geometry.IndexOf({column, row})];
      }
    }
  }
  EXPECT_TRUE(std::all_of(num_tiles.begin(), num_tiles.end(), [](int n) { return n == 1; }));
}

TEST_P(CutTilesTest, NoTileCouldTakeMoreOfWhatFollows) {
  const OccupancyGrid grid = MakeLayer();

  const std::vector<CellRectangle> tiles = CutTiles(grid, GetParam().max_bytes);

  for (const CellRectangle& tile : tiles) {
    CellRectangle more = tile;
    if (tile.width < GetParam().width) {
      ++more.width;  // A piece of a row, up to the row's end.
      if (more.column + more.width > GetParam().width) continue;
    } else {
      ++more.height;
      if (more.row + more.height > GetParam().height) continue;
    }
    EXPECT_GT(EncodedSize(CellsOf(grid, more)), GetParam().max_bytes);
  }
}

TEST_P(CutTilesTest, TheSameLayerIsCutTheSameWayInOrder) {
  const OccupancyGrid grid = MakeLayer();

  const std::vector<CellRectangle> tiles = CutTiles(grid, GetParam().max_bytes);

  EXPECT_EQ(tiles, CutTiles(grid, GetParam().max_bytes));
  EXPECT_TRUE(std::is_sorted(tiles.begin(), tiles.end(), [](const auto& a, const auto& b) {
    return std::pair(a.row, a.column) < std::pair(b.row, b.column);
  }));
}

INSTANTIATE_TEST_SUITE_P(Layers,
                         CutTilesTest,
                         testing::Values(CutCase{1, 1, 0.0, 2},
                                         CutCase{700, 9, 0.0, 2},
                                         CutCase{31, 40, 0.3, 2},
                                         CutCase{31, 40, 0.3, 25},
                                         CutCase{120, 90, 0.05, 60},
                                         CutCase{120, 90, 0.05, 61},
                                         CutCase{120, 90, 0.01, 1'200},
                                         CutCase{120, 90, 0.5, 1'000'000}));

// A layer in tiles as a server sends them.
std::vector<MapTile> MakeTiles(const OccupancyGrid& grid, const MapVersion& version) {
  std::vector<MapTile> tiles;
  for (const CellRectangle& rectangle : CutTiles(grid, 100)) {
    tiles.push_back({.version = version,
                     .geometry = grid.geometry,
                     .index = static_cast<int>(tiles.size()),
                     .count = 0,
                     .rectangle = rectangle,
                     .cells = CellsOf(grid, rectangle),
                     .map_checksum = Checksum(grid.cells)});
  }
  for (MapTile& tile : tiles) tile.count = static_cast<int>(tiles.size());
  return tiles;
}

class MapAssemblerTest : public testing::Test {
 protected:
  MapAssemblerTest() {
    std::mt19937 random(23);
    grid_ = MakeRandomGrid(60, 50, 0.1, 0.2, random);
    tiles_ = MakeTiles(grid_, {7, 3});
  }

  void AddAll(const std::vector<MapTile>& tiles) {
    for (const MapTile& tile : tiles) assembler_.Add(tile);
  }

  OccupancyGrid grid_;
  std::vector<MapTile> tiles_;
  MapAssembler assembler_;
};

TEST_F(MapAssemblerTest, PutsTheLayerTogetherInAnyOrderWithRepetitions) {
  std::mt19937 random(29);
  for (int run = 0; run < 20; ++run) {
    std::vector<MapTile> tiles = tiles_;
    tiles.insert(tiles.end(), tiles_.begin(), tiles_.begin() + 5);
    std::shuffle(tiles.begin(), tiles.end(), random);
    MapAssembler assembler;

    int num_duplicates = 0;
    for (const MapTile& tile : tiles) {
      EXPECT_EQ(assembler.Missing(1).empty(), assembler.IsComplete() || !assembler.version());
      if (assembler.Add(tile) == Outcome::kDuplicate) ++num_duplicates;
      EXPECT_FALSE(assembler.IsCorrupt());
    }

    EXPECT_TRUE(assembler.IsComplete());
    EXPECT_EQ(assembler.grid(), grid_);
    EXPECT_EQ(num_duplicates, 5);
  }
}

TEST_F(MapAssemblerTest, IsEmptyBeforeTheFirstTile) {
  EXPECT_FALSE(assembler_.version());
  EXPECT_FALSE(assembler_.IsComplete());
  EXPECT_FALSE(assembler_.IsCorrupt());
  EXPECT_FALSE(assembler_.Covers({0.0, 0.0}, {1.0, 1.0}));
  EXPECT_THAT(assembler_.Missing(10), IsEmpty());
  EXPECT_EQ(assembler_.count(), 0);
}

TEST_F(MapAssemblerTest, SaysWhatIsMissing) {
  for (const MapTile& tile : tiles_) {
    if (tile.index != 2 && tile.index != 4 && tile.index != 6) assembler_.Add(tile);
  }

  EXPECT_THAT(assembler_.Missing(10), ElementsAre(2, 4, 6));
  EXPECT_THAT(assembler_.Missing(2), ElementsAre(2, 4));
  EXPECT_FALSE(assembler_.IsComplete());
  EXPECT_FALSE(assembler_.IsCorrupt());
  EXPECT_EQ(assembler_.received(), assembler_.count() - 3);
}

TEST_F(MapAssemblerTest, CoversWhatHasComeAndOnlyThat) {
  assembler_.Add(tiles_[1]);
  const CellRectangle& there = tiles_[1].rectangle;
  const GridGeometry& geometry = grid_.geometry;
  const Eigen::Vector2d low = geometry.CenterOf({there.column, there.row});
  const Eigen::Vector2d high =
      geometry.CenterOf({there.column + there.width - 1, there.row + there.height - 1});

  EXPECT_TRUE(assembler_.Covers(low, high));
  EXPECT_FALSE(assembler_.Covers(low, high + Eigen::Vector2d(0.0, 0.05)));
  EXPECT_TRUE(assembler_.Covers({-9.0, -9.0}, {-8.0, -8.0}));  // Off the layer.
  EXPECT_FALSE(assembler_.Covers({std::nan(""), 0.0}, high));

  AddAll(tiles_);
  EXPECT_TRUE(assembler_.Covers({-9.0, -9.0}, {9.0, 9.0}));
}

TEST_F(MapAssemblerTest, CellsThatHaveNotComeAreUnknown) {
  assembler_.Add(tiles_[1]);

  const auto unknown =
      std::count(assembler_.grid().cells.begin(), assembler_.grid().cells.end(), 255);
  const auto unknown_in_tile = std::count(tiles_[1].cells.begin(), tiles_[1].cells.end(), 255);
  EXPECT_EQ(unknown,
            static_cast<std::int64_t>(grid_.cells.size()) - tiles_[1].rectangle.num_cells() +
                unknown_in_tile);
}

TEST_F(MapAssemblerTest, RefusesTilesThatBreakARule) {
  assembler_.Add(tiles_[0]);
  const auto outcome_with = [&](auto change) {
    MapTile tile = tiles_[1];
    change(tile);
    return assembler_.Add(tile);
  };
  constexpr int kMost = std::numeric_limits<int>::max();

  EXPECT_EQ(outcome_with([](MapTile& t) { t.version.epoch = 0; }), Outcome::kInvalid);
  EXPECT_EQ(outcome_with([](MapTile& t) { t.geometry.width = 0; }), Outcome::kInvalid);
  EXPECT_EQ(outcome_with([](MapTile& t) { t.geometry.resolution_m = -1.0; }), Outcome::kInvalid);
  EXPECT_EQ(outcome_with([](MapTile& t) { t.index = -1; }), Outcome::kInvalid);
  EXPECT_EQ(outcome_with([](MapTile& t) { t.index = t.count; }), Outcome::kInvalid);
  EXPECT_EQ(outcome_with([](MapTile& t) { t.count = 0; }), Outcome::kInvalid);
  EXPECT_EQ(outcome_with([](MapTile& t) { t.count = 3'001; }), Outcome::kInvalid);
  EXPECT_EQ(outcome_with([](MapTile& t) { t.cells.pop_back(); }), Outcome::kInvalid);
  EXPECT_EQ(outcome_with([](MapTile& t) { t.cells.push_back(0); }), Outcome::kInvalid);
  EXPECT_EQ(outcome_with([](MapTile& t) { t.rectangle.column = 1; }), Outcome::kInvalid);
  EXPECT_EQ(outcome_with([](MapTile& t) { t.rectangle.column = kMost; }), Outcome::kInvalid);
  EXPECT_EQ(outcome_with([](MapTile& t) { t.rectangle.row = 50; }), Outcome::kInvalid);
  EXPECT_EQ(outcome_with([](MapTile& t) { t.rectangle.row = -1; }), Outcome::kInvalid);
  EXPECT_EQ(outcome_with([](MapTile& t) { t.rectangle.height = kMost; }), Outcome::kInvalid);
  EXPECT_EQ(outcome_with([](MapTile& t) {
              t.rectangle = {};
              t.cells.clear();
            }),
            Outcome::kInvalid);
  EXPECT_EQ(outcome_with([](MapTile& t) {
              t.version.epoch = 99;  // A bad tile does not start another version.
              t.index = -1;
            }),
            Outcome::kInvalid);
  EXPECT_EQ(assembler_.received(), 1);
}

TEST_F(MapAssemblerTest, RefusesTilesThatContradictTheFirst) {
  assembler_.Add(tiles_[0]);
  MapTile other_count = tiles_[1];
  ++other_count.count;
  MapTile other_checksum = tiles_[1];
  ++other_checksum.map_checksum;
  MapTile other_geometry = tiles_[1];
  other_geometry.geometry.origin_x_m += 0.05;

  EXPECT_EQ(assembler_.Add(other_count), Outcome::kInconsistent);
  EXPECT_EQ(assembler_.Add(other_checksum), Outcome::kInconsistent);
  EXPECT_EQ(assembler_.Add(other_geometry), Outcome::kInconsistent);
  EXPECT_FALSE(assembler_.IsCorrupt());

  AddAll(tiles_);
  EXPECT_TRUE(assembler_.IsComplete());
}

TEST_F(MapAssemblerTest, NoticesTilesThatOverlap) {
  MapTile wrong = tiles_[1];  // Takes the place of tile 2, which can then never come.
  wrong.index = 2;
  assembler_.Add(tiles_[1]);

  EXPECT_EQ(assembler_.Add(wrong), Outcome::kInconsistent);

  EXPECT_TRUE(assembler_.IsCorrupt());
  EXPECT_EQ(assembler_.received(), 1);
}

TEST_F(MapAssemblerTest, NoticesTilesThatLeaveCellsOut) {
  MapTile& last = tiles_.back();
  ASSERT_EQ(last.rectangle.height, 1);
  --last.rectangle.width;
  last.cells.resize(static_cast<std::size_t>(last.rectangle.num_cells()));

  AddAll(tiles_);

  EXPECT_THAT(assembler_.Missing(1), IsEmpty());
  EXPECT_FALSE(assembler_.IsComplete());
  EXPECT_TRUE(assembler_.IsCorrupt());
}

TEST_F(MapAssemblerTest, DamagedCellsAreNoticedAndTheSameVersionMayComeAgain) {
  std::vector<MapTile> damaged = tiles_;
  damaged[3].cells[0] ^= 1U;
  AddAll(damaged);
  EXPECT_TRUE(assembler_.IsCorrupt());
  EXPECT_FALSE(assembler_.IsComplete());

  assembler_.Clear();
  EXPECT_FALSE(assembler_.IsCorrupt());
  EXPECT_FALSE(assembler_.version());
  EXPECT_EQ(assembler_.Add(tiles_[0]), Outcome::kNewVersion);
  AddAll(tiles_);

  EXPECT_TRUE(assembler_.IsComplete());
  EXPECT_EQ(assembler_.grid(), grid_);
}

TEST_F(MapAssemblerTest, AnotherVersionTakesOverAndLateTilesDoNotBringTheOldOneBack) {
  std::mt19937 random(31);
  const OccupancyGrid next = MakeRandomGrid(20, 20, 0.4, 0.0, random);
  const std::vector<MapTile> next_tiles = MakeTiles(next, {7, 4});
  assembler_.Add(tiles_[0]);

  EXPECT_EQ(assembler_.Add(next_tiles[0]), Outcome::kNewVersion);
  EXPECT_EQ(assembler_.Add(tiles_[1]), Outcome::kOldVersion);
  EXPECT_EQ(assembler_.version(), (MapVersion{7, 4}));
  AddAll(next_tiles);
  EXPECT_EQ(assembler_.grid(), next);

  assembler_.Clear();
  EXPECT_EQ(assembler_.Add(tiles_[1]), Outcome::kOldVersion);
  EXPECT_EQ(MapAssembler().Add(tiles_[1]), Outcome::kNewVersion);
}

TEST_F(MapAssemblerTest, AnEarlierEpochIsOldEvenWhenItWasNeverSeen) {
  assembler_.Add(tiles_[0]);
  MapTile earlier = tiles_[1];
  earlier.version.epoch = 2;

  EXPECT_EQ(assembler_.Add(earlier), Outcome::kOldVersion);
  assembler_.Clear();
  EXPECT_EQ(assembler_.Add(earlier), Outcome::kOldVersion);
  EXPECT_EQ(assembler_.Add(tiles_[1]), Outcome::kNewVersion);
}

TEST_F(MapAssemblerTest, AClearedVersionGivesWayToAnotherSessions) {
  AddAll(tiles_);
  assembler_.Clear();
  const std::vector<MapTile> restarted = MakeTiles(grid_, {-12, 1});

  EXPECT_EQ(assembler_.Add(restarted[0]), Outcome::kNewVersion);
  EXPECT_EQ(assembler_.Add(tiles_[1]), Outcome::kOldVersion);
}

TEST_F(MapAssemblerTest, AServerThatWasStartedAnewMayCountFromOne) {
  assembler_.Add(tiles_[0]);
  const std::vector<MapTile> restarted = MakeTiles(grid_, {-12, 1});

  EXPECT_EQ(assembler_.Add(restarted[0]), Outcome::kNewVersion);
  EXPECT_EQ(assembler_.Add(tiles_[1]), Outcome::kOldVersion);
  MapTile earlier = tiles_[1];
  earlier.version.epoch = 2;
  EXPECT_EQ(assembler_.Add(earlier), Outcome::kOldVersion);
  AddAll(restarted);

  EXPECT_TRUE(assembler_.IsComplete());
}

}  // namespace
}  // namespace clearway::core
