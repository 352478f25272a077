// SPDX-License-Identifier: BSD-3-Clause
#include <bit>
#include <cstdint>
#include <filesystem>
#include <limits>
#include <random>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "common/io/pcd_reader.hpp"
#include "common/io/pcd_writer.hpp"
#include "tests/unit/io/pcd_maker.hpp"

namespace clearway::io {
namespace {

class RandomPcdTest : public testing::TestWithParam<unsigned> {};

TEST_P(RandomPcdTest, ReadsTheSameCloudFromEachEncoding) {
  for (unsigned i = 0; i < 100; ++i) {
    const test::PcdTriple triple = test::MakeRandomPcd(GetParam() * 100 + i);
    for (const std::string* bytes : {&triple.ascii, &triple.binary, &triple.compressed}) {
      const core::PointCloud cloud = ParsePcd(*bytes, "random.pcd").cloud;

      ASSERT_EQ(cloud.x, triple.x) << *bytes;
      ASSERT_EQ(cloud.y, triple.y) << *bytes;
      ASSERT_EQ(cloud.z, triple.z) << *bytes;
      ASSERT_EQ(cloud.intensity, triple.intensity) << *bytes;
      ASSERT_EQ(cloud.tag.size(), triple.num_points);
      ASSERT_EQ(cloud.time_offset_us.size(), triple.num_points);
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Seeds, RandomPcdTest, testing::Range(0U, 5U));

TEST(PcdWriter, GivesBackEachBit) {
  std::mt19937 random(7);
  core::PointCloud cloud;
  for (int i = 0; i < 5000; ++i) {
    // All bit patterns, NaNs with payloads and denormal numbers among them. A signalling NaN may
    // become a quiet one when it is converted, so the quiet bit is set.
    const auto number = [&] {
      const auto bits = static_cast<std::uint32_t>(random());
      const bool is_special = (bits & 0x7f800000U) == 0x7f800000U;
      return std::bit_cast<float>(is_special ? bits | 0x00400000U : bits);
    };
    const float x = number();
    const float y = number();
    cloud.Add({x, y, number()}, static_cast<std::uint8_t>(random()));
  }
  const auto path = std::filesystem::path(testing::TempDir()) / "clearway_each_bit.pcd";

  WritePcdBinary(path, cloud);
  const PcdFile file = ReadPcd(path);
  std::filesystem::remove(path);

  ASSERT_EQ(file.cloud.size(), cloud.size());
  EXPECT_EQ(file.cloud.intensity, cloud.intensity);
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    for (const auto axis : {&core::PointCloud::x, &core::PointCloud::y, &core::PointCloud::z}) {
      ASSERT_EQ(std::bit_cast<std::uint32_t>((file.cloud.*axis)[i]),
                std::bit_cast<std::uint32_t>((cloud.*axis)[i]));
    }
  }
}

TEST(PcdWriter, WritesAnEmptyCloud) {
  const auto path = std::filesystem::path(testing::TempDir()) / "clearway_empty.pcd";

  WritePcdBinary(path, {});
  const PcdFile file = ReadPcd(path);
  std::filesystem::remove(path);

  EXPECT_TRUE(file.cloud.empty());
}

TEST(PcdWriter, SaysWhyAFileCannotBeWritten) {
  const auto write = [] { WritePcdBinary("/no/such/folder/scan.pcd", {}); };

  EXPECT_THAT(write,
              testing::ThrowsMessage<std::runtime_error>(
                  "/no/such/folder/scan.pcd: cannot be written: No such file or directory"));
}

}  // namespace
}  // namespace clearway::io
