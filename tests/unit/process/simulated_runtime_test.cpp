// SPDX-License-Identifier: BSD-3-Clause
#include "common/process/simulated_runtime.hpp"

#include <array>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace clearway::process {
namespace {

using messages::BusId;
using testing::ElementsAre;

constexpr std::int64_t kStart = 1'000'000;

std::span<const std::byte> Bytes(const int& value) {
  return std::as_bytes(std::span(&value, 1));
}

int Value(std::span<const std::byte> bytes) {
  int value = 0;
  std::copy(bytes.begin(), bytes.end(), std::as_writable_bytes(std::span(&value, 1)).begin());
  return value;
}

class SimulatedRuntimeTest : public testing::Test {
 protected:
  SimulatedRuntime runtime_{kStart, {}};
  std::vector<int> seen_;
};

TEST_F(SimulatedRuntimeTest, DeliversInTheOrderOfPublishingToSubscribersInTheirOrder) {
  runtime_.Subscribe(BusId::kLocal, "A", [&](auto bytes) { seen_.push_back(Value(bytes)); });
  runtime_.Subscribe(BusId::kLocal, "A", [&](auto bytes) { seen_.push_back(Value(bytes) + 100); });

  runtime_.Publish(BusId::kLocal, "A", Bytes(1));
  runtime_.Publish(BusId::kLocal, "A", Bytes(2));
  runtime_.RunUntil(kStart);

  EXPECT_THAT(seen_, ElementsAre(1, 101, 2, 102));
}

TEST_F(SimulatedRuntimeTest, AMessageFromAHandlerComesAfterThatHandler) {
  runtime_.Subscribe(BusId::kLocal, "A", [&](auto) {
    runtime_.Publish(BusId::kLocal, "B", Bytes(1));
    seen_.push_back(0);
  });
  runtime_.Subscribe(BusId::kLocal, "B", [&](auto bytes) { seen_.push_back(Value(bytes)); });

  runtime_.Publish(BusId::kLocal, "A", Bytes(0));
  runtime_.RunUntil(kStart);

  EXPECT_THAT(seen_, ElementsAre(0, 1));
}

TEST_F(SimulatedRuntimeTest, BusesAndChannelsAreApart) {
  runtime_.Subscribe(BusId::kShared, "A", [&](auto) { seen_.push_back(1); });
  runtime_.Subscribe(BusId::kLocal, "A.", [&](auto) { seen_.push_back(2); });

  runtime_.Publish(BusId::kLocal, "A", Bytes(0));
  runtime_.RunUntil(kStart);

  EXPECT_TRUE(seen_.empty());
}

TEST_F(SimulatedRuntimeTest, TimeMovesFromTimerToTimer) {
  std::vector<std::int64_t> times;
  runtime_.Every(40, [&] { times.push_back(runtime_.MonotonicUs() - kStart); });
  runtime_.After(50, [&] { times.push_back(runtime_.UtimeNow() - kStart); });

  runtime_.RunUntil(kStart + 130);

  EXPECT_THAT(times, ElementsAre(40, 50, 80, 120));
  EXPECT_EQ(runtime_.UtimeNow(), kStart + 130);
}

TEST_F(SimulatedRuntimeTest, AnExceptionOfAHandlerReachesTheCaller) {
  runtime_.Subscribe(BusId::kLocal, "A", [](auto) { throw std::runtime_error("broken"); });

  runtime_.Publish(BusId::kLocal, "A", Bytes(0));

  EXPECT_THROW(runtime_.RunUntil(kStart), std::runtime_error);
}

}  // namespace
}  // namespace clearway::process
