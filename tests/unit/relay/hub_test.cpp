// SPDX-License-Identifier: BSD-3-Clause
#include "tools/relay/hub.hpp"

#include <memory>
#include <stdexcept>
#include <utility>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/unit/relay/frame_maker.hpp"

namespace clearway::relay {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

// A hub of three ports; `sent` has port and first byte of what went out.
class HubTest : public testing::Test {
 protected:
  explicit HubTest(Hub::Settings settings = {})
      : hub_({"a", "b", "c"}, settings, [this](std::size_t port, auto packet) {
          if (port == refusing_port_) return false;
          sent_.emplace_back(port, std::to_integer<int>(packet.front()));
          return true;
        }) {}

  void Tell(const char* line) { hub_.Follow(ParseCommand(line)); }
  void Receive(std::size_t port, int mark, std::int64_t now_ns) {
    hub_.OnPacket(port, Bytes(60, static_cast<std::byte>(mark)), now_ns);
  }
  std::vector<std::pair<std::size_t, int>> TakeSent() { return std::exchange(sent_, {}); }
  const Hub::Direction& DirectionOf(std::size_t from, std::size_t to) {
    for (const Hub::Direction& direction : hub_.directions()) {
      if (direction.from == from && direction.to == to) return direction;
    }
    throw std::out_of_range("no such direction");
  }

  std::size_t refusing_port_ = 99;
  std::vector<std::pair<std::size_t, int>> sent_;
  Hub hub_;
};

std::pair<std::size_t, int> Sent(std::size_t port, int mark) {
  return {port, mark};
}

TEST_F(HubTest, AFrameGoesToAllOtherPortsAtOnce) {
  Receive(1, 7, 100);

  EXPECT_THAT(TakeSent(), ElementsAre(Sent(0, 7), Sent(2, 7)));
  EXPECT_EQ(hub_.ports()[1].in_frames, 1U);
  EXPECT_EQ(hub_.ports()[1].in_bytes, 60U);
  EXPECT_EQ(hub_.ports()[1].out_frames, 0U);
  EXPECT_EQ(hub_.ports()[2].out_bytes, 60U);
  EXPECT_EQ(DirectionOf(1, 0).delivered, 1U);
  EXPECT_FALSE(hub_.next_due_ns());
}

TEST_F(HubTest, AFaultIsForItsDirectionOnly) {
  Tell("loss 1 a:b");
  Receive(0, 1, 0);
  Receive(1, 2, 0);

  EXPECT_THAT(TakeSent(), ElementsAre(Sent(2, 1), Sent(0, 2), Sent(2, 2)));
  EXPECT_EQ(DirectionOf(0, 1).lost, 1U);

  Tell("loss 0");
  Tell("loss 1 *:a");
  Receive(0, 1, 0);
  Receive(1, 2, 0);
  Receive(2, 3, 0);

  EXPECT_THAT(TakeSent(), ElementsAre(Sent(1, 1), Sent(2, 1), Sent(2, 2), Sent(1, 3)));
}

TEST_F(HubTest, WhatIsDelayedLeavesWhenItIsDue) {
  Tell("delay-ms 5 a:b");
  Receive(0, 1, 1'000'000);

  EXPECT_THAT(TakeSent(), ElementsAre(Sent(2, 1)));
  EXPECT_EQ(hub_.next_due_ns(), 6'000'000);
  hub_.SendDue(5'999'999);
  EXPECT_THAT(TakeSent(), IsEmpty());
  hub_.SendDue(6'000'000);
  EXPECT_THAT(TakeSent(), ElementsAre(Sent(1, 1)));
  EXPECT_FALSE(hub_.next_due_ns());
}

TEST_F(HubTest, NothingOvertakesWhatIsDelayed) {
  Tell("delay-ms 5");
  Receive(0, 1, 0);
  Tell("delay-ms 0");
  Receive(0, 2, 1'000'000);  // Would be due before the first one.
  EXPECT_THAT(TakeSent(), IsEmpty());
  Receive(0, 3, 5'000'000);  // Comes in before what is due by then has left.

  EXPECT_THAT(TakeSent(),
              ElementsAre(Sent(1, 1), Sent(2, 1), Sent(1, 2), Sent(2, 2), Sent(1, 3), Sent(2, 3)));
}

TEST_F(HubTest, ADuplicateComesRightBehind) {
  Tell("duplicate 1 a:b");
  Receive(0, 1, 0);

  EXPECT_THAT(TakeSent(), ElementsAre(Sent(1, 1), Sent(1, 1), Sent(2, 1)));
  EXPECT_EQ(DirectionOf(0, 1).duplicated, 1U);
  EXPECT_EQ(DirectionOf(0, 1).delivered, 2U);
}

TEST_F(HubTest, ACutPortNeitherReceivesNorSends) {
  Tell("cut b");
  Receive(0, 1, 0);
  Receive(1, 2, 0);

  EXPECT_THAT(TakeSent(), ElementsAre(Sent(2, 1)));
  EXPECT_EQ(DirectionOf(0, 1).cut, 1U);
  EXPECT_EQ(DirectionOf(1, 0).cut, 1U);
  EXPECT_TRUE(hub_.ports()[1].is_cut);

  Tell("mend b");
  Receive(0, 3, 0);

  EXPECT_THAT(TakeSent(), ElementsAre(Sent(1, 3), Sent(2, 3)));
}

TEST_F(HubTest, WhatIsOnItsWayToAPortThatIsCutIsLost) {
  Tell("delay-ms 5");
  Receive(0, 1, 0);
  Tell("cut b");
  hub_.SendDue(5'000'000);

  EXPECT_THAT(TakeSent(), ElementsAre(Sent(2, 1)));
  EXPECT_EQ(DirectionOf(0, 1).cut, 1U);
}

TEST_F(HubTest, WhatAPortDoesNotTakeIsCounted) {
  refusing_port_ = 1;
  Receive(0, 1, 0);

  EXPECT_EQ(hub_.ports()[1].refused, 1U);
  EXPECT_EQ(hub_.ports()[1].out_frames, 0U);
  EXPECT_EQ(DirectionOf(0, 1).delivered, 0U);
  EXPECT_EQ(DirectionOf(0, 2).delivered, 1U);
}

TEST_F(HubTest, APortThatIsNotThereIsRefused) {
  for (const char* line : {"cut d", "loss 1 d:a", "loss 1 a:d", "loss 1 a:a", "mend *"}) {
    EXPECT_THROW(Tell(line), CommandError) << line;
  }
}

class NarrowHubTest : public HubTest {
 protected:
  NarrowHubTest() : HubTest({.max_delayed_bytes = 150}) {}
};

TEST_F(NarrowHubTest, WhatDoesNotFitIntoTheDelayLineIsDroppedAndCounted) {
  Tell("delay-ms 5");
  for (int i = 0; i < 3; ++i) Receive(0, i, i);
  hub_.SendDue(10'000'000);

  EXPECT_THAT(TakeSent(), ElementsAre(Sent(1, 0), Sent(2, 0)));
  EXPECT_EQ(DirectionOf(0, 1).overflowed, 2U);
  EXPECT_EQ(DirectionOf(0, 2).overflowed, 2U);
}

class HeaderHubTest : public HubTest {
 protected:
  HeaderHubTest() : HubTest({.packet_header_bytes = 10}) {}
};

TEST_F(HeaderHubTest, TheSocketsOwnBytesBeforeAFrameArePassedOnAndNotCounted) {
  Bytes packet(10, std::byte{42});
  packet = Joined(std::move(packet), OneFrame(SmallMessage("A", 5)));
  hub_.OnPacket(0, packet, 0);

  EXPECT_THAT(TakeSent(), ElementsAre(Sent(1, 42), Sent(2, 42)));
  EXPECT_EQ(hub_.ports()[0].in_bytes, packet.size() - 10);
  EXPECT_EQ(hub_.ports()[1].out_bytes, packet.size() - 10);
  EXPECT_EQ(hub_.ports()[0].traffic.channels().at({"A", 7667}).messages, 1U);

  hub_.OnPacket(0, Bytes(9), 0);
  EXPECT_THAT(TakeSent(), IsEmpty());
}

TEST(HubSetUpTest, ItTakesTwoPortsOfDifferentNames) {
  const auto make = [](const std::vector<std::string>& names) {
    return std::make_unique<Hub>(names, Hub::Settings{}, [](std::size_t, auto) { return true; });
  };

  EXPECT_NO_THROW(make({"a", "b"}));
  EXPECT_THROW(make({"a"}), std::invalid_argument);
  EXPECT_THROW(make({"a", "b", "a"}), std::invalid_argument);
}

// What one direction loses does not depend on the traffic of another.
TEST(HubSeedTest, EachDirectionHasRandomNumbersOfItsOwn) {
  const auto lost = [](bool with_traffic_back) {
    std::string result;
    Hub hub({"a", "b"}, {.seed = 3}, [&](std::size_t port, auto) {
      if (port == 1) result.back() = '1';
      return true;
    });
    hub.Follow(ParseCommand("loss 0.5"));
    for (int i = 0; i < 100; ++i) {
      if (with_traffic_back) hub.OnPacket(1, Bytes(60), 0);
      result += '0';
      hub.OnPacket(0, Bytes(60), 0);
    }
    return result;
  };

  EXPECT_EQ(lost(false), lost(true));
  EXPECT_THAT(lost(true), testing::HasSubstr("1"));
  EXPECT_THAT(lost(true), testing::HasSubstr("0"));
}

}  // namespace
}  // namespace clearway::relay
