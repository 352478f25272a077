// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include "common/core/livox/sensor_stream.hpp"
#include "tests/support/count_allocations.hpp"
#include "tests/unit/livox/simulated_sensor.hpp"

namespace clearway::core::livox {
namespace {

TEST(StreamCostTest, AllocatesNothingForAPacketOnceSizesHaveSettled) {
  for (const bool is_dual : {false, true}) {
    SimulatedSensor sensor({.loss = 0.05, .duplicates = 0.05, .is_dual = is_dual});
    SensorStream stream({});
    StreamRun run;
    Feed(stream, sensor.Send(5'000'000, 0), run);
    const std::vector<SentPacket> packets = sensor.Send(2'000'000, 4'999'680'000);
    std::size_t allocations = 0;
    std::size_t slices = 0;

    for (const SentPacket& sent : packets) {
      const DataPacket packet = *ParsePacket(sent.bytes).packet;
      const std::size_t before = test::NumAllocations();
      stream.Add(packet, sent.arrival_utime);
      allocations += test::NumAllocations() - before;
      slices += stream.Take(sent.arrival_utime).size();
    }

    EXPECT_EQ(allocations, 0U);
    EXPECT_GT(slices, 195U);
  }
}

}  // namespace
}  // namespace clearway::core::livox
