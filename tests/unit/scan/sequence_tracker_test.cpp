// SPDX-License-Identifier: BSD-3-Clause
#include "common/core/scan/sequence_tracker.hpp"

#include <algorithm>
#include <cstdint>
#include <limits>
#include <random>
#include <set>
#include <vector>

#include <gtest/gtest.h>

namespace clearway::core {
namespace {

using V = SequenceVerdict;
constexpr std::int64_t kPeriod_us = 10'000;

TEST(SequenceTracker, JudgesTheNumbersOfOneSession) {
  SequenceTracker tracker;

  EXPECT_EQ(tracker.Observe(1, 100, 0), V::kFirst);
  EXPECT_EQ(tracker.Observe(1, 101, 1), V::kNext);
  EXPECT_EQ(tracker.Observe(1, 104, 2), V::kGap);
  EXPECT_EQ(tracker.Observe(1, 104, 3), V::kDuplicate);
  EXPECT_EQ(tracker.Observe(1, 103, 4), V::kOutOfOrder);
  EXPECT_EQ(tracker.Observe(1, 103, 5), V::kDuplicate);
  EXPECT_EQ(tracker.Observe(1, -1, 6), V::kInvalid);
  EXPECT_EQ(tracker.counts().missing, 1);
  EXPECT_EQ(tracker.counts().received, 7);
}

TEST(SequenceTracker, CountsLikeASetOfAllNumbersWhenReorderingStaysWithinItsMemory) {
  for (unsigned seed = 1; seed <= 20; ++seed) {
    std::mt19937 random(seed);
    // Drops, repeats and a shuffle within 16 places.
    std::vector<std::int64_t> sent;
    for (std::int64_t i = 0; i < 2000; ++i) {
      if (random() % 10 == 0) continue;
      sent.push_back(i);
      if (random() % 20 == 0) sent.push_back(i);
    }
    for (std::size_t i = 0; i + 16 < sent.size(); i += 16) {
      std::shuffle(sent.begin() + static_cast<std::ptrdiff_t>(i),
                   sent.begin() + static_cast<std::ptrdiff_t>(i) + 16,
                   random);
    }
    SequenceTracker tracker;
    std::set<std::int64_t> seen;
    std::int64_t duplicates = 0;

    for (const std::int64_t sequence : sent) {
      tracker.Observe(7, sequence, sequence * kPeriod_us);
      if (!seen.insert(sequence).second) ++duplicates;
    }

    const std::int64_t span = *seen.rbegin() - sent.front() + 1;
    const auto from_first = std::distance(seen.lower_bound(sent.front()), seen.end());
    EXPECT_EQ(tracker.counts().missing, span - from_first) << "seed " << seed;
    EXPECT_EQ(tracker.counts().duplicates, duplicates) << "seed " << seed;
    EXPECT_EQ(tracker.counts().received, static_cast<std::int64_t>(sent.size()));
  }
}

TEST(SequenceTracker, TakesANewSessionForARestart) {
  SequenceTracker tracker;
  tracker.Observe(1, 500, 0);

  EXPECT_EQ(tracker.Observe(2, 0, kPeriod_us), V::kRestart);
  EXPECT_EQ(tracker.Observe(2, 1, 2 * kPeriod_us), V::kNext);
  EXPECT_EQ(tracker.counts().restarts, 1);
  EXPECT_EQ(tracker.counts().missing, 0);
}

TEST(SequenceTracker, TellsTwoPublishersFromARestart) {
  SequenceTracker tracker;
  for (std::int64_t i = 0; i < 50; ++i) {
    tracker.Observe(1, i, 2 * i * kPeriod_us);
    tracker.Observe(2, i, (2 * i + 1) * kPeriod_us);
  }

  EXPECT_EQ(tracker.counts().restarts, 1);
  EXPECT_EQ(tracker.counts().foreign, 49);
  EXPECT_EQ(tracker.session(), 2);
}

TEST(SequenceTracker, TellsThreePublishersFromRestarts) {
  SequenceTracker tracker;
  for (std::int64_t i = 0; i < 90; ++i) tracker.Observe(i % 3, i, i * kPeriod_us);

  EXPECT_EQ(tracker.counts().restarts, 2);
  EXPECT_EQ(tracker.counts().foreign, 87 - 29 + 0) << "all but the owner's own";
}

TEST(SequenceTracker, ReturnsToAFormerSessionOnceItsSuccessorIsSilent) {
  SequenceTracker tracker;
  tracker.Observe(1, 0, 0);
  tracker.Observe(2, 0, 10);
  V verdict = V::kForeign;
  std::int64_t now = 20;

  for (std::int64_t i = 1; verdict == V::kForeign && i < 1000; ++i) {
    now += kPeriod_us;
    verdict = tracker.Observe(1, i, now);
  }

  EXPECT_EQ(verdict, V::kRestart);
  EXPECT_GT(now, SequenceTracker::kForeign_us);
  EXPECT_LT(now, SequenceTracker::kForeign_us + 3 * kPeriod_us);
}

TEST(SequenceTracker, FollowsALogThatIsPlayedAgain) {
  SequenceTracker tracker;
  for (std::int64_t i = 1000; i < 2000; ++i) tracker.Observe(1, i, i);
  std::vector<V> verdicts;

  for (std::int64_t i = 1000; i < 1020; ++i) verdicts.push_back(tracker.Observe(1, i, 5000 + i));

  EXPECT_EQ(std::count(verdicts.begin(), verdicts.end(), V::kRestart), 1);
  EXPECT_EQ(verdicts[SequenceTracker::kRejoin - 1], V::kRestart);
  EXPECT_EQ(verdicts.back(), V::kNext);
}

TEST(SequenceTracker, DoesNotFollowAnEchoOfThePastWhileTheStreamGoesOn) {
  SequenceTracker tracker;
  for (std::int64_t i = 1000; i < 2000; ++i) tracker.Observe(1, i, i);

  for (std::int64_t i = 0; i < 100; ++i) {
    EXPECT_FALSE(IsNewest(tracker.Observe(1, 1000 + i, 5000 + i)));
    EXPECT_EQ(tracker.Observe(1, 2000 + i, 5000 + i), V::kNext);
  }
}

TEST(SequenceTracker, SurvivesTheLargestNumbers) {
  constexpr std::int64_t kMax = std::numeric_limits<std::int64_t>::max();
  SequenceTracker tracker;
  tracker.Observe(1, 0, 0);
  EXPECT_EQ(tracker.Observe(1, kMax, 1), V::kGap);
  tracker.Observe(std::numeric_limits<std::int64_t>::min(), 0, 2);

  EXPECT_EQ(tracker.Observe(std::numeric_limits<std::int64_t>::min(), kMax, 3), V::kGap);
  EXPECT_EQ(tracker.counts().missing, kMax) << "saturated";
  EXPECT_EQ(tracker.Observe(std::numeric_limits<std::int64_t>::min(), 5, 4), V::kOutOfOrder);
}

}  // namespace
}  // namespace clearway::core
