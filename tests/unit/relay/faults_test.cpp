// SPDX-License-Identifier: BSD-3-Clause
#include "tools/relay/faults.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include <gtest/gtest.h>

namespace clearway::relay {
namespace {

constexpr int kFrames = 100'000;

// Of `kFrames`, how many satisfy the condition.
template <typename Condition>
int Count(const FaultSettings& settings, std::uint64_t seed, Condition condition) {
  Faults faults(seed);
  faults.settings = settings;
  int count = 0;
  for (int i = 0; i < kFrames; ++i) count += condition(faults.Decide(i)) ? 1 : 0;
  return count;
}

// Five standard deviations of a binomial distribution.
double Tolerance(double probability) {
  return 5.0 * std::sqrt(kFrames * probability * (1.0 - probability));
}

class RateTest : public testing::TestWithParam<double> {};

TEST_P(RateTest, AsManyAreLostAsWasAskedFor) {
  for (const std::uint64_t seed : {0U, 1U, 2U, 3U}) {
    const int lost =
        Count({.loss = GetParam()}, seed, [](const auto& verdict) { return verdict.copies == 0; });

    EXPECT_NEAR(lost, kFrames * GetParam(), Tolerance(GetParam()));
  }
}

TEST_P(RateTest, AsManyAreDuplicatedAsWasAskedFor) {
  const int duplicated =
      Count({.duplicate = GetParam()}, 1, [](const auto& verdict) { return verdict.copies == 2; });

  EXPECT_NEAR(duplicated, kFrames * GetParam(), Tolerance(GetParam()));
}

INSTANTIATE_TEST_SUITE_P(FromNoneToAll, RateTest, testing::Values(0.0, 0.001, 0.02, 0.5, 1.0));

TEST(FaultsTest, LossesDoNotComeInARow) {
  Faults faults(1);
  faults.settings.loss = 0.1;
  int after_loss = 0;
  bool was_lost = false;
  for (int i = 0; i < kFrames; ++i) {
    const bool is_lost = faults.Decide(i).copies == 0;
    after_loss += was_lost && is_lost ? 1 : 0;
    was_lost = is_lost;
  }

  EXPECT_NEAR(after_loss, kFrames * 0.01, Tolerance(0.01));
}

TEST(FaultsTest, TheSameSeedDecidesTheSameAndAnotherOtherwise) {
  Faults a(5);
  Faults b(5);
  Faults c(6);
  int differences = 0;
  for (Faults* faults : {&a, &b, &c}) faults->settings = {.loss = 0.3, .jitter_ns = 1000};
  for (int i = 0; i < 1000; ++i) {
    const Faults::Verdict verdict = a.Decide(i);
    const Faults::Verdict same = b.Decide(i);

    EXPECT_EQ(verdict.copies, same.copies);
    EXPECT_EQ(verdict.due_ns, same.due_ns);
    differences += verdict.copies != c.Decide(i).copies ? 1 : 0;
  }
  EXPECT_GT(differences, 100);
}

TEST(FaultsTest, MoreLossLosesWhatLessHadLost) {
  Faults less(5);
  Faults more(5);
  less.settings = {.loss = 0.1};
  more.settings = {.loss = 0.2, .duplicate = 0.5, .delay_ns = 100, .jitter_ns = 10};
  for (int i = 0; i < 1000; ++i) {
    const bool is_lost = less.Decide(i).copies == 0;
    const bool is_lost_too = more.Decide(i).copies == 0;
    EXPECT_TRUE(!is_lost || is_lost_too);
  }
}

TEST(FaultsTest, DelayIsAtLeastWhatWasAskedForAndAtMostTheJitterMore) {
  Faults faults(1);
  faults.settings = {.delay_ns = 5000, .jitter_ns = 1000};
  std::int64_t least = 1'000'000;
  std::int64_t most = 0;
  for (std::int64_t i = 0; i < 10'000; ++i) {
    const std::int64_t now_ns = i * 10'000;  // So far apart that none waits for the one before.
    const std::int64_t delay_ns = faults.Decide(now_ns).due_ns - now_ns;
    least = std::min(least, delay_ns);
    most = std::max(most, delay_ns);
  }

  EXPECT_GE(least, 5000);
  EXPECT_LT(least, 5010);
  EXPECT_LE(most, 6000);
  EXPECT_GT(most, 5990);
}

TEST(FaultsTest, TheOrderStaysWithJitterAndWhenDelaysShrink) {
  Faults faults(1);
  std::int64_t last_ns = 0;
  for (int i = 0; i < 10'000; ++i) {
    faults.settings = {.delay_ns = i % 1000 < 500 ? 100'000 : 0, .jitter_ns = 50'000};
    const std::int64_t due_ns = faults.Decide(i * 10).due_ns;

    EXPECT_GE(due_ns, last_ns);
    EXPECT_GE(due_ns, i * 10);
    last_ns = due_ns;
  }
}

TEST(FaultsTest, WithoutFaultsEveryFrameGoesAtOnce) {
  Faults faults(1);
  for (int i = 0; i < 1000; ++i) {
    EXPECT_EQ(faults.Decide(i).copies, 1);
    EXPECT_EQ(faults.Decide(i).due_ns, i);
  }
}

}  // namespace
}  // namespace clearway::relay
