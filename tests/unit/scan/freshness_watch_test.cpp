// SPDX-License-Identifier: BSD-3-Clause
#include "common/core/scan/freshness_watch.hpp"

#include <cstdint>
#include <limits>
#include <random>

#include <gtest/gtest.h>

namespace clearway::core {
namespace {

constexpr std::int64_t kPeriod_us = 10'000;
constexpr std::int64_t kOffset_us = 1'600'000'000'000'000;  // Sender's clock minus receiver's.

// Sends a healthy stream from `from` to `to` with the given delay.
void Send(FreshnessWatch& watch, std::int64_t from, std::int64_t to, std::int64_t delay_us) {
  for (std::int64_t t = from; t < to; t += kPeriod_us) {
    watch.OnArrival(t + delay_us, t + kOffset_us);
  }
}

TEST(FreshnessWatch, KnowsNothingBeforeTheFirstArrival) {
  const FreshnessWatch watch;

  EXPECT_FALSE(watch.Query(123).has_arrived);
}

TEST(FreshnessWatch, MeasuresTheTimeSinceTheLastArrival) {
  FreshnessWatch watch;
  Send(watch, 0, 1'000'000, 5000);

  EXPECT_EQ(watch.Query(995'000).age_us, 0);
  EXPECT_EQ(watch.Query(1'295'000).age_us, 300'000);
  EXPECT_EQ(watch.Query(0).age_us, 0) << "a clock that goes back gives no negative age";
}

TEST(FreshnessWatch, FindsAPipelineThatIsSteadilyLateAndDoesNotForgetItWithinAMinute) {
  FreshnessWatch watch;
  Send(watch, 0, 1'000'000, 5000);
  EXPECT_LE(watch.Query(1'000'000).lateness_us, 10);

  Send(watch, 1'000'000, 61'000'000, 205'000);

  EXPECT_GT(watch.Query(61'205'000).lateness_us, 200'000 - 61 * 500 - 1000);
}

TEST(FreshnessWatch, FindsAProcessThatWasFrozenAndDrainsItsQueue) {
  FreshnessWatch watch;
  Send(watch, 0, 1'000'000, 5000);

  // Two seconds of slices arrive within 20 ms.
  std::int64_t now = 3'000'000;
  std::int64_t least_lateness_us = std::numeric_limits<std::int64_t>::max();
  for (std::int64_t t = 1'000'000; t < 2'800'000; t += kPeriod_us) {
    now += 100;
    watch.OnArrival(now, t + kOffset_us);
    least_lateness_us = std::min(least_lateness_us, watch.Query(now).lateness_us);
  }
  Send(watch, 3'030'000, 3'100'000, 5000);

  EXPECT_GT(least_lateness_us, 190'000);
  EXPECT_LT(watch.Query(3'100'000).lateness_us, 2000);
}

TEST(FreshnessWatch, AllowsForClocksThatDriftApart) {
  FreshnessWatch watch;
  for (std::int64_t t = 0; t < 600'000'000; t += kPeriod_us) {
    // The sender's clock loses 100 ppm: 60 ms in ten minutes.
    watch.OnArrival(t, t - t / 10'000 + kOffset_us);
    ASSERT_LT(watch.Query(t).lateness_us, 1000);
  }
}

TEST(FreshnessWatch, StartsAnewWhenTheStampsStepBack) {
  FreshnessWatch watch;
  Send(watch, 10'000'000, 11'000'000, 5000);

  watch.OnArrival(11'005'000, 10'000'000 + kOffset_us);

  EXPECT_EQ(watch.Query(11'005'000).lateness_us, 0);
}

TEST(FreshnessWatch, LatenessIsNeverNegativeAndNothingOverflows) {
  constexpr std::int64_t kMax = std::numeric_limits<std::int64_t>::max();
  constexpr std::int64_t kMin = std::numeric_limits<std::int64_t>::min();
  std::mt19937_64 random(3);
  FreshnessWatch watch;
  std::int64_t now = 0;

  for (int i = 0; i < 10'000; ++i) {
    now += static_cast<std::int64_t>(random() % 100'000);
    const std::int64_t stamp = i % 3 == 0   ? kMax
                               : i % 3 == 1 ? kMin
                                            : static_cast<std::int64_t>(random());
    watch.OnArrival(now, stamp);
    ASSERT_GE(watch.Query(now).lateness_us, 0);
  }
}

}  // namespace
}  // namespace clearway::core
