// SPDX-License-Identifier: BSD-3-Clause
#include "common/process/buses_config.hpp"

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

}  // namespace
}  // namespace clearway::process
