// SPDX-License-Identifier: BSD-3-Clause
#include <ctime>
#include <random>

#include <gtest/gtest.h>

#include "common/core/livox/data_packet.hpp"

namespace clearway::core::livox {
namespace {

constexpr std::int64_t kNsPerSecond = 1'000'000'000;

std::uint64_t Stamp(unsigned year, unsigned month, unsigned day, unsigned hour, std::uint64_t us) {
  return year | month << 8U | day << 16U | hour << 24U | us << 32U;
}

// Oracle: timegm() of the C library.
TEST(GpsTime, AgreesWithTheCalendarOfTheSystem) {
  std::mt19937_64 random(9);
  for (int i = 0; i < 20'000; ++i) {
    std::tm utc{};
    utc.tm_year = 100 + static_cast<int>(random() % 256);
    utc.tm_mon = static_cast<int>(random() % 12);
    utc.tm_mday = 1 + static_cast<int>(random() % 28);
    utc.tm_hour = static_cast<int>(random() % 24);
    const std::uint64_t us = random() % 3'600'000'000U;
    const auto stamp = Stamp(static_cast<unsigned>(utc.tm_year - 100),
                             static_cast<unsigned>(utc.tm_mon + 1),
                             static_cast<unsigned>(utc.tm_mday),
                             static_cast<unsigned>(utc.tm_hour),
                             us);

    const auto utc_ns = GpsUtcNs(stamp);

    ASSERT_TRUE(utc_ns);
    EXPECT_EQ(*utc_ns, timegm(&utc) * kNsPerSecond + static_cast<std::int64_t>(us) * 1000);
    EXPECT_EQ(ToGpsTimestamp(*utc_ns), stamp);
  }
}

TEST(GpsTime, LeapDaysAreDays) {
  EXPECT_TRUE(GpsUtcNs(Stamp(24, 2, 29, 0, 0)));
  EXPECT_TRUE(GpsUtcNs(Stamp(0, 2, 29, 0, 0)));
  EXPECT_FALSE(GpsUtcNs(Stamp(23, 2, 29, 0, 0)));
  EXPECT_FALSE(GpsUtcNs(Stamp(100, 2, 29, 0, 0)));
  EXPECT_EQ(*GpsUtcNs(Stamp(24, 3, 1, 0, 0)) - *GpsUtcNs(Stamp(24, 2, 29, 0, 0)),
            86'400 * kNsPerSecond);
}

TEST(GpsTime, AStampThatIsNoMomentIsNone) {
  EXPECT_FALSE(GpsUtcNs(0));
  EXPECT_FALSE(GpsUtcNs(~std::uint64_t{0}));
  EXPECT_FALSE(GpsUtcNs(Stamp(24, 0, 1, 0, 0)));
  EXPECT_FALSE(GpsUtcNs(Stamp(24, 13, 1, 0, 0)));
  EXPECT_FALSE(GpsUtcNs(Stamp(24, 1, 0, 0, 0)));
  EXPECT_FALSE(GpsUtcNs(Stamp(24, 4, 31, 0, 0)));
  EXPECT_FALSE(GpsUtcNs(Stamp(24, 1, 1, 24, 0)));
  EXPECT_FALSE(GpsUtcNs(Stamp(24, 1, 1, 0, 3'600'000'000)));
  EXPECT_TRUE(GpsUtcNs(Stamp(24, 1, 1, 23, 3'599'999'999)));
}

}  // namespace
}  // namespace clearway::core::livox
