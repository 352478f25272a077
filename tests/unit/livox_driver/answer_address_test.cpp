// SPDX-License-Identifier: BSD-3-Clause
#include "processes/livox_driver/answer_address.hpp"

#include <gtest/gtest.h>

namespace clearway {
namespace {

core::Ipv4 Ip(const char* text) {
  return *core::ParseIpv4(text);
}

const std::vector<net::Interface> kInterfaces = {
    {"lo", Ip("127.0.0.1"), Ip("255.0.0.0")},
    {"wlan0", Ip("192.168.7.20"), Ip("255.255.0.0")},
    {"eth0", Ip("192.168.1.50"), Ip("255.255.255.0")},
};

TEST(AnswerAddressTest, IsThatOfTheInterfaceInWhoseSubnetTheSensorIs) {
  EXPECT_EQ(AnswerAddressFor(Ip("127.0.0.2"), "", kInterfaces).ip, Ip("127.0.0.1"));
  EXPECT_EQ(AnswerAddressFor(Ip("192.168.9.1"), "", kInterfaces).ip, Ip("192.168.7.20"));
}

TEST(AnswerAddressTest, PrefersTheNarrowerSubnet) {
  EXPECT_EQ(AnswerAddressFor(Ip("192.168.1.101"), "", kInterfaces).ip, Ip("192.168.1.50"));
}

TEST(AnswerAddressTest, IsTheConfiguredOneAlsoForASensorElsewhere) {
  const AnswerAddress answer = AnswerAddressFor(Ip("10.0.0.2"), "192.168.7.20", kInterfaces);

  EXPECT_EQ(answer.ip, Ip("192.168.7.20"));
  EXPECT_EQ(answer.problem, "");
}

TEST(AnswerAddressTest, AnotherSubnetIsToldWithWhatThisHostHas) {
  const AnswerAddress answer = AnswerAddressFor(Ip("10.0.0.2"), "", kInterfaces);

  EXPECT_EQ(answer.ip, std::nullopt);
  EXPECT_EQ(answer.problem,
            "10.0.0.2 is in another subnet than this host, which has 127.0.0.1 (lo), 192.168.7.20 "
            "(wlan0), 192.168.1.50 (eth0): give this host an address there, or set "
            "livox_driver.host_ip");
}

TEST(AnswerAddressTest, AConfiguredAddressThatIsNotOfThisHostIsTold) {
  const AnswerAddress answer = AnswerAddressFor(Ip("192.168.1.101"), "192.168.1.51", kInterfaces);

  EXPECT_EQ(answer.ip, std::nullopt);
  EXPECT_EQ(answer.problem,
            "livox_driver.host_ip 192.168.1.51 is no address of this host, which has 127.0.0.1 "
            "(lo), 192.168.7.20 (wlan0), 192.168.1.50 (eth0)");
}

TEST(AnswerAddressTest, AHostWithoutAnyAddressSaysSo) {
  EXPECT_NE(AnswerAddressFor(Ip("10.0.0.2"), "", {}).problem.find("which has no address"),
            std::string::npos);
}

}  // namespace
}  // namespace clearway
