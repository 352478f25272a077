// SPDX-License-Identifier: BSD-3-Clause
#include "tools/relay/traffic.hpp"

#include <gtest/gtest.h>

#include "tests/unit/relay/frame_maker.hpp"

namespace clearway::relay {
namespace {

std::size_t CountAll(TrafficMeter& meter, const std::vector<Bytes>& frames) {
  std::size_t bytes = 0;
  for (const Bytes& frame : frames) {
    meter.Count(frame);
    bytes += frame.size();
  }
  return bytes;
}

TEST(TrafficTest, MessagesAreCountedByChannelAndPort) {
  TrafficMeter meter;
  for (int i = 0; i < 3; ++i) meter.Count(OneFrame(SmallMessage("A", 10)));
  meter.Count(OneFrame(SmallMessage("A", 20)));
  meter.Count(OneFrame(SmallMessage("A", 30), {.destination_port = 7668}));
  meter.Count(OneFrame(SmallMessage("B", 40)));

  ASSERT_EQ(meter.channels().size(), 3U);
  const ChannelTraffic& a = meter.channels().at({"A", 7667});
  EXPECT_EQ(a.messages, 4U);
  EXPECT_EQ(a.frames, 4U);
  EXPECT_EQ(a.largest_message_bytes, 20U);
  EXPECT_EQ(a.bytes, 4U * (14 + 20 + 8 + 8 + 2) + 3 * 10 + 20);
  EXPECT_EQ(meter.channels().at({"A", 7668}).messages, 1U);
  EXPECT_EQ(meter.channels().at({"B", 7667}).messages, 1U);
  EXPECT_EQ(meter.other().frames, 0U);
}

TEST(TrafficTest, IpFragmentsBelongToTheirMessage) {
  TrafficMeter meter;

  const std::size_t bytes = CountAll(meter, Frames(SmallMessage("A", 57'000)));

  const ChannelTraffic& a = meter.channels().at({"A", 7667});
  EXPECT_EQ(a.messages, 1U);
  EXPECT_EQ(a.frames, 39U);
  EXPECT_EQ(a.bytes, bytes);
  EXPECT_EQ(meter.other().frames, 0U);
}

TEST(TrafficTest, FragmentsOfSeveralSendersAtOnceAreKeptApart) {
  TrafficMeter meter;
  const std::vector<Bytes> a = Frames(SmallMessage("A", 20'000), {.source_ip = 1, .ip_id = 1});
  const std::vector<Bytes> b = Frames(SmallMessage("B", 20'000), {.source_ip = 1, .ip_id = 2});
  for (std::size_t i = 0; i < a.size(); ++i) {
    meter.Count(a[i]);
    meter.Count(b[i]);
  }
  // The same identification of another sender takes over the place; it is not mixed up.
  meter.Count(Frames(SmallMessage("C", 20'000), {.source_ip = 3, .ip_id = 1}).front());
  meter.Count(a.back());

  EXPECT_EQ(meter.channels().at({"A", 7667}).frames, a.size());
  EXPECT_EQ(meter.channels().at({"B", 7667}).frames, b.size());
  EXPECT_EQ(meter.channels().at({"C", 7667}).frames, 1U);
  EXPECT_EQ(meter.other().frames, 1U);
}

TEST(TrafficTest, LcmFragmentsBelongToTheirMessage) {
  TrafficMeter meter;
  for (std::uint16_t number = 0; number < 4; ++number) {
    // Each datagram is split by IP, too.
    const Datagram datagram{.ip_id = static_cast<std::uint16_t>(10 + number),
                            .bytes_per_frame = 504};
    CountAll(meter, Frames(LcmFragment("A", 4000, number, 4), datagram));
  }

  const ChannelTraffic& a = meter.channels().at({"A", 7667});
  EXPECT_EQ(a.messages, 1U);
  EXPECT_EQ(a.frames, 4U * 3);
  EXPECT_EQ(a.largest_message_bytes, 4000U);
  EXPECT_EQ(meter.other().frames, 0U);
}

TEST(TrafficTest, AFragmentWhoseFirstWasNotSeenIsOther) {
  TrafficMeter meter;
  meter.Count(Frames(SmallMessage("A", 20'000)).back());
  meter.Count(OneFrame(LcmFragment("A", 4000, 1, 4)));
  meter.Count(Bytes(60, std::byte{1}));

  EXPECT_TRUE(meter.channels().empty());
  EXPECT_EQ(meter.other().frames, 3U);
}

TEST(TrafficTest, AnIntervalCountsFromItsStart) {
  TrafficMeter meter;
  meter.Count(OneFrame(SmallMessage("A", 10)));
  meter.StartInterval();
  const Bytes frame = OneFrame(SmallMessage("A", 20));
  meter.Count(frame);

  const ChannelTraffic& a = meter.channels().at({"A", 7667});
  EXPECT_EQ(a.messages, 2U);
  EXPECT_EQ(a.interval_messages, 1U);
  EXPECT_EQ(a.interval_bytes, frame.size());
}

TEST(TrafficTest, TheNumberOfChannelsIsBounded) {
  TrafficMeter meter;
  for (int i = 0; i < 1500; ++i) {
    CountAll(meter, Frames(SmallMessage("CHANNEL_" + std::to_string(i), 2000)));
  }

  EXPECT_EQ(meter.channels().size(), 1000U);
  EXPECT_EQ(meter.other().messages, 500U);
  EXPECT_EQ(meter.other().frames, 1000U);
}

}  // namespace
}  // namespace clearway::relay
