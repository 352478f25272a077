// SPDX-License-Identifier: BSD-3-Clause
#include "tools/relay/delay_line.hpp"

#include <gtest/gtest.h>

namespace clearway::relay {
namespace {

// `mark` tells packets apart.
DelayedPacket Packet(std::int64_t due_ns, std::size_t mark, std::size_t bytes = 10) {
  return {.due_ns = due_ns,
          .from = mark,
          .to = 0,
          .bytes = std::make_shared<const std::vector<std::byte>>(bytes)};
}

TEST(DelayLineTest, PacketsLeaveWhenTheyAreDueTheEarliestFirst) {
  DelayLine line(1000);
  EXPECT_TRUE(line.Push(Packet(300, 3)));
  EXPECT_TRUE(line.Push(Packet(100, 1)));
  EXPECT_TRUE(line.Push(Packet(200, 2)));
  EXPECT_EQ(line.next_due_ns(), 100);

  EXPECT_FALSE(line.PopDue(99));
  EXPECT_EQ(line.PopDue(250)->from, 1U);
  EXPECT_EQ(line.PopDue(250)->from, 2U);
  EXPECT_FALSE(line.PopDue(299));
  EXPECT_EQ(line.PopDue(300)->from, 3U);
  EXPECT_FALSE(line.next_due_ns());
}

TEST(DelayLineTest, PacketsThatAreDueAtOnceLeaveAsTheyCame) {
  DelayLine line(100'000);
  for (std::size_t i = 0; i < 100; ++i) EXPECT_TRUE(line.Push(Packet(7, i)));

  for (std::size_t i = 0; i < 100; ++i) EXPECT_EQ(line.PopDue(7)->from, i);
}

TEST(DelayLineTest, MemoryIsBounded) {
  DelayLine line(100);
  EXPECT_TRUE(line.Push(Packet(1, 0, 60)));
  EXPECT_FALSE(line.Push(Packet(2, 1, 41)));
  EXPECT_TRUE(line.Push(Packet(2, 2, 40)));
  EXPECT_FALSE(line.Push(Packet(3, 3, 1)));
  EXPECT_EQ(line.num_bytes(), 100U);
  EXPECT_EQ(line.num_packets(), 2U);

  EXPECT_TRUE(line.PopDue(1));

  EXPECT_TRUE(line.Push(Packet(3, 4, 60)));
  EXPECT_EQ(line.PopDue(9)->from, 2U);
  EXPECT_EQ(line.PopDue(9)->from, 4U);
  EXPECT_EQ(line.num_bytes(), 0U);
}

}  // namespace
}  // namespace clearway::relay
