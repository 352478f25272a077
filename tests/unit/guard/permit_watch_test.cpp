// SPDX-License-Identifier: BSD-3-Clause
#include "common/core/guard/permit_watch.hpp"

#include <cstdint>
#include <limits>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/unit/scan/visit_check.hpp"

namespace clearway::core {
namespace {

constexpr std::int64_t kPeriod_us = 20'000;
constexpr std::int64_t kEpoch_us = 1'600'000'000'000'000;

// Publishes permits first..last at 50 Hz; the time of the last one.
std::int64_t Publish(PermitWatch& watch, std::int64_t first, std::int64_t last) {
  for (std::int64_t i = first; i <= last; ++i) {
    EXPECT_TRUE(watch.OnPermit(1, i, kEpoch_us + i * kPeriod_us, i * kPeriod_us));
  }
  return last * kPeriod_us;
}

TEST(PermitWatch, HasDefaultsWithinItsBounds) {
  EXPECT_THAT(test::FaultsOfDefaults<PermitWatchConfig>(), testing::IsEmpty());
}

TEST(PermitWatch, MeansStopBeforeTheFirstPermit) {
  const PermitWatch watch;

  EXPECT_EQ(watch.State(0), PermitState::kNone);
}

TEST(PermitWatch, LetsAPermitCountForItsValidityAndNoLonger) {
  PermitWatch watch;
  const std::int64_t now = Publish(watch, 0, 10);

  EXPECT_TRUE(watch.IsValid(now + 100'000));
  EXPECT_EQ(watch.State(now + 100'001), PermitState::kStale);
}

TEST(PermitWatch, MeansStopOnARepeatedSequenceUntilTheNextGoodOne) {
  PermitWatch watch;
  const std::int64_t now = Publish(watch, 0, 10);

  EXPECT_FALSE(watch.OnPermit(1, 10, kEpoch_us + now, now + 1));
  EXPECT_EQ(watch.State(now + 1), PermitState::kRepeated);
  EXPECT_FALSE(watch.OnPermit(1, 3, kEpoch_us + now, now + 2));
  EXPECT_EQ(watch.State(now + 2), PermitState::kRepeated);
  Publish(watch, 11, 11);

  EXPECT_TRUE(watch.IsValid(now + kPeriod_us));
  EXPECT_EQ(watch.num_repeated(), 2);
}

TEST(PermitWatch, IsNotKeptAliveByAFrozenPermitThatIsRepeated) {
  PermitWatch watch;
  std::int64_t now = Publish(watch, 0, 10);

  for (int i = 0; i < 100; ++i) {
    now += kPeriod_us;
    watch.OnPermit(1, 10, kEpoch_us + 10 * kPeriod_us, now);
    EXPECT_FALSE(watch.IsValid(now));
  }
}

TEST(PermitWatch, MeansStopWhileAFrozenGuardDrainsItsQueue) {
  PermitWatch watch;
  const std::int64_t now = Publish(watch, 0, 10) + 1'000'000;

  for (std::int64_t i = 11; i < 50; ++i) {
    watch.OnPermit(1, i, kEpoch_us + i * kPeriod_us, now + i);
    EXPECT_EQ(watch.State(now + i), PermitState::kLate);
  }
}

TEST(PermitWatch, ObeysOnePublisherAndIgnoresTheOther) {
  PermitWatch watch;
  std::int64_t now = Publish(watch, 0, 10);

  EXPECT_FALSE(watch.OnPermit(2, 1000, kEpoch_us, now + 50'000));
  EXPECT_EQ(watch.State(now + 110'000), PermitState::kStale)
      << "the other one's permit keeps nothing alive";
  EXPECT_FALSE(watch.OnPermit(2, 1001, kEpoch_us, now + 1'000'000));
  EXPECT_EQ(watch.num_foreign(), 2);
}

TEST(PermitWatch, UnlocksOnceItsPublisherHasBeenSilent) {
  PermitWatch watch;
  const std::int64_t now = Publish(watch, 100, 110);

  EXPECT_TRUE(watch.OnPermit(2, 0, kEpoch_us, now + 1'000'001));
  EXPECT_TRUE(watch.IsValid(now + 1'000'001));
  EXPECT_FALSE(watch.OnPermit(1, 111, kEpoch_us, now + 1'000'002)) << "locked to the new one";
}

TEST(PermitWatch, AcceptsAnyNumbers) {
  PermitWatch watch;

  EXPECT_TRUE(watch.OnPermit(-7, std::numeric_limits<std::int64_t>::min(), -5, 0));
  EXPECT_TRUE(watch.OnPermit(-7, std::numeric_limits<std::int64_t>::max(), -4, 1));
  EXPECT_FALSE(watch.OnPermit(-7, std::numeric_limits<std::int64_t>::max(), -4, 2));
}

}  // namespace
}  // namespace clearway::core
