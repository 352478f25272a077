// SPDX-License-Identifier: BSD-3-Clause
// A session of the vendor's SDK with an emulated MID-70.
#include <vector>

#include <gtest/gtest.h>

#include "common/core/livox/commands.hpp"
#include "common/core/livox/data_packet.hpp"
#include "tests/support/test_data.hpp"
#include "tests/unit/livox/pcap_file.hpp"

namespace clearway::core::livox {
namespace {

TEST(CapturedSession, ParsesDatagramByDatagram) {
  const auto path = test::TestData("livox/mid70_session_head.pcap");
  if (!path) GTEST_SKIP() << test::MissingData("livox/mid70_session_head.pcap");
  int control = 0;
  int data = 0;
  std::uint64_t last_timestamp = 0;
  for (const test::CapturedDatagram& datagram : test::ReadPcap(*path)) {
    if (datagram.source.port == kDevicePort || datagram.destination.port == kDevicePort) {
      ++control;
      const ParsedFrame parsed = ParseFrame(datagram.payload);
      ASSERT_EQ(parsed.defect, FrameDefect::kNone) << "control datagram " << control;
      EXPECT_EQ(PackFrame(*parsed.frame), datagram.payload);
      EXPECT_STRNE(CommandName(CodeOf(*parsed.frame)), "unknown command");
      continue;
    }
    ++data;
    const ParsedPacket parsed = ParsePacket(datagram.payload);
    ASSERT_EQ(parsed.defect, PacketDefect::kNone) << "data datagram " << data;
    EXPECT_EQ(parsed.packet->shots, parsed.packet->layout.shots_in_packet);
    if (last_timestamp != 0) {
      EXPECT_EQ(parsed.packet->header.timestamp - last_timestamp, 960'000U);
    }
    last_timestamp = parsed.packet->header.timestamp;
  }
  EXPECT_GT(control, 10);
  EXPECT_GT(data, 200);
}

TEST(CapturedSession, SaysWhoIsWho) {
  const auto path = test::TestData("livox/mid70_session_head.pcap");
  if (!path) GTEST_SKIP() << test::MissingData("livox/mid70_session_head.pcap");
  const std::vector<test::CapturedDatagram> datagrams = test::ReadPcap(*path);
  ASSERT_FALSE(datagrams.empty());

  const ParsedFrame first = ParseFrame(datagrams.front().payload);
  ASSERT_TRUE(first.frame);
  const auto broadcast = ParseBroadcast(first.frame->data);

  ASSERT_TRUE(broadcast);
  EXPECT_EQ(broadcast->type, DeviceType::kMid70);
  EXPECT_EQ(broadcast->broadcast_code.size(), Broadcast::kMaxCodeLength);
  EXPECT_EQ(ToString(datagrams.front().destination), "255.255.255.255:55000");
}

}  // namespace
}  // namespace clearway::core::livox
