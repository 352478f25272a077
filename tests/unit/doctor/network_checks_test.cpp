// SPDX-License-Identifier: BSD-3-Clause
#include "tools/doctor/network_checks.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace clearway::doctor {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using Kind = Interface::Kind;

Interface Loopback(bool has_multicast = true) {
  return {"lo", Kind::kLoopback, true, has_multicast, {0x7f000001}};
}
Interface Wired(const std::string& name, std::uint32_t address = 0, bool is_up = true) {
  return {name,
          Kind::kWired,
          is_up,
          true,
          address == 0 ? std::vector<std::uint32_t>{} : std::vector{address}};
}
Interface Wireless() {
  return {"wlan0", Kind::kWireless, true, true, {}};
}

std::vector<Bus> OneBus(int ttl = 0) {
  process::BusesConfig config;
  config.local.ttl = config.shared.ttl = ttl;
  return BusesOf(config);
}

// The local bus, and a shared one that leaves the host.
std::vector<Bus> TwoBuses() {
  process::BusesConfig config;
  config.shared.url = "udpm://239.255.76.68:7668";
  config.shared.ttl = 1;
  return BusesOf(config);
}

const Route kByLo{"lo", {}};
const Route kNone{{}, "Network is unreachable"};

TEST(Buses, OfOneAddressAreOneWithTheLargerBuffer) {
  process::BusesConfig config;
  config.shared.receive_buffer_bytes = 9'000'000;

  const std::vector<Bus> buses = BusesOf(config);

  ASSERT_EQ(buses.size(), 1U);
  EXPECT_EQ(buses[0].name, "both buses");
  EXPECT_EQ(buses[0].group, "239.255.76.67");
  EXPECT_EQ(buses[0].port, 7667);
  EXPECT_EQ(buses[0].config.receive_buffer_bytes, 9'000'000);
}

TEST(Routes, ByLoWithMulticastAreGoodForABusThatStays) {
  const Findings findings = CheckRoutes({{OneBus()[0], kByLo}}, {Loopback()});

  ASSERT_EQ(findings.size(), 1U);
  EXPECT_EQ(findings[0].state, State::kOk) << findings[0].text;
  EXPECT_THAT(findings[0].mend, IsEmpty());
}

TEST(Routes, AMissingOneIsAddedOnLo) {
  const Findings findings = CheckRoutes({{OneBus()[0], kNone}}, {Loopback(false), Wired("eth0")});

  EXPECT_EQ(findings[0].state, State::kProblem);
  EXPECT_THAT(findings[0].text, HasSubstr("Network is unreachable"));
  EXPECT_THAT(
      findings[0].mend,
      ElementsAre("sudo ip link set lo multicast on", "sudo ip route add 224.0.0.0/4 dev lo"));
}

TEST(Routes, LoThatIsDownIsTakenUpFirst) {
  Interface lo = Loopback(false);
  lo.is_up = false;

  const Findings findings = CheckRoutes({{OneBus()[0], kNone}}, {lo});

  EXPECT_THAT(findings[0].mend,
              ElementsAre("sudo ip link set lo up",
                          "sudo ip link set lo multicast on",
                          "sudo ip route add 224.0.0.0/4 dev lo"));
}

TEST(Routes, AnInterfaceWithoutMulticastIsSwitchedOn) {
  const Findings findings = CheckRoutes({{OneBus()[0], kByLo}}, {Loopback(false)});

  EXPECT_EQ(findings[0].state, State::kProblem);
  EXPECT_THAT(findings[0].mend, ElementsAre("sudo ip link set lo multicast on"));
}

TEST(Routes, ABusThatLeavesTheHostMayNotGoByLo) {
  const std::vector<Bus> buses = TwoBuses();

  const Findings findings = CheckRoutes({{buses[0], kByLo}, {buses[1], kByLo}},
                                        {Loopback(), Wired("eth0", 0, false), Wireless()});

  ASSERT_EQ(findings.size(), 2U);
  EXPECT_EQ(findings[0].state, State::kOk) << "the local one stays";
  EXPECT_EQ(findings[1].state, State::kProblem);
  EXPECT_THAT(findings[1].text, HasSubstr("ttl=\"1\""));
  EXPECT_THAT(findings[1].mend, ElementsAre("sudo ip route replace 224.0.0.0/4 dev wlan0"))
      << "eth0 is down";
}

TEST(Routes, OneMissingRouteOfTwoBusesIsMendedOnceAndOutwards) {
  const std::vector<Bus> buses = TwoBuses();

  const Findings findings =
      CheckRoutes({{buses[0], kNone}, {buses[1], kNone}}, {Loopback(), Wireless(), Wired("eth0")});

  EXPECT_THAT(findings[0].mend, ElementsAre("sudo ip route add 224.0.0.0/4 dev eth0"));
  EXPECT_EQ(findings[1].state, State::kProblem);
  EXPECT_THAT(findings[1].mend, IsEmpty());
  EXPECT_THAT(findings[1].text, HasSubstr("the same commands mend it"));
}

TEST(Routes, WithNoInterfaceThatLeavesTheHostNoCommandHelps) {
  const Findings findings = CheckRoutes({{OneBus(1)[0], kNone}}, {Loopback()});

  EXPECT_EQ(findings[0].state, State::kProblem);
  EXPECT_THAT(findings[0].mend, IsEmpty());
  EXPECT_THAT(findings[0].text, HasSubstr("connect a network"));
}

TEST(Routes, ABusThatStaysIsWarnedOfWiFi) {
  const Findings findings =
      CheckRoutes({{OneBus()[0], {"wlan0", {}}}}, {Loopback(false), Wireless()});

  EXPECT_EQ(findings[0].state, State::kWarning);
  EXPECT_THAT(
      findings[0].mend,
      ElementsAre("sudo ip link set lo multicast on", "sudo ip route add 239.255.76.67/32 dev lo"));
}

TEST(Buffers, TooSmallALimitIsRaisedNowAndForGood) {
  const Finding finding = CheckBuffers(OneBus(), {212'992, 212'992});

  EXPECT_EQ(finding.state, State::kProblem);
  EXPECT_THAT(finding.mend,
              ElementsAre("sudo sysctl -w net.core.rmem_max=4194304",
                          "echo 'net.core.rmem_max = 4194304' | sudo tee "
                          "/etc/sysctl.d/60-clearway.conf"));
}

TEST(Buffers, EnoughIsGoodAndTheDefaultIsTold) {
  const Finding finding = CheckBuffers(OneBus(), {4'194'304, 212'992});

  EXPECT_EQ(finding.state, State::kOk);
  EXPECT_THAT(finding.text, HasSubstr("rmem_default: 212992"));
}

TEST(Buffers, AreNotJudgedWhereTheLimitCannotBeRead) {
  EXPECT_EQ(CheckBuffers(OneBus(), {}).state, State::kNotChecked);
}

TEST(Port, WhoHoldsItIsNamed) {
  const Finding finding =
      CheckPort(OneBus()[0], {7667, true, {}, {{123, "netcat"}, {124, "other"}}});

  EXPECT_EQ(finding.state, State::kProblem);
  EXPECT_THAT(finding.text, HasSubstr("netcat (process 123), other (process 124)"));
  EXPECT_THAT(finding.mend, ElementsAre("sudo kill 123", "sudo kill 124"));
}

TEST(Port, OfAnotherUserIsLookedForAsRoot) {
  EXPECT_THAT(CheckPort(OneBus()[0], {7667, true, {}, {}}).mend,
              ElementsAre("sudo ss -lunp 'sport = :7667'"));
}

TEST(Port, ThatCannotBeBoundSaysWhy) {
  const Finding finding = CheckPort(OneBus()[0], {80, false, "Permission denied", {}});

  EXPECT_EQ(finding.state, State::kProblem);
  EXPECT_THAT(finding.text, HasSubstr("Permission denied"));
}

TEST(LoopBack, ThatIsNotHeardIsAProblem) {
  EXPECT_EQ(CheckLoopBack(OneBus()[0], {true, {}}).state, State::kOk);

  const Finding finding = CheckLoopBack(OneBus()[0], {});
  EXPECT_EQ(finding.state, State::kProblem);
  EXPECT_THAT(finding.mend,
              ElementsAre("sudo iptables -I INPUT -p udp -d 239.255.76.67 --dport 7667 -j ACCEPT"));
}

TEST(Subnet, IsParsedStrictly) {
  EXPECT_TRUE(ParseSubnet("192.168.1.0/24")->Contains(0xc0a80164));
  EXPECT_FALSE(ParseSubnet("192.168.1.0/24")->Contains(0xc0a80264));
  EXPECT_TRUE(ParseSubnet("0.0.0.0/0")->Contains(0xc0a80264));
  for (const char* text : {"",
                           "192.168.1.0",
                           "192.168.1.0/",
                           "192.168.1.0/31",
                           "192.168.1.0/-1",
                           "192.168.1/24",
                           "192.168.1.0/24x",
                           "a/24"}) {
    EXPECT_EQ(ParseSubnet(text), std::nullopt) << text;
  }
}

TEST(SensorSubnet, IsGoodWhereAnInterfaceIsInIt) {
  const Finding finding =
      CheckSensorSubnet(*ParseSubnet("192.168.1.0/24"), {Loopback(), Wired("eth0", 0xc0a80105)});

  EXPECT_EQ(finding.state, State::kOk);
  EXPECT_THAT(finding.text, HasSubstr("eth0 has 192.168.1.5"));
}

TEST(SensorSubnet, IsGivenToTheFirstWiredInterfaceThatIsUp) {
  const Finding finding = CheckSensorSubnet(
      *ParseSubnet("192.168.1.0/24"),
      {Loopback(), Wireless(), Wired("eth0", 0, false), Wired("eth1", 0x0a000001)});

  EXPECT_EQ(finding.state, State::kWarning);
  EXPECT_THAT(finding.mend, ElementsAre("sudo ip addr add 192.168.1.50/24 dev eth1"));
}

TEST(SensorSubnet, OfAFewAddressesGetsOneOfThem) {
  EXPECT_THAT(CheckSensorSubnet(*ParseSubnet("10.0.0.8/29"), {Wired("eth0")}).mend,
              ElementsAre("sudo ip addr add 10.0.0.9/29 dev eth0"));
}

TEST(SensorSubnet, WithoutAWireSaysSo) {
  const Finding finding =
      CheckSensorSubnet(*ParseSubnet("192.168.1.0/24"), {Loopback(), Wireless()});

  EXPECT_EQ(finding.state, State::kWarning);
  EXPECT_THAT(finding.mend, IsEmpty());
}

}  // namespace
}  // namespace clearway::doctor
