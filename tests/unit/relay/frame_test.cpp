// SPDX-License-Identifier: BSD-3-Clause
#include "tools/relay/frame.hpp"

#include <random>

#include <gtest/gtest.h>

#include "tests/unit/relay/frame_maker.hpp"

namespace clearway::relay {
namespace {

// In memory of exactly this size, so that the address sanitizer sees a read beyond it.
FrameKind KindOf(std::span<const std::byte> bytes) {
  const Bytes exact(bytes.begin(), bytes.end());
  return ParseFrame(exact).kind;
}

TEST(FrameTest, ASmallMessageTellsItsChannelAndSize) {
  const Bytes bytes = OneFrame(SmallMessage("DRIVE_PERMIT", 50, 123456));

  const Frame frame = ParseFrame(bytes);

  EXPECT_EQ(frame.kind, FrameKind::kSmallMessage);
  EXPECT_EQ(frame.channel, "DRIVE_PERMIT");
  EXPECT_EQ(frame.message_bytes, 50U);
  EXPECT_EQ(frame.sequence, 123456U);
  EXPECT_EQ(frame.source_ip, 0x0a4d0001U);
  EXPECT_EQ(frame.destination_ip, 0xefff4c43U);
  EXPECT_EQ(frame.source_port, 40000);
  EXPECT_EQ(frame.destination_port, 7667);
  EXPECT_FALSE(frame.more_ip_fragments);
}

TEST(FrameTest, AnEmptyMessageIsOneToo) {
  const Bytes bytes = OneFrame(SmallMessage("A", 0));

  EXPECT_EQ(ParseFrame(bytes).kind, FrameKind::kSmallMessage);
  EXPECT_EQ(ParseFrame(bytes).message_bytes, 0U);
}

TEST(FrameTest, PaddingBehindThePacketIsNoPartOfIt) {
  Bytes bytes = OneFrame(SmallMessage("A", 2));
  bytes.resize(60, std::byte{0});

  EXPECT_EQ(ParseFrame(bytes).message_bytes, 2U);
}

TEST(FrameTest, IpOptionsAreSkipped) {
  const Bytes bytes = OneFrame(SmallMessage("A", 2), {.ip_option_bytes = 8});

  EXPECT_EQ(ParseFrame(bytes).kind, FrameKind::kSmallMessage);
  EXPECT_EQ(ParseFrame(bytes).message_bytes, 2U);
}

TEST(FrameTest, TheFirstIpFragmentTellsTheSizeOfTheWholeMessage) {
  const std::vector<Bytes> frames = Frames(SmallMessage("LIDAR_POINTS", 57'000), {.ip_id = 99});

  ASSERT_EQ(frames.size(), 39U);
  EXPECT_EQ(ParseFrame(frames[0]).kind, FrameKind::kSmallMessage);
  EXPECT_EQ(ParseFrame(frames[0]).message_bytes, 57'000U);
  EXPECT_TRUE(ParseFrame(frames[0]).more_ip_fragments);
  for (std::size_t i = 1; i < frames.size(); ++i) {
    const Frame frame = ParseFrame(frames[i]);
    EXPECT_EQ(frame.kind, FrameKind::kLaterIpFragment);
    EXPECT_EQ(frame.ip_id, 99);
    EXPECT_EQ(frame.more_ip_fragments, i + 1 < frames.size());
  }
}

TEST(FrameTest, LcmFragmentsTellTheSizeOfTheMessageAndTheFirstItsChannel) {
  const Bytes first_bytes = OneFrame(LcmFragment("LIDAR_POINTS", 200'000, 0, 4));
  const Bytes later_bytes = OneFrame(LcmFragment("LIDAR_POINTS", 200'000, 3, 4));

  const Frame first = ParseFrame(first_bytes);
  const Frame later = ParseFrame(later_bytes);

  EXPECT_EQ(first.kind, FrameKind::kFirstFragment);
  EXPECT_EQ(first.channel, "LIDAR_POINTS");
  EXPECT_EQ(first.message_bytes, 200'000U);
  EXPECT_EQ(later.kind, FrameKind::kLaterFragment);
  EXPECT_EQ(later.channel, "");
  EXPECT_EQ(later.sequence, first.sequence);
  EXPECT_EQ(later.message_bytes, 200'000U);
}

TEST(FrameTest, AFrameThatWasCutOffAnywhereIsNothing) {
  for (const Bytes& payload : {SmallMessage("DRIVE_PERMIT", 50), LcmFragment("A", 2000, 0, 2)}) {
    const Bytes bytes = OneFrame(payload, {.ip_option_bytes = 4});
    for (std::size_t length = 0; length < bytes.size(); ++length) {
      EXPECT_EQ(KindOf(std::span(bytes).first(length)), FrameKind::kOther) << length;
    }
  }
}

// The headers are whole and say so; what LCM needs behind them is not there.
TEST(FrameTest, ADatagramThatWasCutOffInTheHeadersIsNothing) {
  const Bytes small = SmallMessage("CHANNEL", 0);
  for (std::size_t length = 0; length < small.size(); ++length) {
    const Bytes payload(small.begin(), small.begin() + static_cast<std::ptrdiff_t>(length));
    EXPECT_EQ(KindOf(OneFrame(payload)), FrameKind::kOther) << length;
  }
  const Bytes fragment = LcmFragment("CHANNEL", 2000, 0, 2);
  for (std::size_t length = 0; length < 20 + sizeof("CHANNEL"); ++length) {
    const Bytes payload(fragment.begin(), fragment.begin() + static_cast<std::ptrdiff_t>(length));
    EXPECT_EQ(KindOf(OneFrame(payload)), FrameKind::kOther) << length;
  }
}

TEST(FrameTest, ChannelsHaveOneTo63Characters) {
  EXPECT_EQ(KindOf(OneFrame(SmallMessage(std::string(63, 'A'), 9))), FrameKind::kSmallMessage);
  EXPECT_EQ(KindOf(OneFrame(SmallMessage(std::string(64, 'A'), 9))), FrameKind::kOther);
  EXPECT_EQ(KindOf(OneFrame(SmallMessage("", 9))), FrameKind::kOther);
}

TEST(FrameTest, AFragmentNumberIsBelowTheirCount) {
  EXPECT_EQ(KindOf(OneFrame(LcmFragment("A", 2000, 1, 2))), FrameKind::kLaterFragment);
  EXPECT_EQ(KindOf(OneFrame(LcmFragment("A", 2000, 2, 2))), FrameKind::kOther);
  EXPECT_EQ(KindOf(OneFrame(LcmFragment("A", 2000, 0, 0))), FrameKind::kOther);
}

TEST(FrameTest, WhatIsNotIpv4UdpOrLcmIsOther) {
  const Bytes good = OneFrame(SmallMessage("A", 100));
  ASSERT_EQ(KindOf(good), FrameKind::kSmallMessage);
  const auto with = [&good](std::size_t at, unsigned value) {
    Bytes bytes = good;
    bytes[at] = static_cast<std::byte>(value);
    return bytes;
  };

  EXPECT_EQ(KindOf(with(12, 0x86)), FrameKind::kOther);  // Ethernet type.
  EXPECT_EQ(KindOf(with(14, 0x65)), FrameKind::kOther);  // IP version.
  EXPECT_EQ(KindOf(with(14, 0x44)), FrameKind::kOther);  // IP header of 16 bytes.
  EXPECT_EQ(KindOf(with(14, 0x4f)), FrameKind::kOther);  // 60 bytes: no LCM behind them.
  EXPECT_EQ(KindOf(with(16, 0xff)), FrameKind::kOther);  // IP length beyond the frame.
  EXPECT_EQ(KindOf(with(23, 6)), FrameKind::kOther);     // TCP.
  EXPECT_EQ(KindOf(with(38, 0xff)), FrameKind::kOther);  // UDP length beyond the packet.
  EXPECT_EQ(KindOf(with(42, 0)), FrameKind::kOther);     // LCM's magic.
}

TEST(FrameTest, AnyBytesAreAllowed) {
  std::mt19937 random(1);
  const Bytes good = OneFrame(LcmFragment("LIDAR_POINTS", 2000, 0, 2));
  for (int i = 0; i < 100'000; ++i) {
    Bytes bytes = good;
    bytes.resize(random() % 120);
    for (int k = 0; k < 4 && !bytes.empty(); ++k) {
      bytes[random() % bytes.size()] = static_cast<std::byte>(random());
    }

    const Frame frame = ParseFrame(bytes);

    EXPECT_LE(frame.channel.size(), 63U);
  }
}

}  // namespace
}  // namespace clearway::relay
