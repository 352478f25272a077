// SPDX-License-Identifier: BSD-3-Clause
// What the reference procman sent, taken from one of its sessions.
#include <map>
#include <string>

#include <gtest/gtest.h>

#include "common/io/lcm_log.hpp"
#include "common/messages/channels.hpp"
#include "common/messages/encoding.hpp"
#include "tests/support/test_data.hpp"

namespace clearway::messages {
namespace {

constexpr const char* kSession = "lcm/procman_ref_session.lcmlog";

// Decodes an event of this channel and expects its bytes back; false for another channel's event.
template <typename Message>
bool ComesBack(const Channel<Message>& channel, const io::LogEvent& event) {
  if (event.channel != channel.name) return false;
  const auto message = Decode<Message>(event.bytes);
  EXPECT_TRUE(message.has_value()) << event.channel;
  if (message) {
    EXPECT_EQ(Encode(*message), event.bytes) << event.channel;
  }
  return true;
}

TEST(RecordedLogsTest, EveryMessageOfTheReferenceProcmanComesBackByteForByte) {
  const auto path = test::TestData(kSession);
  if (!path) GTEST_SKIP() << test::MissingData(kSession);
  io::LcmLogReader log(*path);

  std::map<std::string, int> events;
  while (const auto event = log.Next()) {
    ++events[event->channel];
    EXPECT_TRUE(ComesBack(channels::kPmInfo, *event) || ComesBack(channels::kPmOrders, *event) ||
                ComesBack(channels::kPmOutput, *event) || ComesBack(channels::kPmDiscover, *event))
        << event->channel;
  }

  const std::map<std::string, int> expected = {
      {"PM_DISCOVER", 5}, {"PM_INFO", 23}, {"PM_ORDERS", 11}, {"PM_OUTPUT", 9}};
  EXPECT_EQ(events, expected);
}

}  // namespace
}  // namespace clearway::messages
