// SPDX-License-Identifier: BSD-3-Clause
#include "common/core/mapping/run_length.hpp"

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <random>
#include <string_view>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace clearway::core {
namespace {

using Bytes = std::vector<std::uint8_t>;
using testing::ElementsAre;

// Runs of random lengths, many of them of several hundred cells.
Bytes MakeRuns(std::size_t size, std::mt19937& random) {
  std::uniform_int_distribution<int> length(1, 700);
  std::uniform_int_distribution<int> value(0, 3);
  Bytes cells;
  while (cells.size() < size) {
    const int run = length(random) % (value(random) == 0 ? 700 : 5);
    cells.insert(
        cells.end(),
        static_cast<std::size_t>(run),
        std::array<std::uint8_t, 4>{0, 100, 255, 50}[static_cast<std::size_t>(value(random))]);
  }
  cells.resize(size);
  return cells;
}

TEST(RunLength, DecodesWhatWasEncoded) {
  std::mt19937 random(5);
  for (const std::size_t size : {0U, 1U, 2U, 254U, 255U, 256U, 510U, 511U, 20'000U}) {
    const Bytes cells = MakeRuns(size, random);

    const Bytes bytes = EncodeRuns(cells);

    EXPECT_EQ(DecodeRuns(bytes, size), cells);
    EXPECT_EQ(EncodedSize(cells), bytes.size());
  }
}

TEST(RunLength, ARunHoldsAtMost255Cells) {
  EXPECT_THAT(EncodeRuns(Bytes(256, 7)), ElementsAre(255, 7, 1, 7));
  EXPECT_THAT(EncodeRuns(Bytes(255, 7)), ElementsAre(255, 7));
}

TEST(RunLength, RefusesBytesThatAreNotRunsOfTheNumberOfCells) {
  EXPECT_FALSE(DecodeRuns(Bytes{3}, 3));           // Half a pair.
  EXPECT_FALSE(DecodeRuns(Bytes{3, 1, 0, 2}, 3));  // A run of nothing.
  EXPECT_FALSE(DecodeRuns(Bytes{3, 1}, 2));        // Too many.
  EXPECT_FALSE(DecodeRuns(Bytes{3, 1}, 4));        // Too few.
  EXPECT_FALSE(DecodeRuns(Bytes{}, 1));
  EXPECT_FALSE(DecodeRuns(Bytes{1, 1}, std::numeric_limits<std::size_t>::max()));
  EXPECT_EQ(DecodeRuns(Bytes{}, 0), Bytes{});
}

TEST(RunLength, RandomBytesNeverGiveAnotherNumberOfCells) {
  std::mt19937 random(6);
  std::uniform_int_distribution<int> byte(0, 255);
  for (int run = 0; run < 500; ++run) {
    Bytes bytes(static_cast<std::size_t>(run % 12));
    for (std::uint8_t& b : bytes) b = static_cast<std::uint8_t>(byte(random));

    const auto cells = DecodeRuns(bytes, 300);

    EXPECT_TRUE(!cells || cells->size() == 300U);
  }
}

TEST(Checksum, IsTheOneOfZlib) {
  constexpr std::string_view kCheck = "123456789";  // The usual check value of CRC-32.

  EXPECT_EQ(Checksum(Bytes(kCheck.begin(), kCheck.end())), 0xCBF43926U);
  EXPECT_EQ(Checksum({}), 0U);
}

}  // namespace
}  // namespace clearway::core
