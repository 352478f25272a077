// SPDX-License-Identifier: BSD-3-Clause
#include "common/process/buses_config.hpp"

#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

namespace clearway::process {
namespace {

TEST(PortOfTest, ReadsThePortOfAMulticastAddress) {
  EXPECT_EQ(PortOf("udpm://239.255.76.67:7667"), 7667);
}

TEST(PortOfTest, RefusesWhatIsNotAMulticastAddressWithAPort) {
  for (const char* url : {"",
                          "udpm://",
                          "udpm://:7667",
                          "udpm://239.255.76.67",
                          "udpm://239.255.76.67:",
                          "udpm://239.255.76.67:0",
                          "udpm://239.255.76.67:65536",
                          "udpm://239.255.76.67:7667x",
                          "udpm://239.255.76.67:7667?ttl=1",
                          "udpm://192.168.1.1:7667",
                          "tcpq://239.255.76.67:7667"}) {
    EXPECT_EQ(PortOf(url), -1) << url;
  }
}

TEST(BusesConfigTest, DefaultsAreOneBusThatStaysOnTheHost) {
  EXPECT_TRUE(BusesConfig{}.Validate().empty());
}

TEST(BusesConfigTest, TheLocalBusNeverLeavesTheHost) {
  BusesConfig buses;
  buses.local.ttl = 1;

  EXPECT_FALSE(buses.Validate().empty());
}

TEST(BusesConfigTest, ASharedBusThatLeavesTheHostNeedsAPortOfItsOwn) {
  BusesConfig buses;
  buses.shared.ttl = 1;
  EXPECT_FALSE(buses.Validate().empty());

  buses.shared.url = "udpm://239.255.76.68:7667";
  EXPECT_FALSE(buses.Validate().empty());

  buses.shared.url = "udpm://239.255.76.67:7668";
  EXPECT_TRUE(buses.Validate().empty());
}

TEST(BusFromUrlTest, TakesWhatLcmsOwnProgramsTake) {
  const BusConfig bus = BusFromUrl("udpm://239.255.76.68:7668?ttl=1&recv_buf_size=100000");

  EXPECT_EQ(bus.url, "udpm://239.255.76.68:7668");
  EXPECT_EQ(bus.ttl, 1);
  EXPECT_EQ(bus.receive_buffer_bytes, 100'000);
  EXPECT_EQ(bus.max_message_bytes, 1400) << "it leaves the host";
  for (const char* url : {"udpm://", "udpm://:7667", "udpm://239.255.76.67", "udpm://?ttl=0"}) {
    EXPECT_EQ(BusFromUrl(url).url, BusConfig{}.url) << url;
    EXPECT_EQ(BusFromUrl(url).ttl, 0) << url;
    EXPECT_EQ(BusFromUrl(url).max_message_bytes, BusConfig{}.max_message_bytes) << url;
  }
}

TEST(BusFromUrlTest, KeepsTheDefaultsOfWhatTheUrlDoesNotSay) {
  BusConfig defaults;
  defaults.receive_buffer_bytes = 70'000;
  defaults.ttl = 3;

  EXPECT_EQ(BusFromUrl("udpm://239.255.76.67:7668", defaults).receive_buffer_bytes, 70'000);
  EXPECT_EQ(BusFromUrl("udpm://239.255.76.67:7668", defaults).ttl, 3);
}

TEST(BusFromUrlTest, NamesWhatIsWrong) {
  for (const auto& [url, what] : std::vector<std::pair<std::string, std::string>>{
           {"tcpq://localhost:7667", "expected udpm://GROUP:PORT?ttl=N"},
           {"", "expected udpm://GROUP:PORT?ttl=N"},
           {"udpm://10.0.0.1:7667", "expected udpm://GROUP:PORT with an IPv4 multicast group"},
           {"udpm://239.255.76.67:0", "a port in [1, 65535]"},
           {"udpm://239.255.76.67:7667?ttl=256",
            "ttl=\"256\": expected a whole number in [0, 255]"},
           {"udpm://239.255.76.67:7667?ttl=-1", "ttl=\"-1\""},
           {"udpm://239.255.76.67:7667?ttl", "ttl=\"\""},
           {"udpm://239.255.76.67:7667?tlt=1",
            "unknown option \"tlt\"; known: ttl, recv_buf_size"}}) {
    try {
      (void)BusFromUrl(url);
      ADD_FAILURE() << url;
    } catch (const std::invalid_argument& error) {
      EXPECT_NE(std::string(error.what()).find(what), std::string::npos) << error.what();
    }
  }
}

}  // namespace
}  // namespace clearway::process
