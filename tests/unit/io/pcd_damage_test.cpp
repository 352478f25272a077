// SPDX-License-Identifier: BSD-3-Clause
#include <optional>
#include <random>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "common/io/pcd_reader.hpp"
#include "tests/unit/io/pcd_maker.hpp"

namespace clearway::io {
namespace {

/// The message of the refusal, or nothing when the file is read.
std::optional<std::string> Refusal(const std::string& bytes) {
  try {
    const core::PointCloud cloud = ParsePcd(bytes, "damaged.pcd").cloud;
    EXPECT_EQ(cloud.y.size(), cloud.size());
    EXPECT_EQ(cloud.z.size(), cloud.size());
    EXPECT_EQ(cloud.intensity.size(), cloud.size());
    EXPECT_EQ(cloud.tag.size(), cloud.size());
    EXPECT_EQ(cloud.time_offset_us.size(), cloud.size());
    return std::nullopt;
  } catch (const ReadError& error) {
    return error.what();
  }
}

void ExpectOneClearLine(const std::string& message) {
  EXPECT_THAT(message, testing::StartsWith("damaged.pcd:"));
  EXPECT_EQ(message.find_first_of("\n\r\t"), std::string::npos) << message;
}

class PcdDamageTest : public testing::TestWithParam<unsigned> {
 protected:
  const test::PcdTriple triple_ = test::MakeRandomPcd(GetParam());
};

TEST_P(PcdDamageTest, RefusesEachTruncationOfABinaryFile) {
  for (const std::string* bytes : {&triple_.binary, &triple_.compressed}) {
    // The line end after DATA is not missed when no point follows.
    const std::size_t least_whole = triple_.num_points == 0 ? bytes->size() - 9 : bytes->size();
    for (std::size_t size = 0; size < least_whole; ++size) {
      const auto refusal = Refusal(bytes->substr(0, size));

      ASSERT_TRUE(refusal) << "read after " << size << " of " << bytes->size() << " bytes";
      ExpectOneClearLine(*refusal);
    }
  }
}

TEST_P(PcdDamageTest, RefusesEachTruncationOfAnAsciiFileBeforeItsLastNumber) {
  const std::string& bytes = triple_.ascii;
  const std::size_t end = bytes.find_last_not_of(" \n");
  const std::size_t last_number = bytes.find_last_of(" \n", end) + 1;
  for (std::size_t size = 0; size < last_number; ++size) {
    const auto refusal = Refusal(bytes.substr(0, size));

    ASSERT_TRUE(refusal) << "read after " << size << " of " << bytes.size() << " bytes";
    ExpectOneClearLine(*refusal);
  }
}

TEST_P(PcdDamageTest, SurvivesEachFlippedBit) {
  for (const std::string* bytes : {&triple_.ascii, &triple_.binary, &triple_.compressed}) {
    for (std::size_t i = 0; i < bytes->size() * 8; ++i) {
      std::string damaged = *bytes;
      damaged[i / 8] = static_cast<char>(damaged[i / 8] ^ (1 << (i % 8)));

      if (const auto refusal = Refusal(damaged)) ExpectOneClearLine(*refusal);
    }
  }
}

TEST_P(PcdDamageTest, SurvivesManyChangesAtOnce) {
  std::mt19937 random(GetParam());
  for (int i = 0; i < 2000; ++i) {
    const std::string* files[] = {&triple_.ascii, &triple_.binary, &triple_.compressed};
    std::string damaged = *files[random() % 3];
    for (std::size_t changes = 1 + random() % 6; changes > 0 && !damaged.empty(); --changes) {
      const std::size_t at = random() % damaged.size();
      switch (random() % 4) {
        case 0:
          damaged[at] = static_cast<char>(random());
          break;
        case 1:
          damaged.erase(at, random() % 9);
          break;
        case 2:
          damaged.insert(at, std::string(damaged, random() % damaged.size(), random() % 30));
          break;
        default:
          damaged[at] = static_cast<char>('0' + random() % 10);
      }
    }

    if (const auto refusal = Refusal(damaged)) ExpectOneClearLine(*refusal);
  }
}

INSTANTIATE_TEST_SUITE_P(Seeds, PcdDamageTest, testing::Values(11U, 12U, 13U, 14U, 15U, 16U));

}  // namespace
}  // namespace clearway::io
