// SPDX-License-Identifier: BSD-3-Clause
#include "common/core/procman/output_queue.hpp"

#include <map>
#include <random>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace clearway::core::procman {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::Pair;

constexpr std::size_t kRoom = 1000;

std::size_t SizeOf(const OutputQueue::Batch& batch) {
  std::size_t size = 0;
  for (const auto& [id, text] : batch) size += id.size() + text.size() + 10;
  return size;
}

TEST(OutputQueueTest, CollectsForTheBatchTimeAndSendsInOneMessage) {
  OutputQueue queue({.bytes_per_s = 100'000, .batch_us = 10'000}, kRoom);

  queue.Add("a", "one ", 0);
  queue.Add("b", "two", 5000);
  queue.Add("a", "three", 9000);
  EXPECT_TRUE(queue.Take(9999).empty());
  EXPECT_EQ(queue.NextDue(), 10'000);

  EXPECT_THAT(queue.Take(10'000),
              ElementsAre(ElementsAre(Pair("a", "one three"), Pair("b", "two"))));
  EXPECT_FALSE(queue.NextDue().has_value());
}

TEST(OutputQueueTest, NulBecomesVisible) {
  OutputQueue queue({}, kRoom);

  queue.Add("a", std::string_view("x\0y", 3), 0);

  EXPECT_THAT(queue.Take(1'000'000), ElementsAre(ElementsAre(Pair("a", "x^@y"))));
}

// Every byte is sent in order, or counted as dropped and said to be; no message is too large; the
// rate holds.
TEST(OutputQueueTest, WhateverComesIsSentOrCountedWithinTheRateAndTheSize) {
  for (unsigned seed = 0; seed < 50; ++seed) {
    std::mt19937 random(seed);
    const OutputConfig config{.bytes_per_s = 50'000, .batch_us = 10'000};
    OutputQueue queue(config, kRoom);
    std::map<std::string, std::int64_t> added;
    std::map<std::string, std::int64_t> sent;
    std::int64_t now_us = 0;
    std::size_t bytes = 0;
    const auto take = [&] {
      for (const OutputQueue::Batch& batch : queue.Take(now_us)) {
        EXPECT_LE(SizeOf(batch), kRoom);
        EXPECT_FALSE(batch.empty());
        bytes += SizeOf(batch);
        for (const auto& [id, text] : batch) {
          sent[id] += std::count(text.begin(), text.end(), 'x');
        }
      }
    };
    for (int i = 0; i < 2000; ++i) {
      now_us += static_cast<std::int64_t>(random() % 20'000);
      const std::string id(1, static_cast<char>('a' + random() % 4));
      const std::size_t size = random() % (id == "a" ? 20'000 : 50);
      queue.Add(id, std::string(size, 'x'), now_us);
      added[id] += static_cast<std::int64_t>(size);
      take();
    }
    // A second's worth of credit may be spent at once.
    EXPECT_LE(static_cast<double>(bytes),
              static_cast<double>(config.bytes_per_s) * (static_cast<double>(now_us) * 1e-6 + 1.0) +
                  kRoom);
    for (auto due_us = queue.NextDue(); due_us; due_us = queue.NextDue()) {
      now_us = std::max(now_us + 1, *due_us);
      take();
    }

    for (const auto& [id, count] : added) {
      EXPECT_EQ(sent[id] + queue.DroppedBytes(id), count) << "seed " << seed << ' ' << id;
    }
    EXPECT_GT(queue.DroppedBytes("a"), 0);
    EXPECT_EQ(queue.DroppedBytes("b"), 0) << "a loud command does not silence a quiet one";
  }
}

TEST(OutputQueueTest, WhatWasDroppedIsSaidAtItsPlace) {
  OutputQueue queue({.bytes_per_s = 1'000'000, .batch_us = 0}, 60'000);

  queue.Add("a", std::string(60'000, 'x'), 0);
  queue.Add("a", std::string(7000, 'y'), 0);
  std::string text;
  for (std::int64_t now_us = 1; queue.NextDue(); now_us += 100'000) {
    for (const auto& batch : queue.Take(now_us)) text += batch.front().second;
  }

  EXPECT_THAT(text, HasSubstr("x\n[7000 bytes of output were not sent"));
  EXPECT_EQ(text.find("yy"), std::string::npos);
}

}  // namespace
}  // namespace clearway::core::procman
