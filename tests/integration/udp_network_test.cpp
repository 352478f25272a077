// SPDX-License-Identifier: BSD-3-Clause
// UDP over the kernel's loopback, in a network namespace of its own.
#include "common/net/udp_network.hpp"

#include <algorithm>
#include <array>
#include <cstdlib>
#include <netinet/in.h>
#include <string>
#include <sys/socket.h>
#include <unistd.h>
#include <vector>

#include <gmock/gmock.h>

#include "common/host/descriptor.hpp"
#include "tests/support/live_buses.hpp"

namespace clearway::net {
namespace {

using testing::Each;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::SizeIs;

constexpr Ipv4 kLoopback = 0x7F000001;
constexpr std::int64_t kDeadline_us = 20'000'000;

std::vector<std::byte> Bytes(std::size_t size, int value) {
  return std::vector<std::byte>(size, static_cast<std::byte>(value));
}

class UdpNetworkTest : public testing::Test {
 protected:
  struct Got {
    Endpoint from;
    std::vector<std::byte> bytes;
    std::int64_t arrival_utime = 0;
  };

  Network::Handler Keep() {
    return [this](std::span<const Datagram> datagrams) {
      largest_batch_ = std::max(largest_batch_, datagrams.size());
      for (const Datagram& datagram : datagrams) {
        got_.push_back({datagram.from,
                        {datagram.bytes.begin(), datagram.bytes.end()},
                        datagram.arrival_utime});
      }
      if (got_.size() >= wanted_) runtime_.Stop();
    };
  }
  // Until so many datagrams have come in all.
  void RunUntil(std::size_t count) {
    wanted_ = count;
    if (got_.size() < count) runtime_.RunFor(kDeadline_us);
    ASSERT_GE(got_.size(), count);
  }

  process::LiveRuntime runtime_{test::TestBuses(17301), ""};
  UdpNetwork network_{runtime_};
  std::vector<Got> got_;
  std::size_t largest_batch_ = 0;
  std::size_t wanted_ = 0;
};

TEST_F(UdpNetworkTest, CarriesDatagramsInOrderWithWhereTheyComeFromAndWhenTheyArrived) {
  const auto receiver = network_.Open({.bind = {kLoopback, 56101}}, Keep());
  const auto sender = network_.Open({.bind = {kLoopback + 1, 65000}}, [](auto) {});
  // The kernel begins to stamp a moment after the first socket of a host has asked for it.
  for (bool is_stamped = false; !is_stamped;) {
    sender->Send({kLoopback, 56101}, Bytes(1, 0));
    const std::int64_t sent_utime = runtime_.UtimeNow();
    RunUntil(got_.size() + 1);
    is_stamped = got_.back().arrival_utime <= sent_utime;
  }
  const auto warm_up = static_cast<std::int64_t>(got_.size());
  got_.clear();
  const std::int64_t before = runtime_.UtimeNow();

  for (int i = 0; i < 200; ++i) {
    EXPECT_TRUE(sender->Send({kLoopback, 56101}, Bytes(1 + static_cast<std::size_t>(i), i)));
  }
  const std::int64_t after = runtime_.UtimeNow();
  RunUntil(200);

  for (std::size_t i = 0; i < got_.size(); ++i) {
    EXPECT_EQ(got_[i].bytes, Bytes(1 + i, static_cast<int>(i)));
    EXPECT_EQ(got_[i].from, (Endpoint{kLoopback + 1, 65000}));
    EXPECT_GE(got_[i].arrival_utime, before - 1);
    EXPECT_LE(got_[i].arrival_utime, after)
        << "arrival is when the kernel had it, not when we look";
  }
  EXPECT_EQ(largest_batch_, 64U);
  EXPECT_EQ(receiver->counts().received, warm_up + 200);
  EXPECT_EQ(receiver->counts().dropped_by_kernel, 0);
  EXPECT_EQ(sender->counts().sent, warm_up + 200);
}

TEST_F(UdpNetworkTest, APortThatIsTakenIsRefusedWithItsNumberAndItsHolder) {
  const auto first = network_.Open({.bind = {core::kAnyIpv4, 56102}}, Keep());

  try {
    (void)network_.Open({.bind = {kLoopback, 56102}}, Keep());
    FAIL() << "two sockets on one port";
  } catch (const NetworkError& error) {
    EXPECT_THAT(error.what(), HasSubstr("UDP 127.0.0.1:56102"));
    EXPECT_THAT(error.what(), HasSubstr("(pid " + std::to_string(getpid()) + ")"));
    EXPECT_THAT(error.what(), HasSubstr("choose another port"));
  }
}

// As the vendor's SDK opens its ports.
TEST_F(UdpNetworkTest, APortOfAProgramThatWouldShareItIsNotShared) {
  const host::Descriptor other(socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0));
  const int on = 1;
  ASSERT_EQ(setsockopt(other.get(), SOL_SOCKET, SO_REUSEADDR, &on, sizeof(on)), 0);
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_port = htons(55000);
  ASSERT_EQ(bind(other.get(), reinterpret_cast<sockaddr*>(&address), sizeof(address)), 0);

  EXPECT_THROW((void)network_.Open({.bind = {core::kAnyIpv4, 55000}}, Keep()), NetworkError);
}

TEST_F(UdpNetworkTest, APortIsFreeAgainWhenItsSocketIsGone) {
  for (int i = 0; i < 50; ++i) {
    auto socket = network_.Open({.bind = {kLoopback, 56103}}, Keep());
    socket.reset();
  }
  const auto socket = network_.Open({.bind = {kLoopback, 56103}}, Keep());

  EXPECT_EQ(socket->local(), (Endpoint{kLoopback, 56103}));
}

TEST_F(UdpNetworkTest, AnAddressThatTheHostDoesNotHaveIsRefusedInWords) {
  try {
    (void)network_.Open({.bind = {0xC0A80132, 56104}}, Keep());
    FAIL() << "192.168.1.50 is not in the namespace";
  } catch (const NetworkError& error) {
    EXPECT_STREQ(error.what(),
                 "cannot listen on UDP 192.168.1.50:56104: no interface of this host has that "
                 "address");
  }
}

TEST_F(UdpNetworkTest, WhatTheKernelDropsIsCountedExactly) {
  const auto receiver =
      network_.Open({.bind = {kLoopback, 56105}, .receive_buffer_bytes = 4096}, Keep());
  const auto sender = network_.Open({.bind = {kLoopback, 0}}, [](auto) {});

  for (int i = 0; i < 500; ++i) sender->Send({kLoopback, 56105}, Bytes(1362, i));
  RunUntil(1);
  runtime_.RunFor(1000);
  // The kernel tells with the next datagram that it takes.
  const std::size_t taken = got_.size();
  sender->Send({kLoopback, 56105}, Bytes(1, 1));
  RunUntil(taken + 1);

  EXPECT_GT(receiver->counts().dropped_by_kernel, 0);
  EXPECT_EQ(receiver->counts().dropped_by_kernel + receiver->counts().received, 501);
}

TEST_F(UdpNetworkTest, AsksForABufferAndReportsWhatItGot) {
  const auto plain = network_.Open({.bind = {kLoopback, 56106}}, Keep());
  const auto small =
      network_.Open({.bind = {kLoopback, 56107}, .receive_buffer_bytes = 100'000}, Keep());

  EXPECT_EQ(small->receive_buffer_bytes(), 100'000);
  EXPECT_GT(plain->receive_buffer_bytes(), 0);
}

TEST_F(UdpNetworkTest, DatagramsThatAreTooLongAreCountedAndLeftOut) {
  const auto receiver = network_.Open({.bind = {kLoopback, 56108}}, Keep());
  const auto sender = network_.Open({.bind = {kLoopback, 0}}, [](auto) {});

  sender->Send({kLoopback, 56108}, Bytes(kMaxDatagramBytes, 1));
  sender->Send({kLoopback, 56108}, Bytes(kMaxDatagramBytes + 1, 2));
  sender->Send({kLoopback, 56108}, Bytes(0, 3));
  RunUntil(2);

  EXPECT_THAT(got_[0].bytes, SizeIs(kMaxDatagramBytes));
  EXPECT_THAT(got_[1].bytes, SizeIs(0));
  EXPECT_EQ(receiver->counts().truncated, 1);
  EXPECT_EQ(receiver->counts().received, 2);
}

TEST_F(UdpNetworkTest, ASendThatIsRefusedIsCountedAndTold) {
  const auto socket = network_.Open({.bind = {kLoopback, 0}}, [](auto) {});

  EXPECT_FALSE(socket->Send({kLoopback, 56109}, Bytes(70'000, 1)));
  EXPECT_THAT(socket->send_error(), HasSubstr("too long"));
  EXPECT_FALSE(socket->Send({0xFFFFFFFF, 56109}, Bytes(1, 1))) << "not allowed to broadcast";
  EXPECT_EQ(socket->counts().send_failures, 2);

  // Nobody listens there; the kernel's word about that must not be taken for one about the next.
  for (int i = 0; i < 3; ++i) EXPECT_TRUE(socket->Send({kLoopback, 56109}, Bytes(1, 1)));
  EXPECT_EQ(socket->send_error(), "");
}

TEST_F(UdpNetworkTest, ASocketMayBeDestroyedByItsOwnHandler) {
  std::unique_ptr<Socket> receiver;
  int calls = 0;
  receiver = network_.Open({.bind = {kLoopback, 56110}}, [&](auto) {
    ++calls;
    receiver.reset();
    runtime_.Stop();
  });
  const auto sender = network_.Open({.bind = {kLoopback, 0}}, [](auto) {});

  for (int i = 0; i < 200; ++i) sender->Send({kLoopback, 56110}, Bytes(1, i));
  runtime_.RunFor(kDeadline_us);

  EXPECT_EQ(calls, 1);
}

TEST_F(UdpNetworkTest, ListsTheLoopbackInterface) {
  const std::vector<Interface> interfaces = network_.Interfaces();

  ASSERT_THAT(interfaces, SizeIs(1));
  EXPECT_EQ(interfaces[0].name, "lo");
  EXPECT_EQ(interfaces[0].ip, kLoopback);
  EXPECT_TRUE(interfaces[0].Reaches(kLoopback + 100));
  EXPECT_FALSE(interfaces[0].Reaches(0xC0A80132));
}

}  // namespace
}  // namespace clearway::net
