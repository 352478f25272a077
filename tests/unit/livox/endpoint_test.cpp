// SPDX-License-Identifier: BSD-3-Clause
#include "common/core/endpoint.hpp"

#include <random>

#include <gtest/gtest.h>

namespace clearway::core {
namespace {

TEST(Endpoint, AddressesComeBackFromTheirText) {
  std::mt19937 random(10);
  for (int i = 0; i < 2000; ++i) {
    const auto ip = static_cast<Ipv4>(random());

    EXPECT_EQ(ParseIpv4(ToString(ip)), ip);
  }
  EXPECT_EQ(ParseIpv4("192.168.1.50"), 0xC0A80132U);
  EXPECT_EQ(ParseIpv4("0.0.0.0"), kAnyIpv4);
  EXPECT_EQ(ParseIpv4("255.255.255.255"), kBroadcastIpv4);
  EXPECT_EQ(ToString(Endpoint{0xC0A80132, 65000}), "192.168.1.50:65000");
}

TEST(Endpoint, WhatIsNoAddressIsRefused) {
  for (const char* text : {"",          ".",          "1",         "1.2.3",    "1.2.3.",
                           "1.2.3.4.",  "1.2.3.4.5",  ".1.2.3.4",  "1..2.3",   "256.1.1.1",
                           "1.2.3.256", "1.2.3.0004", "-1.2.3.4",  "+1.2.3.4", " 1.2.3.4",
                           "1.2.3.4 ",  "1.2.3.x",    "0x1.2.3.4", "1,2,3,4",  "99999999999.1.1.1",
                           "localhost"}) {
    EXPECT_FALSE(ParseIpv4(text)) << text;
  }
}

}  // namespace
}  // namespace clearway::core
