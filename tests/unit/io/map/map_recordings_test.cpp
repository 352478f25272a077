// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <array>
#include <cctype>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <map>
#include <sstream>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <png.h>

#include "common/io/file_bytes.hpp"
#include "common/io/map/map_file.hpp"
#include "tests/support/test_data.hpp"
#include "tests/support/test_folder.hpp"
#include "tests/unit/io/map/refusal.hpp"

namespace clearway::io {
namespace {

using test::IsOneLine;
using test::RefusalOf;
using test::TestData;
using testing::HasSubstr;
using testing::StartsWith;

// An image, read in another way than the reader under test does. Shades 0..1.
struct Reference {
  int width = 0;
  int height = 0;
  std::vector<double> shades;
};

Reference ReadReferencePng(const std::string& bytes) {
  png_image png{};
  png.version = PNG_IMAGE_VERSION;
  png_image_begin_read_from_memory(&png, bytes.data(), bytes.size());
  png.format = PNG_FORMAT_RGB;
  std::vector<std::uint8_t> rgb(PNG_IMAGE_SIZE(png));
  EXPECT_NE(png_image_finish_read(&png, nullptr, rgb.data(), 0, nullptr), 0) << png.message;
  Reference image{static_cast<int>(png.width), static_cast<int>(png.height), {}};
  for (std::size_t i = 0; i < rgb.size(); i += 3) {
    image.shades.push_back((rgb[i] + rgb[i + 1] + rgb[i + 2]) / 765.0);
  }
  return image;
}

// As the maps at hand have them: 8 bits, comments on lines of their own.
Reference ReadReferencePgm(const std::string& bytes) {
  std::string text = bytes;
  for (std::size_t at = text.find("\n#"); at < 200; at = text.find("\n#", at)) {
    text.erase(at, text.find('\n', at + 1) - at);
  }
  std::istringstream stream(text);
  std::string magic;
  int maxval = 0;
  Reference image;
  stream >> magic >> image.width >> image.height >> maxval;
  stream.get();
  for (int i = 0; i < image.width * image.height; ++i) {
    int value = 0;
    if (magic == "P5") {
      value = stream.get();
    } else {
      stream >> value;
    }
    image.shades.push_back(static_cast<double>(value) / maxval);
  }
  EXPECT_TRUE(stream);
  return image;
}

// Counts of free, occupied, unknown and other cells.
using Counts = std::array<std::size_t, 4>;

std::size_t KindOf(int cell) {
  return cell == 0 ? 0 : cell == 100 ? 1 : cell == 255 ? 2 : 3;
}

Counts CountsOf(const core::OccupancyGrid& grid) {
  Counts counts{};
  for (const std::uint8_t cell : grid.cells) ++counts[KindOf(cell)];
  return counts;
}

Counts CountsOf(const Reference& image, const MapDescription& map) {
  Counts counts{};
  for (const double shade : image.shades) {
    const double occupancy = map.negate ? shade : 1.0 - shade;
    int cell = 255;
    if (occupancy > map.occupied_threshold) {
      cell = 100;
    } else if (occupancy < map.free_threshold) {
      cell = 0;
    } else if (map.mode == MapMode::kScale) {
      cell = static_cast<int>(std::rint((occupancy - map.free_threshold) /
                                        (map.occupied_threshold - map.free_threshold) * 100.0));
    }
    ++counts[KindOf(cell)];
  }
  return counts;
}

bool NamesAMissingImage(const std::filesystem::path& yaml) {
  const std::string name = yaml.parent_path().filename() / yaml.filename();
  return name == "f1tenth_ascii/porto.yaml" ||
         name == "nav2_empty_room_brokenref/empty_room.yaml" ||
         name == "nav2_map_server_test/invalid_image.yaml";
}

std::vector<std::filesystem::path> AllYamlFiles(const std::filesystem::path& folder) {
  std::vector<std::filesystem::path> files;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(folder)) {
    if (entry.path().extension() == ".yaml") files.push_back(entry.path());
  }
  std::sort(files.begin(), files.end());
  return files;
}

TEST(MapRecordings, EveryMapLoadsWithTheCellsThatAnotherReaderFinds) {
  const auto folder = TestData("maps");
  if (!folder) GTEST_SKIP() << test::MissingData("maps");
  std::size_t loaded = 0;
  for (const std::filesystem::path& yaml : AllYamlFiles(*folder)) {
    if (NamesAMissingImage(yaml)) continue;
    SCOPED_TRACE(yaml.string());

    const LoadedMap map = LoadMap(yaml);

    const std::string bytes = ReadFileBytes(map.image_path);
    const Reference image =
        map.image_path.extension() == ".png" ? ReadReferencePng(bytes) : ReadReferencePgm(bytes);
    EXPECT_EQ(map.grid.geometry.width, image.width);
    EXPECT_EQ(map.grid.geometry.height, image.height);
    EXPECT_TRUE(map.grid.geometry.IsValid());
    EXPECT_EQ(CountsOf(map.grid), CountsOf(image, map.description));
    ++loaded;
  }
  EXPECT_GT(loaded, 0U);
}

TEST(MapRecordings, MapsWithoutTheirImageAreRefusedInOneLine) {
  const auto folder = TestData("maps");
  if (!folder) GTEST_SKIP() << test::MissingData("maps");
  std::size_t refused = 0;
  for (const std::filesystem::path& yaml : AllYamlFiles(*folder)) {
    if (!NamesAMissingImage(yaml)) continue;

    const std::string message = RefusalOf([&] { return LoadMap(yaml); });

    EXPECT_TRUE(IsOneLine(message));
    EXPECT_THAT(message, StartsWith(yaml.string() + ":1: image \""));
    EXPECT_THAT(message, HasSubstr(": no such file"));
    ++refused;
  }
  EXPECT_EQ(refused, 3U);
}

TEST(MapRecordings, TheTestMapHasTheSameCellsAsPgmAndAsPngInAllModes) {
  const auto folder = TestData("maps/nav2_map_server_test");
  if (!folder) GTEST_SKIP() << test::MissingData("maps/nav2_map_server_test");
  const test::TestFolder own;
  for (const std::string mode : {"trinary", "scale", "raw"}) {
    for (const std::string negate : {"0", "1"}) {
      std::map<std::string, core::OccupancyGrid> grids;
      for (const std::string ending : {".pgm", ".png"}) {
        const auto yaml =
            own.Write("m.yaml",
                      "image: " + (*folder / ("testmap" + ending)).string() +
                          "\nresolution: 0.1\norigin: [2.0, 3.0, 1.0]\nnegate: " + negate +
                          "\noccupied_thresh: 0.65\nfree_thresh: 0.196\nmode: " + mode + "\n");
        grids[ending] = LoadMap(yaml).grid;
      }
      EXPECT_EQ(grids[".pgm"], grids[".png"]) << mode << ", negate " << negate;
      EXPECT_EQ(grids[".pgm"].cells.size(), 100U);
    }
  }
}

TEST(MapRecordings, TheTestMapAsBmpIsRefusedInOneLine) {
  const auto image = TestData("maps/nav2_map_server_test/testmap.bmp");
  if (!image) GTEST_SKIP() << test::MissingData("maps/nav2_map_server_test/testmap.bmp");

  EXPECT_EQ(RefusalOf([&] { return ParseMapImage(ReadFileBytes(*image), "testmap.bmp"); }),
            "testmap.bmp: is a BMP image; allowed are PGM (P2, P5) and PNG");
}

}  // namespace
}  // namespace clearway::io
