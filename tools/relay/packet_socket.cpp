// SPDX-License-Identifier: BSD-3-Clause
#include "tools/relay/packet_socket.hpp"

#include <arpa/inet.h>
#include <cerrno>
#include <cstring>
#include <net/if.h>
#include <stdexcept>
#include <sys/socket.h>
#include <unistd.h>

#include <linux/if_ether.h>
#include <linux/if_packet.h>

namespace clearway::relay {
namespace {

constexpr int kReceiveBufferBytes = 32 << 20;

[[noreturn]] void Fail(const std::string& interface_name, const std::string& what) {
  const int error = errno;
  std::string text = interface_name + ": " + what + ": " + std::strerror(error);
  if (error == EPERM) text += "; the relay needs to be root, or CAP_NET_RAW";
  throw std::runtime_error(text);
}

}  // namespace

PacketSocket::PacketSocket(const std::string& interface_name) {
  const unsigned index = if_nametoindex(interface_name.c_str());
  if (index == 0) Fail(interface_name, "no such interface");
  // Protocol 0: nothing comes in before it is bound to its interface.
  file_descriptor_ = socket(AF_PACKET, SOCK_RAW | SOCK_NONBLOCK | SOCK_CLOEXEC, 0);
  if (file_descriptor_ < 0) Fail(interface_name, "cannot open a packet socket");
  const auto set = [&](int level, int option, int value) {
    return setsockopt(file_descriptor_, level, option, &value, sizeof(value)) == 0;
  };
  const auto fail = [&](const std::string& what) {
    const int error = errno;
    close(file_descriptor_);
    errno = error;
    Fail(interface_name, what);
  };
  if (!set(SOL_PACKET, PACKET_VNET_HDR, 1)) fail("cannot keep offloaded frames whole");
  // What this socket itself sends is not what comes in.
  if (!set(SOL_PACKET, PACKET_IGNORE_OUTGOING, 1)) fail("cannot leave out outgoing frames");
  if (!set(SOL_SOCKET, SO_RCVBUFFORCE, kReceiveBufferBytes)) {
    (void)set(SOL_SOCKET, SO_RCVBUF, kReceiveBufferBytes);  // As much as a plain user gets.
  }
  sockaddr_ll address{};
  address.sll_family = AF_PACKET;
  address.sll_protocol = htons(ETH_P_ALL);
  address.sll_ifindex = static_cast<int>(index);
  if (bind(file_descriptor_, reinterpret_cast<const sockaddr*>(&address), sizeof(address)) != 0) {
    fail("cannot bind to it");
  }
}

PacketSocket::~PacketSocket() {
  close(file_descriptor_);
}

std::optional<std::span<const std::byte>> PacketSocket::Receive(std::span<std::byte> buffer) {
  while (true) {
    const ssize_t length = recv(file_descriptor_, buffer.data(), buffer.size(), MSG_TRUNC);
    if (length < 0) {
      // The interface went down, which is told once; it may come up again.
      if (errno == EINTR || errno == ENETDOWN) continue;
      return std::nullopt;
    }
    const auto bytes = static_cast<std::size_t>(length);
    if (bytes <= buffer.size()) return buffer.first(bytes);
    ++kernel_drops_;  // Cut off: worse than lost.
  }
}

bool PacketSocket::Send(std::span<const std::byte> packet) {
  while (true) {
    const ssize_t sent = send(file_descriptor_, packet.data(), packet.size(), MSG_DONTWAIT);
    if (sent >= 0 || errno != EINTR) return sent == static_cast<ssize_t>(packet.size());
  }
}

std::uint64_t PacketSocket::KernelDrops() {
  tpacket_stats statistics{};  // Since they were last asked for.
  socklen_t bytes = sizeof(statistics);
  if (getsockopt(file_descriptor_, SOL_PACKET, PACKET_STATISTICS, &statistics, &bytes) == 0) {
    kernel_drops_ += statistics.tp_drops;
  }
  return kernel_drops_;
}

}  // namespace clearway::relay
