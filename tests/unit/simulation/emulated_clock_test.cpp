// SPDX-License-Identifier: BSD-3-Clause
#include "common/core/simulation/emulated_clock.hpp"

#include <cstdint>

#include <gmock/gmock.h>

namespace clearway::core {
namespace {

using livox::TimestampType;

constexpr std::int64_t kHour_us = 3'600'000'000;

class EmulatedClockDriftTest : public testing::TestWithParam<double> {};

TEST_P(EmulatedClockDriftTest, RunsOffByItsDriftAndBack) {
  EmulatedClock clock(GetParam(), 0);
  clock.Restart(1'000'000);

  for (const std::int64_t elapsed_us : {std::int64_t{0}, std::int64_t{960}, kHour_us}) {
    const std::int64_t oscillator_ns = clock.OscillatorNs(1'000'000 + elapsed_us);

    const double expected_ns = static_cast<double>(elapsed_us) * (1000.0 + GetParam() * 1e-3);
    EXPECT_NEAR(static_cast<double>(oscillator_ns), expected_ns, 1.0);
    EXPECT_NEAR(static_cast<double>(clock.TrueUs(oscillator_ns)),
                static_cast<double>(1'000'000 + elapsed_us),
                1.0);
  }
}

INSTANTIATE_TEST_SUITE_P(Drifts,
                         EmulatedClockDriftTest,
                         testing::Values(-500.0, -50.0, 0.0, 50.0, 500.0));

TEST(EmulatedClockTest, ItsOwnStampsCountFromPowerOnAndStep) {
  EmulatedClock clock(0.0, 100'000'000);
  const auto stamp = [&clock] { return clock.StampAt(1000, {}, 0).timestamp; };

  EXPECT_EQ(stamp(), 100'000'001'000U);
  clock.Step(-50'000'000);
  EXPECT_EQ(stamp(), 50'000'001'000U);
  clock.Step(-60'000'000);
  EXPECT_EQ(stamp(), 0U) << "never before 0";
  clock.Restart(5'000'000);
  EXPECT_EQ(stamp(), 1000U) << "power off forgets steps and what it was on before";
}

TEST(EmulatedClockTest, AResetBeginsTheStampsAnewAndNotTheShots) {
  EmulatedClock clock(0.0, 100'000'000);

  clock.ResetStamps(2'000'000);

  EXPECT_EQ(clock.OscillatorNs(2'000'000), 2'000'000'000);
  EXPECT_EQ(clock.StampAt(2'000'500'000, {}, 0).timestamp, 500'000U);
}

TEST(EmulatedClockTest, PtpAndGpsStampsAreTheTimeOfDayWithTheSourcesError) {
  EmulatedClock clock(50.0, 100'000'000);
  const std::int64_t utime_minus_true_us = 1'700'000'000'000'000;
  const std::int64_t true_us = kHour_us;
  const std::int64_t oscillator_ns = clock.OscillatorNs(true_us);
  const std::int64_t expected_ns = (utime_minus_true_us + true_us - 250) * 1000;

  const auto ptp = clock.StampAt(oscillator_ns, {TimestampType::kPtp, -250}, utime_minus_true_us);
  const auto gps = clock.StampAt(oscillator_ns, {TimestampType::kGps, -250}, utime_minus_true_us);

  EXPECT_EQ(ptp.type, TimestampType::kPtp);
  EXPECT_NEAR(static_cast<double>(static_cast<std::int64_t>(ptp.timestamp) - expected_ns), 0, 2);
  EXPECT_EQ(gps.type, TimestampType::kGps);
  EXPECT_NEAR(
      static_cast<double>(livox::GpsUtcNs(gps.timestamp).value_or(0) - expected_ns), 0, 1001);
}

TEST(EmulatedClockTest, PpsStampsWrapEachSecondUntilAHostTellsTheTime) {
  EmulatedClock clock(0.0, 0);
  const EmulatedTimeSync pps{TimestampType::kPps, 0};

  const auto alone = clock.StampAt(1'250'000'000, pps, 7'000'000);
  clock.SetUtc(1'700'000'000'000'000'000, 1'000'000);
  const auto told = clock.StampAt(1'250'000'000, pps, 7'000'000);

  EXPECT_EQ(alone.type, TimestampType::kPps);
  EXPECT_EQ(alone.timestamp, 250'000'000U);
  EXPECT_EQ(told.type, TimestampType::kGps);
  EXPECT_EQ(livox::GpsUtcNs(told.timestamp), 1'700'000'000'250'000'000);
}

TEST(EmulatedClockTest, AGpsStampIsNeverOlderThanGpsStampsCanBe) {
  const EmulatedClock clock(0.0, 0);

  const auto stamp = clock.StampAt(0, {TimestampType::kGps, 0}, 0);

  EXPECT_EQ(livox::GpsUtcNs(stamp.timestamp), 946'684'800'000'000'000);
}

}  // namespace
}  // namespace clearway::core
