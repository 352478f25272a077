// SPDX-License-Identifier: BSD-3-Clause
#include "common/core/simulation/packet_faults.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <set>
#include <utility>
#include <vector>

#include <gmock/gmock.h>

namespace clearway::core {
namespace {

constexpr std::int64_t kPeriod_us = 960;

struct Seen {
  std::int64_t number = 0;
  std::int64_t at_us = 0;
  friend bool operator==(const Seen&, const Seen&) = default;
};

// Sends `count` numbered packets, one each 960 us, and takes what leaves each 10 us.
std::vector<Seen> Send(PacketFaults& faults, std::int64_t count) {
  std::vector<Seen> seen;
  const auto take = [&](std::int64_t now_us) {
    while (const auto packet = faults.Take(now_us)) {
      seen.push_back({livox::Load<std::int64_t>(packet->bytes, 0), now_us});
    }
  };
  for (std::int64_t number = 0; number < count; ++number) {
    livox::Bytes bytes;
    livox::Append(bytes, number);
    faults.Put({{1, 2}, std::move(bytes)}, number * kPeriod_us);
    for (std::int64_t part_us = 0; part_us < kPeriod_us; part_us += 10) {
      take(number * kPeriod_us + part_us);
    }
  }
  while (const auto due_us = faults.NextDue()) take(*due_us);
  return seen;
}

// What a receiver finds: first copies, second copies, and those that came after a younger one.
struct Found {
  std::int64_t first = 0;
  std::int64_t duplicates = 0;
  std::int64_t reordered = 0;
};
Found Look(const std::vector<Seen>& seen) {
  Found found;
  std::set<std::int64_t> numbers;
  std::int64_t newest = -1;
  for (const Seen& one : seen) {
    if (!numbers.insert(one.number).second) {
      ++found.duplicates;
      continue;
    }
    ++found.first;
    if (one.number < newest) ++found.reordered;
    newest = std::max(newest, one.number);
  }
  return found;
}

class PacketFaultsTest : public testing::TestWithParam<NetworkFaultConfig> {};

TEST_P(PacketFaultsTest, CountsExactlyWhatAReceiverFinds) {
  constexpr std::int64_t kCount = 20'000;
  PacketFaults faults({GetParam()}, 42);

  const Found found = Look(Send(faults, kCount));

  EXPECT_EQ(found.first, kCount - faults.counts().lost);
  EXPECT_EQ(found.duplicates, faults.counts().duplicates);
  EXPECT_EQ(found.reordered, faults.counts().reordered);
  // The shares are met within four standard deviations of a binomial distribution.
  const auto expect_share = [](std::int64_t hits, double total, double share) {
    const double sigma = std::sqrt(total * share * (1.0 - share));
    EXPECT_NEAR(static_cast<double>(hits), total * share, 4.0 * sigma + 1e-9);
  };
  expect_share(faults.counts().lost, kCount, GetParam().loss);
  expect_share(faults.counts().duplicates, static_cast<double>(found.first), GetParam().duplicates);
}

INSTANTIATE_TEST_SUITE_P(
    Networks,
    PacketFaultsTest,
    testing::Values(NetworkFaultConfig{},
                    NetworkFaultConfig{.loss = 0.01},
                    NetworkFaultConfig{.loss = 0.05, .duplicates = 0.05, .reorder = 0.05},
                    NetworkFaultConfig{.loss = 0.2, .duplicates = 0.2, .reorder = 0.2},
                    NetworkFaultConfig{.loss = 1.0},
                    NetworkFaultConfig{.loss = 0.1, .jitter_us = 5'000},
                    NetworkFaultConfig{.duplicates = 0.3,
                                       .jitter_us = 5'000,
                                       .jitter_shape = JitterShape::kExponential,
                                       .jitter_keeps_order = false}));

TEST(PacketFaultsRuleTest, AGoodNetworkChangesNothing) {
  PacketFaults faults({}, 1);

  const std::vector<Seen> seen = Send(faults, 100);

  ASSERT_EQ(seen.size(), 100U);
  for (std::int64_t i = 0; i < 100; ++i) {
    EXPECT_EQ(seen[static_cast<std::size_t>(i)], (Seen{i, i * kPeriod_us}));
  }
}

TEST(PacketFaultsRuleTest, OrderedJitterDelaysWithinItsBoundAndKeepsTheOrder) {
  PacketFaults faults({{.jitter_us = 5'000}}, 7);

  const std::vector<Seen> seen = Send(faults, 5'000);

  ASSERT_EQ(seen.size(), 5'000U);
  std::int64_t longest_us = 0;
  for (std::size_t i = 0; i < seen.size(); ++i) {
    ASSERT_EQ(seen[i].number, static_cast<std::int64_t>(i));
    longest_us = std::max(longest_us, seen[i].at_us - seen[i].number * kPeriod_us);
  }
  EXPECT_LE(longest_us, 5'000 + 10);
  EXPECT_GE(longest_us, 4'900);
}

TEST(PacketFaultsRuleTest, AReorderedPacketIsHeldBackForItsTime) {
  PacketFaults faults({{.reorder = 0.1, .reorder_us = 3'000}}, 7);

  const std::vector<Seen> seen = Send(faults, 5'000);

  for (const Seen& one : seen) {
    const std::int64_t late_us = one.at_us - one.number * kPeriod_us;
    EXPECT_TRUE(late_us <= 10 || (late_us >= 3'000 && late_us <= 3'010)) << late_us;
  }
  EXPECT_GT(faults.counts().reordered, 400);
}

TEST(PacketFaultsRuleTest, AFaultActsBetweenItsTimesOnly) {
  PacketFaults faults({{.times = {.from_s = 1.0, .to_s = 2.0}, .loss = 1.0}}, 7);

  const std::vector<Seen> seen = Send(faults, 3'125);  // 3 s.

  for (const Seen& one : seen) {
    EXPECT_TRUE(one.at_us < 1'000'000 || one.at_us >= 2'000'000) << one.at_us;
  }
  EXPECT_EQ(faults.counts().lost, 1'042);
}

TEST(PacketFaultsRuleTest, TheSameSeedGivesTheSameAndAnotherDoesNot) {
  const NetworkFaultConfig bad{.loss = 0.2, .duplicates = 0.2, .reorder = 0.2, .jitter_us = 2'000};
  PacketFaults first({bad}, 1);
  PacketFaults again({bad}, 1);
  PacketFaults other({bad}, 2);

  const std::vector<Seen> seen = Send(first, 1'000);

  EXPECT_EQ(seen, Send(again, 1'000));
  EXPECT_NE(seen, Send(other, 1'000));
}

TEST(PacketFaultsRuleTest, WhatIsDroppedUnderWayIsLost) {
  PacketFaults faults({{.duplicates = 1.0, .reorder = 1.0, .reorder_us = 1'000'000}}, 1);
  for (int i = 0; i < 5; ++i) faults.Put({{1, 2}, livox::Bytes(8)}, 0);
  EXPECT_EQ(faults.size(), 10U);

  faults.DropAll();

  EXPECT_EQ(faults.size(), 0U);
  EXPECT_EQ(faults.counts().lost, 5);
  EXPECT_EQ(faults.counts().duplicates, 0);
}

TEST(PacketFaultsRuleTest, ControlFramesHaveAShareOfTheirOwn) {
  PacketFaults faults({{.loss = 1.0, .control_loss = 0.5}}, 3);
  int lost = 0;

  for (int i = 0; i < 10'000; ++i) lost += faults.LosesControl(i) ? 1 : 0;

  EXPECT_NEAR(lost, 5'000, 200);
  EXPECT_EQ(faults.counts().control_lost, lost);
  EXPECT_EQ(faults.counts().lost, 0);
}

}  // namespace
}  // namespace clearway::core
