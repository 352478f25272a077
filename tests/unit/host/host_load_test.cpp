// SPDX-License-Identifier: BSD-3-Clause
#include "common/host/host_load.hpp"

#include <string>

#include <gtest/gtest.h>

namespace clearway::host {
namespace {

TEST(ParseCpuTimesTest, CountsGuestsOnceAndWaitingAsIdle) {
  // user nice system idle iowait irq softirq steal guest guest_nice
  const auto times = ParseCpuTimes("cpu  100 20 30 400 50 6 7 8 90 9\ncpu0 1 2 3 4\n");

  ASSERT_TRUE(times.has_value());
  EXPECT_EQ(times->total, 621U);
  EXPECT_EQ(times->busy, 171U);
}

TEST(ParseCpuTimesTest, ATextThatIsCutGivesNothing) {
  const std::string text = "cpu  100 20 30 400 50 6 7 81 90 9\n";
  const std::size_t whole = text.find(" 90") + 1;
  for (std::size_t size = 0; size <= text.size(); ++size) {
    const std::string cut = text.substr(0, size);
    EXPECT_EQ(ParseCpuTimes(cut).has_value(), size >= whole) << size;
  }
}

TEST(ParseCpuTimesTest, RefusesWhatIsNotTheLine) {
  for (const char* text :
       {"", "cpu0 1 2 3 4 5 6 7 8 9\n", "cpu  1 2 x 4 5 6 7 8 9\n", "cpu  -1 2\n"}) {
    EXPECT_FALSE(ParseCpuTimes(text).has_value()) << text;
  }
}

const std::string kMemory =
    "MemTotal:        8000000 kB\n"
    "MemFree:          100000 kB\n"
    "MemAvailable:    6000000 kB\n"
    "NotSwapTotal:          1 kB\n"
    "SwapTotal:       2000000 kB\n"
    "SwapFree:        1999999 kB\n"
    "HugePages_Total:       0\n";

TEST(ParseMemInfoTest, WhatCanBeHadIsFree) {
  const auto memory = ParseMemInfo(kMemory);

  ASSERT_TRUE(memory.has_value());
  EXPECT_EQ(memory->total_bytes, 8000000LL * 1024);
  EXPECT_EQ(memory->free_bytes, 6000000LL * 1024);
  EXPECT_EQ(memory->swap_total_bytes, 2000000LL * 1024);
  EXPECT_EQ(memory->swap_free_bytes, 1999999LL * 1024);
}

TEST(ParseMemInfoTest, ATextThatIsCutGivesNothing) {
  const std::size_t whole = kMemory.find("\nHuge");
  for (std::size_t size = 0; size <= kMemory.size(); ++size) {
    const std::string cut = kMemory.substr(0, size);
    EXPECT_EQ(ParseMemInfo(cut).has_value(), size >= whole) << size;
  }
}

TEST(HostLoadTest, HasALoadFromTheSecondSampleOn) {
  HostLoad load;

  const HostLoad::Reading first = load.Sample();
  HostLoad::Reading later = load.Sample();
  // Busy until a tick has passed.
  for (int i = 0; later.cpu_load < 0.0F && i < 1'000'000; ++i) later = load.Sample();

  EXPECT_EQ(first.cpu_load, -1.0F);
  EXPECT_GT(first.memory.total_bytes, 0);
  EXPECT_GT(first.memory.free_bytes, 0);
  EXPECT_LE(first.memory.free_bytes, first.memory.total_bytes);
  EXPECT_LE(first.memory.swap_free_bytes, first.memory.swap_total_bytes);
  EXPECT_GE(later.cpu_load, 0.0F);
  EXPECT_LE(later.cpu_load, 1.0F);
}

}  // namespace
}  // namespace clearway::host
