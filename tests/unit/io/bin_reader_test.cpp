// SPDX-License-Identifier: BSD-3-Clause
#include "common/io/bin_reader.hpp"

#include <cmath>
#include <cstring>
#include <limits>
#include <stdexcept>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace clearway::io {
namespace {

using testing::ElementsAre;
using testing::ThrowsMessage;

std::string Bytes(const std::vector<float>& floats) {
  std::string bytes(floats.size() * sizeof(float), '\0');
  std::memcpy(bytes.data(), floats.data(), bytes.size());
  return bytes;
}

TEST(BinReader, ReadsThreeFloatsAPoint) {
  const core::PointCloud cloud =
      ParseBin(Bytes({1, 2, 3, 4, 5, 6}), "scan.bin", {.floats_per_point = 3});

  EXPECT_THAT(cloud.x, ElementsAre(1.0F, 4.0F));
  EXPECT_THAT(cloud.y, ElementsAre(2.0F, 5.0F));
  EXPECT_THAT(cloud.z, ElementsAre(3.0F, 6.0F));
  EXPECT_THAT(cloud.intensity, ElementsAre(0, 0));
}

TEST(BinReader, ReadsFourFloatsAPointAndScalesTheIntensity) {
  const float nan = std::numeric_limits<float>::quiet_NaN();
  const core::PointCloud cloud =
      ParseBin(Bytes({1, 2, 3, 0.5F, 4, 5, 6, 2, nan, 8, 9, -1, 1, 1, 1, nan}),
               "scan.bin",
               {.floats_per_point = 4, .intensity_scale = 255.0});

  ASSERT_EQ(cloud.size(), 4U);
  EXPECT_TRUE(std::isnan(cloud.x[2]));
  EXPECT_THAT(cloud.intensity, ElementsAre(128, 255, 0, 0));
  EXPECT_EQ(cloud.tag.size(), 4U);
  EXPECT_EQ(cloud.time_offset_us.size(), 4U);
}

TEST(BinReader, RefusesEachSizeThatHoldsNoWholePoints) {
  for (const int floats : {3, 4}) {
    const auto point_bytes = static_cast<std::size_t>(floats) * 4;
    for (std::size_t size = 1; size < 50; ++size) {
      const std::string bytes(size, '\0');
      if (size % point_bytes == 0) {
        EXPECT_EQ(ParseBin(bytes, "scan.bin", {.floats_per_point = floats}).size(),
                  size / point_bytes);
      } else {
        EXPECT_THROW((void)ParseBin(bytes, "scan.bin", {.floats_per_point = floats}), ReadError);
      }
    }
  }
}

TEST(BinReader, NamesTheSizesItRefuses) {
  EXPECT_THAT([] { (void)ParseBin(std::string(24, '\0'), "scan.bin", {.floats_per_point = 4}); },
              ThrowsMessage<ReadError>(
                  "scan.bin: has 24 bytes, which is no multiple of 16 (4 floats a point): it is "
                  "cut short, or floats_per_point is wrong"));
  EXPECT_THAT([] { (void)ParseBin("", "scan.bin", {}); },
              ThrowsMessage<ReadError>("scan.bin: is empty (0 bytes)"));
}

TEST(BinReader, RefusesAnyOtherLayout) {
  EXPECT_THROW((void)ParseBin(std::string(20, '\0'), "scan.bin", {.floats_per_point = 5}),
               std::invalid_argument);
}

}  // namespace
}  // namespace clearway::io
