// SPDX-License-Identifier: BSD-3-Clause
#include "common/io/map/map_writer.hpp"

#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <random>
#include <stdexcept>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "common/io/file_bytes.hpp"
#include "common/io/map/map_file.hpp"
#include "tests/support/test_folder.hpp"

namespace clearway::io {
namespace {

using core::OccupancyGrid;
using test::TestFolder;
using testing::HasSubstr;
using testing::StartsWith;

OccupancyGrid RandomGrid(std::mt19937& random) {
  std::uniform_real_distribution<double> number(-100.0, 100.0);
  OccupancyGrid grid;
  grid.geometry = {.width = 1 + static_cast<int>(random() % 20),
                   .height = 1 + static_cast<int>(random() % 20),
                   .resolution_m = std::abs(number(random)) + 1e-3,
                   .origin_x_m = number(random),
                   .origin_y_m = number(random),
                   .origin_yaw_rad = number(random) / 30.0};
  for (std::size_t i = 0; i < grid.geometry.num_cells(); ++i) {
    const bool is_unknown = random() % 4 == 0;
    grid.cells.push_back(is_unknown ? OccupancyGrid::kUnknown
                                    : static_cast<std::uint8_t>(random() % 101));
  }
  return grid;
}

std::uint8_t TrinaryOf(std::uint8_t cell) {
  if (cell == OccupancyGrid::kUnknown) return OccupancyGrid::kUnknown;
  if (cell >= 65) return OccupancyGrid::kOccupied;
  return cell <= 19 ? OccupancyGrid::kFree : OccupancyGrid::kUnknown;
}

std::size_t FilesIn(const std::filesystem::path& folder) {
  const std::filesystem::directory_iterator begin(folder);
  return static_cast<std::size_t>(std::distance(begin, std::filesystem::directory_iterator()));
}

TEST(MapWriter, WhatIsSavedIsLoaded) {
  const TestFolder folder;
  for (unsigned seed = 0; seed < 100; ++seed) {
    std::mt19937 random(seed);
    const OccupancyGrid grid = RandomGrid(random);
    OccupancyGrid expected = grid;
    std::transform(grid.cells.begin(), grid.cells.end(), expected.cells.begin(), TrinaryOf);

    SaveMap(grid, folder.path() / "room.yaml");
    const OccupancyGrid loaded = LoadMap(folder.path() / "room.yaml").grid;

    ASSERT_EQ(loaded, expected) << "seed " << seed;
    ASSERT_EQ(FilesIn(folder.path()), 2U);
  }
}

TEST(MapWriter, WritesTheFilesThatMapSaverWrites) {
  const TestFolder folder;
  OccupancyGrid grid;
  grid.geometry = {
      .width = 3, .height = 2, .resolution_m = 0.05, .origin_x_m = -1.5, .origin_y_m = 0.1};
  grid.cells = {0, 100, 255, 64, 19, 65};

  SaveMap(grid, folder.path() / "room.yaml");

  EXPECT_EQ(ReadFileBytes(folder.path() / "room.yaml"),
            "image: room.pgm\n"
            "mode: trinary\n"
            "resolution: 0.05\n"
            "origin: [-1.5, 0.1, 0]\n"
            "negate: 0\n"
            "occupied_thresh: 0.65\n"
            "free_thresh: 0.196\n");
  const std::string pixels = {'\xcd', '\xfe', '\0', '\xfe', '\0', '\xcd'};
  EXPECT_EQ(ReadFileBytes(folder.path() / "room.pgm"), "P5\n3 2\n255\n" + pixels);
}

TEST(MapWriter, NamesThatYamlWouldReadAsSomethingElseAreQuoted) {
  const TestFolder folder;
  std::mt19937 random(3);
  const OccupancyGrid grid = RandomGrid(random);
  for (const char* name : {"a b",
                           "- a",
                           "a # b",
                           "a: b",
                           "'a'",
                           "\"a\"",
                           "true",
                           "~",
                           "[a]",
                           "\xc3\xa4",
                           "a.b",
                           "1e5",
                           "!a",
                           "&a",
                           "*a",
                           "%a",
                           "@",
                           "a\\n"}) {
    const std::filesystem::path yaml = folder.path() / (std::string(name) + ".yaml");

    SaveMap(grid, yaml);

    EXPECT_EQ(LoadMap(yaml).grid.geometry, grid.geometry) << name;
  }
}

TEST(MapWriter, RefusesANameThatYamlCannotHold) {
  const TestFolder folder;
  std::mt19937 random(3);
  const OccupancyGrid grid = RandomGrid(random);

  EXPECT_THROW(SaveMap(grid, folder.path() / "a\nb.yaml"), std::runtime_error);
  EXPECT_EQ(FilesIn(folder.path()), 0U);
}

TEST(MapWriter, NamesTheFileAndTheReasonWhenItCannotWrite) {
  const TestFolder folder;
  std::mt19937 random(3);
  const OccupancyGrid grid = RandomGrid(random);
  const auto message = [&](const std::filesystem::path& yaml) -> std::string {
    try {
      SaveMap(grid, yaml);
    } catch (const std::runtime_error& error) {
      return error.what();
    }
    return {};
  };

  EXPECT_EQ(message(folder.path() / "none" / "a.yaml"),
            (folder.path() / "none" / "a.pgm").string() +
                ": cannot be written: No such file or directory");
  std::filesystem::create_directories(folder.path() / "b.pgm" / "full");
  EXPECT_EQ(message(folder.path() / "b.yaml"),
            (folder.path() / "b.pgm").string() + ": cannot be put in place: Is a directory");
  EXPECT_EQ(FilesIn(folder.path()), 1U) << "a temporary file was left";
}

TEST(MapWriter, RefusesAGridThatIsNone) {
  const TestFolder folder;
  std::mt19937 random(3);
  OccupancyGrid grid = RandomGrid(random);
  EXPECT_THROW(SaveMap(OccupancyGrid{}, folder.path() / "a.yaml"), std::invalid_argument);
  EXPECT_THROW(SaveMap(grid, folder.path() / "a.pgm"), std::invalid_argument);
  grid.cells.pop_back();
  EXPECT_THROW(SaveMap(grid, folder.path() / "a.yaml"), std::invalid_argument);
  EXPECT_EQ(FilesIn(folder.path()), 0U);
}

}  // namespace
}  // namespace clearway::io
