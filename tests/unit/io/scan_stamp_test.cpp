// SPDX-License-Identifier: BSD-3-Clause
#include "common/io/scan_stamp.hpp"

#include <cstdint>
#include <optional>
#include <random>
#include <string>

#include <gtest/gtest.h>

namespace clearway::io {
namespace {

TEST(ScanStamp, ReadsSecondsToTheMicrosecond) {
  EXPECT_EQ(ParseScanStamp("1744500470.786466599"), 1744500470786466);
  EXPECT_EQ(ParseScanStamp("1744500470.5"), 1744500470500000);
  EXPECT_EQ(ParseScanStamp("1744500470.000001"), 1744500470000001);
  EXPECT_EQ(ParseScanStamp("0.0"), 0);
  EXPECT_EQ(ParseScanStamp("999999999999.999999999999999999"), 999999999999999999);
}

TEST(ScanStamp, ReadsWholeNanosecondsAndMicroseconds) {
  EXPECT_EQ(ParseScanStamp("1744500470786466599"), 1744500470786466);
  EXPECT_EQ(ParseScanStamp("315966265259836000"), 315966265259836);
  EXPECT_EQ(ParseScanStamp("9999999999999999999"), 9999999999999999);
  EXPECT_EQ(ParseScanStamp("1744500470786466"), 1744500470786466);
  EXPECT_EQ(ParseScanStamp("17445004707864"), 17445004707864);
}

TEST(ScanStamp, ReadsWhatFollowsTheLastUnderscore) {
  EXPECT_EQ(ParseScanStamp("vlp16_1673400472138016708"), 1673400472138016);
  EXPECT_EQ(ParseScanStamp("front_left_1744500470.25"), 1744500470250000);
}

TEST(ScanStamp, TakesNothingElseForAStamp) {
  for (const char* name : {"",
                           "000000",
                           "0000000000",
                           "1539765924",
                           "1744500470786",
                           "12345678901234567890",
                           "1744500470.",
                           ".5",
                           "1.2.3",
                           "-1.5",
                           "+1.5",
                           "1.5e3",
                           "1,5",
                           "0x1.8",
                           "1234567890123.5",
                           "1.1234567890123456789",
                           "1744500470.786466599_",
                           "1744500470.786466599_cloud",
                           "1744500470 .5",
                           "scan.0001"}) {
    EXPECT_EQ(ParseScanStamp(name), std::nullopt) << name;
  }
}

TEST(ScanStamp, IsExactForAnyTime) {
  std::mt19937_64 random(5);
  for (int i = 0; i < 10000; ++i) {
    const auto seconds = static_cast<std::int64_t>(random() % 100'000'000'000);
    const auto nanoseconds = static_cast<std::int64_t>(random() % 1'000'000'000);
    std::string fraction = std::to_string(nanoseconds);
    fraction.insert(0, 9 - fraction.size(), '0');

    const auto stamp = ParseScanStamp(std::to_string(seconds) + "." + fraction);

    ASSERT_EQ(stamp, seconds * 1'000'000 + nanoseconds / 1000);
  }
}

}  // namespace
}  // namespace clearway::io
