// SPDX-License-Identifier: BSD-3-Clause
#include "common/io/lzf.hpp"

#include <random>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/unit/io/pcd_maker.hpp"

namespace clearway::io {
namespace {

using test::CompressLzf;
using test::StoreLzf;
using testing::HasSubstr;

/// Bytes of few kinds, with repeats near and far.
std::string RandomBytes(std::mt19937& random, std::size_t size) {
  const unsigned kinds = 1 + static_cast<unsigned>(random() % 250);
  std::string bytes;
  while (bytes.size() < size) {
    if (!bytes.empty() && random() % 8 == 0) {
      const std::size_t start = random() % bytes.size();
      bytes += std::string(bytes, start, random() % 400);
    } else {
      bytes += static_cast<char>(random() % kinds);
    }
  }
  bytes.resize(size);
  return bytes;
}

TEST(Lzf, UnpacksWhatACompressorPacked) {
  std::mt19937 random(1);
  for (std::size_t size = 0; size < 400; ++size) {
    const std::string bytes = RandomBytes(random, size * size / 40);

    const LzfResult packed = DecompressLzf(CompressLzf(bytes), bytes.size());
    const LzfResult stored = DecompressLzf(StoreLzf(bytes), bytes.size());

    ASSERT_EQ(packed.problem, "") << size;
    ASSERT_EQ(packed.bytes, bytes) << size;
    ASSERT_EQ(stored.problem, "") << size;
    ASSERT_EQ(stored.bytes, bytes) << size;
  }
}

TEST(Lzf, UnpacksAtItsGreatestExpansion) {
  const std::string bytes(1 + 264 * 50, 'a');

  const std::string packed = CompressLzf(bytes);
  const LzfResult result = DecompressLzf(packed, bytes.size());

  EXPECT_EQ(result.bytes, bytes);
  EXPECT_LE(bytes.size(), packed.size() * kLzfMaxExpansion);
}

TEST(Lzf, RepeatsARangeThatOverlapsItself) {
  // "abc", then 7 bytes from 3 before the end.
  const std::string packed(
      "\x02"
      "abc"
      "\xa0\x02",
      6);

  const LzfResult result = DecompressLzf(packed, 10);

  EXPECT_EQ(result.problem, "");
  EXPECT_EQ(result.bytes, "abcabcabca");
}

TEST(Lzf, SaysWhatIsWrongAndWhere) {
  const LzfResult literal = DecompressLzf(std::string("\x05"
                                                      "ab",
                                                      3),
                                          6);
  const LzfResult reference = DecompressLzf(std::string("\x00"
                                                        "a"
                                                        "\x20",
                                                        3),
                                            4);
  const LzfResult long_reference = DecompressLzf(std::string("\x00"
                                                             "a"
                                                             "\xe0\x01",
                                                             4),
                                                 17);
  const LzfResult too_far = DecompressLzf(std::string("\x00"
                                                      "a"
                                                      "\x20\x01",
                                                      4),
                                          4);
  const LzfResult too_much = DecompressLzf(std::string("\x02"
                                                       "abc",
                                                       4),
                                           2);
  const LzfResult too_little = DecompressLzf(std::string("\x02"
                                                         "abc",
                                                         4),
                                             4);

  EXPECT_THAT(literal.problem, HasSubstr("literal run goes beyond the end"));
  EXPECT_THAT(reference.problem, HasSubstr("back reference goes beyond the end"));
  EXPECT_EQ(reference.offset, 2U);
  EXPECT_THAT(long_reference.problem, HasSubstr("back reference goes beyond the end"));
  EXPECT_THAT(too_far.problem, HasSubstr("points 2 bytes back, only 1 are unpacked"));
  EXPECT_THAT(too_much.problem, HasSubstr("more than the announced 2 bytes"));
  EXPECT_THAT(too_little.problem, HasSubstr("end after 3 of 4 bytes"));
}

TEST(Lzf, RefusesEachTruncation) {
  std::mt19937 random(2);
  const std::string bytes = RandomBytes(random, 700);
  const std::string packed = CompressLzf(bytes);

  for (std::size_t size = 0; size < packed.size(); ++size) {
    EXPECT_NE(DecompressLzf(packed.substr(0, size), bytes.size()).problem, "") << size;
  }
}

TEST(Lzf, SurvivesAnyBytes) {
  std::mt19937 random(3);
  for (int i = 0; i < 20000; ++i) {
    std::string bytes(random() % 60, '\0');
    for (char& byte : bytes) byte = static_cast<char>(random());

    const LzfResult result = DecompressLzf(bytes, random() % 500);

    EXPECT_LE(result.offset, bytes.size());
  }
}

}  // namespace
}  // namespace clearway::io
