// SPDX-License-Identifier: BSD-3-Clause
// What the vendor's SDK said to a sensor in a captured session, said to ours.
#include <cstdint>
#include <optional>
#include <vector>

#include <gtest/gtest.h>

#include "common/core/simulation/emulated_mid70.hpp"
#include "tests/support/test_data.hpp"
#include "tests/unit/livox/pcap_file.hpp"

namespace clearway::core {
namespace {

using livox::CommandCode;

// Firmware, progress and status are each sensor's own.
bool IsSameForAll(CommandCode code) {
  return code != CommandCode::kDeviceInfo && code != CommandCode::kHeartbeat;
}

TEST(EmulatedMid70SessionTest, AnswersAllThatTheVendorsSdkSaidAsTheOtherSensorDid) {
  const auto path = test::TestData("livox/mid70_session_head.pcap");
  if (!path) GTEST_SKIP() << test::MissingData("livox/mid70_session_head.pcap");
  const std::vector<test::CapturedDatagram> session = test::ReadPcap(*path);
  EmulatedMid70 device({.firmware = {2, 10, 3, 0}, .start_up_us = 4'000'000}, {}, 0);
  std::int64_t now_us = 1'000'000;
  std::optional<EmulatedMid70::Outgoing> answer;
  int commands = 0;
  int same = 0;
  std::optional<Endpoint> points_to;

  for (const test::CapturedDatagram& datagram : session) {
    if (datagram.destination.port == livox::kDevicePort) {
      now_us += 500'000;
      const auto answers = device.Receive(datagram.source, datagram.payload, now_us);
      ASSERT_EQ(answers.size(), 1U) << "command " << commands;
      answer = answers.front();
      ++commands;
      const livox::ParsedFrame parsed = livox::ParseFrame(answer->bytes);
      ASSERT_TRUE(parsed.frame.has_value());
      EXPECT_EQ(parsed.frame->data[0], std::byte{0}) << "result of command " << commands;
      EXPECT_EQ(parsed.frame->sequence, livox::ParseFrame(datagram.payload).frame->sequence);
      EXPECT_EQ(answer->to, datagram.source);
      for (const test::CapturedDatagram& other : session) {
        const livox::ParsedFrame theirs = livox::ParseFrame(other.payload);
        const bool is_answer = other.source.port == livox::kDevicePort && theirs.frame &&
                               theirs.frame->type == livox::FrameType::kAck &&
                               theirs.frame->sequence == parsed.frame->sequence;
        if (!is_answer) continue;
        ASSERT_EQ(theirs.frame->data.size(), parsed.frame->data.size());
        EXPECT_EQ(other.destination, answer->to);
        if (IsSameForAll(answer->code)) {
          EXPECT_EQ(other.payload, answer->bytes);
        }
        ++same;
      }
    } else if (datagram.source.port != livox::kDevicePort) {
      points_to = datagram.destination;
    }
  }

  EXPECT_EQ(commands, 9);
  EXPECT_EQ(same, 9);
  ASSERT_TRUE(device.sampling(now_us).has_value()) << "the SDK started it";
  EXPECT_EQ(device.sampling(now_us)->to, points_to);
}

}  // namespace
}  // namespace clearway::core
