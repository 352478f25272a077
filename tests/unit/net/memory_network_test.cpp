// SPDX-License-Identifier: BSD-3-Clause
#include "common/net/memory_network.hpp"

#include <cstring>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <gmock/gmock.h>

#include "common/process/simulated_runtime.hpp"

namespace clearway::net {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::SizeIs;

constexpr std::int64_t kStart_us = 1'000'000;
constexpr Ipv4 kHost = 0xC0A80132;     // 192.168.1.50
constexpr Ipv4 kSensor = 0xC0A80165;   // 192.168.1.101
constexpr Ipv4 kForeign = 0xC0A80205;  // 192.168.2.5
constexpr Ipv4 kLocal = 0x7F000001;
constexpr Ipv4 kLocalTwo = 0x7F000002;

std::span<const std::byte> BytesOf(std::string_view text) {
  return std::as_bytes(std::span(text.data(), text.size()));
}

struct Arrival {
  std::string text;
  Endpoint from;
  std::int64_t utime = 0;
};

// A socket that keeps what arrives.
class Listener {
 public:
  Listener(Network& network, const SocketSettings& settings)
      : socket_(network.Open(settings, [this](std::span<const Datagram> datagrams) {
          batches.push_back(datagrams.size());
          for (const Datagram& datagram : datagrams) {
            std::string text(datagram.bytes.size(), '\0');
            if (!text.empty()) std::memcpy(text.data(), datagram.bytes.data(), text.size());
            arrivals.push_back({std::move(text), datagram.from, datagram.arrival_utime});
          }
        })) {}
  Listener(Network& network, Ipv4 ip, std::uint16_t port)
      : Listener(network, {.bind = {ip, port}, .can_broadcast = true}) {}

  [[nodiscard]] std::vector<std::string> texts() const {
    std::vector<std::string> all;
    for (const Arrival& arrival : arrivals) all.push_back(arrival.text);
    return all;
  }
  Socket& socket() { return *socket_; }
  bool Send(const Endpoint& to, std::string_view text) { return socket_->Send(to, BytesOf(text)); }

  std::vector<Arrival> arrivals;
  std::vector<std::size_t> batches;

 private:
  std::unique_ptr<Socket> socket_;
};

class MemoryNetworkTest : public testing::Test {
 protected:
  void Run(std::int64_t duration_us = 1) { runtime_.RunUntil(runtime_.UtimeNow() + duration_us); }

  process::SimulatedRuntime runtime_{kStart_us, {}};
  MemoryWire wire_{runtime_};
  MemoryHost host_{wire_, {kHost}};
  MemoryHost sensor_{wire_, {kSensor}};
};

TEST_F(MemoryNetworkTest, DeliversWhatIsSentToABoundAddressAfterTheSenderHasReturned) {
  Listener receiver(host_, kHost, 56001);
  Listener sender(sensor_, kSensor, 60001);

  EXPECT_TRUE(sender.Send({kHost, 56001}, "points"));
  EXPECT_THAT(receiver.arrivals, IsEmpty());
  Run();

  ASSERT_THAT(receiver.arrivals, SizeIs(1));
  EXPECT_EQ(receiver.arrivals[0].text, "points");
  EXPECT_EQ(receiver.arrivals[0].from, (Endpoint{kSensor, 60001}));
  EXPECT_EQ(receiver.arrivals[0].utime, kStart_us);
  EXPECT_EQ(sender.socket().counts().sent, 1);
  EXPECT_EQ(receiver.socket().counts().received, 1);
}

TEST_F(MemoryNetworkTest, DeliversToASocketThatListensOnAllAddresses) {
  Listener receiver(host_, core::kAnyIpv4, 56001);
  Listener sender(sensor_, core::kAnyIpv4, 60001);

  sender.Send({kHost, 56001}, "points");
  Run();

  ASSERT_THAT(receiver.arrivals, SizeIs(1));
  EXPECT_EQ(receiver.arrivals[0].from, (Endpoint{kSensor, 60001}));
}

TEST_F(MemoryNetworkTest, KeepsTheOrderAndHandsOnTogetherWhatArrivesTogether) {
  Listener data(host_, kHost, 56001);
  Listener command(host_, kHost, 55501);
  Listener sender(sensor_, kSensor, 65000);

  for (const char* text : {"a", "b", "c"}) sender.Send({kHost, 56001}, text);
  sender.Send({kHost, 55501}, "ack");
  sender.Send({kHost, 56001}, "d");
  Run();

  EXPECT_THAT(data.texts(), ElementsAre("a", "b", "c", "d"));
  EXPECT_THAT(data.batches, ElementsAre(3, 1));
  EXPECT_THAT(command.texts(), ElementsAre("ack"));
}

TEST_F(MemoryNetworkTest, AnAnswerFromWithinAHandlerArrivesAtTheSameMoment) {
  std::unique_ptr<Socket> echo;
  echo = sensor_.Open({.bind = {kSensor, 65000}}, [&echo](std::span<const Datagram> datagrams) {
    for (const Datagram& datagram : datagrams) echo->Send(datagram.from, datagram.bytes);
  });
  Listener asker(host_, kHost, 55501);

  asker.Send({kSensor, 65000}, "heartbeat");
  Run();

  ASSERT_THAT(asker.arrivals, SizeIs(1));
  EXPECT_EQ(asker.arrivals[0].text, "heartbeat");
  EXPECT_EQ(asker.arrivals[0].utime, kStart_us);
}

TEST_F(MemoryNetworkTest, ABroadcastReachesAllHostsThatListenOnThePort) {
  MemoryHost other(wire_, {kForeign});
  Listener here(host_, core::kAnyIpv4, 55000);
  Listener there(other, core::kAnyIpv4, 55000);
  Listener own(sensor_, core::kAnyIpv4, 55000);
  Listener other_port(other, core::kAnyIpv4, 55001);
  Listener bound_to_one_address(host_, kHost, 55002);
  Listener sender(sensor_, kSensor, 65000);

  EXPECT_TRUE(sender.Send({core::kBroadcastIpv4, 55000}, "hello"));
  EXPECT_TRUE(sender.Send({core::kBroadcastIpv4, 55002}, "not for one address"));
  Run();

  for (Listener* listener : {&here, &there, &own}) {
    ASSERT_THAT(listener->texts(), ElementsAre("hello"));
    EXPECT_EQ(listener->arrivals[0].from, (Endpoint{kSensor, 65000}));
  }
  EXPECT_THAT(other_port.arrivals, IsEmpty());
  EXPECT_THAT(bound_to_one_address.arrivals, IsEmpty());
}

TEST_F(MemoryNetworkTest, RefusesABroadcastFromASocketThatMayNot) {
  Listener listener(host_, core::kAnyIpv4, 55000);
  Listener shy(sensor_, {.bind = {kSensor, 65000}});

  EXPECT_FALSE(shy.Send({core::kBroadcastIpv4, 55000}, "hello"));
  Run();

  EXPECT_THAT(listener.arrivals, IsEmpty());
  EXPECT_EQ(shy.socket().counts().send_failures, 1);
  EXPECT_EQ(shy.socket().counts().sent, 0);
}

TEST_F(MemoryNetworkTest, EveryHostHasALoopbackOfItsOwn) {
  Listener here(host_, core::kAnyIpv4, 55000);
  Listener elsewhere(sensor_, core::kAnyIpv4, 55000);
  Listener emulated(host_, kLocalTwo, 65000);

  EXPECT_TRUE(emulated.Send({kLocal, 55000}, "hello"));
  EXPECT_FALSE(emulated.Send({kSensor, 55000}, "from loopback to the outside"));
  Run();

  ASSERT_THAT(here.texts(), ElementsAre("hello"));
  EXPECT_EQ(here.arrivals[0].from, (Endpoint{kLocalTwo, 65000}));
  EXPECT_THAT(elsewhere.arrivals, IsEmpty());
}

TEST_F(MemoryNetworkTest, RefusesWhatNoInterfaceReachesAndWhatUdpCannotCarry) {
  Listener sender(host_, kHost, 1000);
  const std::string too_long(MemoryHost::kMaxUdpBytes + 1, 'x');

  EXPECT_FALSE(sender.Send({kForeign, 65000}, "hello"));
  EXPECT_FALSE(sender.Send({kSensor, 0}, "hello"));
  EXPECT_FALSE(sender.Send({kSensor, 65000}, too_long));
  EXPECT_TRUE(sender.Send({kSensor, 65000}, "nobody listens"));

  EXPECT_EQ(sender.socket().counts().send_failures, 3);
  EXPECT_EQ(sender.socket().counts().sent, 1);
}

TEST_F(MemoryNetworkTest, CountsWhatIsTooLongForAReceiver) {
  Listener receiver(host_, kHost, 56001);
  Listener sender(sensor_, kSensor, 60001);

  sender.Send({kHost, 56001}, std::string(kMaxDatagramBytes + 1, 'x'));
  sender.Send({kHost, 56001}, std::string(kMaxDatagramBytes, 'y'));
  Run();

  ASSERT_THAT(receiver.arrivals, SizeIs(1));
  EXPECT_EQ(receiver.arrivals[0].text.front(), 'y');
  EXPECT_EQ(receiver.socket().counts().truncated, 1);
}

TEST_F(MemoryNetworkTest, APortIsBoundOnceOnOverlappingAddresses) {
  const auto open = [](MemoryHost& host, Ipv4 ip) {
    return host.Open({.bind = {ip, 55000}}, [](std::span<const Datagram>) {});
  };
  auto first = open(host_, kHost);

  EXPECT_THROW((void)open(host_, kHost), NetworkError);
  EXPECT_THROW((void)open(host_, core::kAnyIpv4), NetworkError);
  EXPECT_NO_THROW((void)open(host_, kLocal));
  EXPECT_NO_THROW((void)open(sensor_, core::kAnyIpv4));
  first.reset();
  const auto all = open(host_, core::kAnyIpv4);
  EXPECT_THROW((void)open(host_, kHost), NetworkError);
}

TEST_F(MemoryNetworkTest, SaysWhichAddressIsNotTheHosts) {
  try {
    (void)host_.Open({.bind = {kSensor, 65000}}, [](std::span<const Datagram>) {});
    FAIL() << "an address of another host was bound";
  } catch (const NetworkError& error) {
    EXPECT_THAT(error.what(), HasSubstr("192.168.1.101:65000"));
  }
}

TEST_F(MemoryNetworkTest, PortZeroTakesAFreeOne) {
  const auto first = host_.Open({.bind = {kHost, 0}}, [](std::span<const Datagram>) {});
  const auto second = host_.Open({.bind = {kHost, 0}}, [](std::span<const Datagram>) {});

  EXPECT_NE(first->local().port, 0);
  EXPECT_NE(first->local().port, second->local().port);
}

TEST_F(MemoryNetworkTest, ASocketThatIsClosedGetsNothingEvenFromWhatIsUnderWay) {
  auto receiver = std::make_unique<Listener>(host_, kHost, 56001);
  Listener sender(sensor_, kSensor, 60001);
  std::vector<std::string> heard;
  std::unique_ptr<Socket> one_shot;
  one_shot = host_.Open({.bind = {kHost, 56002}}, [&](std::span<const Datagram>) {
    heard.emplace_back("one");
    one_shot.reset();
  });

  sender.Send({kHost, 56001}, "lost");
  receiver.reset();
  sender.Send({kHost, 56002}, "heard");
  sender.Send({kSensor, 60001}, "between");
  sender.Send({kHost, 56002}, "not heard");
  Run();

  EXPECT_THAT(heard, ElementsAre("one"));
}

TEST_F(MemoryNetworkTest, TheFilterLosesAndDelaysWhatGoesFromHostToHost) {
  Listener receiver(host_, kHost, 56001);
  Listener inside(sensor_, kSensor, 70);
  Listener sender(sensor_, kSensor, 60001);
  wire_.SetFilter([](const Endpoint&,
                     const Endpoint&,
                     std::span<const std::byte> bytes) -> std::optional<std::int64_t> {
    if (bytes.size() == 4) return std::nullopt;
    return bytes.size() == 5 ? 5000 : 0;
  });

  for (const char* text : {"lost", "later", "now"}) sender.Send({kHost, 56001}, text);
  sender.Send({kSensor, 70}, "kept");
  Run(10'000);

  EXPECT_THAT(receiver.texts(), ElementsAre("now", "later"));
  EXPECT_EQ(receiver.arrivals[1].utime, kStart_us + 5000);
  EXPECT_THAT(inside.texts(), ElementsAre("kept"));
}

TEST_F(MemoryNetworkTest, APulledCableStopsAllThatLeavesOrComesIn) {
  Listener receiver(host_, core::kAnyIpv4, 56001);
  Listener sender(sensor_, kSensor, 60001);

  for (MemoryHost* pulled : {&sensor_, &host_}) {
    pulled->SetPlugged(false);
    sender.Send({kHost, 56001}, "unicast");
    sender.Send({core::kBroadcastIpv4, 56001}, "broadcast");
    pulled->SetPlugged(true);
  }
  sender.Send({kHost, 56001}, "back");
  Run();

  EXPECT_THAT(receiver.texts(), ElementsAre("back"));
}

TEST_F(MemoryNetworkTest, TellsItsInterfaces) {
  const std::vector<Interface> interfaces = host_.Interfaces();

  ASSERT_THAT(interfaces, SizeIs(2));
  EXPECT_EQ(interfaces[0].ip, kLocal);
  EXPECT_EQ(interfaces[1].ip, kHost);
  EXPECT_TRUE(interfaces[1].Reaches(kSensor));
  EXPECT_FALSE(interfaces[1].Reaches(kForeign));
}

TEST_F(MemoryNetworkTest, NoTwoHostsHaveOneAddress) {
  EXPECT_THROW(MemoryHost(wire_, {kSensor}), std::invalid_argument);
}

TEST(MemoryNetworkLifeTest, HostsWireAndSocketsEndInAnyOrder) {
  process::SimulatedRuntime runtime(kStart_us, {});
  auto wire = std::make_unique<MemoryWire>(runtime);
  auto host = std::make_unique<MemoryHost>(*wire, std::vector<Ipv4>{kHost});
  auto listener = std::make_unique<Listener>(*host, kHost, 56001);
  listener->Send({kHost, 56001}, "to itself");

  wire.reset();
  host.reset();
  listener->Send({kHost, 56001}, "once more");
  runtime.RunUntil(kStart_us + 10);

  EXPECT_THAT(listener->texts(), ElementsAre("to itself", "once more"));
  listener->Send({kHost, 56001}, "never");
  listener.reset();
  runtime.RunUntil(kStart_us + 20);
}

TEST(MemoryNetworkLifeTest, AHandlerThatThrowsHarmsNoLaterDatagram) {
  process::SimulatedRuntime runtime(kStart_us, {});
  MemoryWire wire(runtime);
  MemoryHost host(wire, {kHost});
  int calls = 0;
  const auto socket = host.Open({.bind = {kHost, 1}}, [&calls](std::span<const Datagram>) {
    if (++calls == 1) throw std::runtime_error("once");
  });
  Listener sender(host, kHost, 2);

  sender.Send({kHost, 1}, "a");
  EXPECT_THROW(runtime.RunUntil(kStart_us + 1), std::runtime_error);
  sender.Send({kHost, 1}, "b");
  runtime.RunUntil(kStart_us + 2);

  EXPECT_EQ(calls, 2);
}

}  // namespace
}  // namespace clearway::net
