// SPDX-License-Identifier: BSD-3-Clause
#include "tools/doctor/network_facts.hpp"

#include <algorithm>
#include <arpa/inet.h>
#include <array>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <memory>
#include <net/if.h>
#include <netinet/in.h>
#include <stdexcept>
#include <sys/socket.h>

#include <ifaddrs.h>
#include <linux/netlink.h>
#include <linux/rtnetlink.h>

#include "common/host/descriptor.hpp"

namespace clearway::doctor {
namespace {

namespace fs = std::filesystem;

Interface::Kind KindOf(const std::string& name, unsigned flags) {
  if ((flags & IFF_LOOPBACK) != 0) return Interface::Kind::kLoopback;
  const fs::path folder = fs::path("/sys/class/net") / name;
  std::error_code ignored;
  if (fs::exists(folder / "wireless", ignored) || fs::exists(folder / "phy80211", ignored)) {
    return Interface::Kind::kWireless;
  }
  return fs::exists(folder / "device", ignored) ? Interface::Kind::kWired : Interface::Kind::kOther;
}

// A question to the kernel's routing table, as `ip route get ADDRESS` asks it.
struct RouteRequest {
  nlmsghdr header{};
  rtmsg route{};
  rtattr attribute{};
  in_addr address{};
};

using Answer = std::array<char, 4096>;

// The kernel's answer; its size, or -1 with errno.
ssize_t Ask(const RouteRequest& request, Answer& answer) {
  const host::Descriptor fd(socket(AF_NETLINK, SOCK_RAW | SOCK_CLOEXEC, NETLINK_ROUTE));
  if (!fd.is_open() || send(fd.get(), &request, sizeof(request), 0) < 0) return -1;
  return recv(fd.get(), answer.data(), answer.size(), 0);
}

std::string NameOfInterface(int index) {
  std::array<char, IF_NAMESIZE> name{};
  return if_indextoname(static_cast<unsigned>(index), name.data()) == nullptr ? "" : name.data();
}

// The interface that a RTM_NEWROUTE message names.
std::string InterfaceIn(const Answer& answer, std::size_t size) {
  std::size_t at = NLMSG_HDRLEN + NLMSG_ALIGN(sizeof(rtmsg));
  while (at + sizeof(rtattr) <= size) {
    rtattr attribute{};
    std::memcpy(&attribute, answer.data() + at, sizeof(attribute));
    if (attribute.rta_len < sizeof(rtattr)) break;
    int index = 0;
    if (attribute.rta_type == RTA_OIF && at + RTA_LENGTH(sizeof(index)) <= size) {
      std::memcpy(&index, answer.data() + at + RTA_LENGTH(0), sizeof(index));
      return NameOfInterface(index);
    }
    at += RTA_ALIGN(attribute.rta_len);
  }
  return {};
}

}  // namespace

std::vector<Interface> ReadInterfaces() {
  ifaddrs* first = nullptr;
  if (getifaddrs(&first) != 0) {
    throw std::runtime_error(std::string("cannot list the network interfaces: ") +
                             std::strerror(errno));
  }
  const std::unique_ptr<ifaddrs, void (*)(ifaddrs*)> all(first, &freeifaddrs);
  std::vector<Interface> interfaces;
  for (const ifaddrs* entry = first; entry != nullptr; entry = entry->ifa_next) {
    const std::string name = entry->ifa_name;
    auto found = std::find_if(interfaces.begin(), interfaces.end(), [&name](const Interface& each) {
      return each.name == name;
    });
    if (found == interfaces.end()) {
      interfaces.push_back({.name = name,
                            .kind = KindOf(name, entry->ifa_flags),
                            .is_up = (entry->ifa_flags & IFF_UP) != 0,
                            .has_multicast = (entry->ifa_flags & IFF_MULTICAST) != 0,
                            .addresses = {}});
      found = interfaces.end() - 1;
    }
    if (entry->ifa_addr == nullptr || entry->ifa_addr->sa_family != AF_INET) continue;
    sockaddr_in address{};
    std::memcpy(&address, entry->ifa_addr, sizeof(address));
    found->addresses.push_back(ntohl(address.sin_addr.s_addr));
  }
  return interfaces;
}

Route RouteTo(const std::string& address) {
  RouteRequest request;
  request.header.nlmsg_len = sizeof(request);
  request.header.nlmsg_type = RTM_GETROUTE;
  request.header.nlmsg_flags = NLM_F_REQUEST;
  request.route.rtm_family = AF_INET;
  request.route.rtm_dst_len = 32;
  request.attribute.rta_type = RTA_DST;
  request.attribute.rta_len = RTA_LENGTH(sizeof(request.address));
  if (inet_pton(AF_INET, address.c_str(), &request.address) != 1) {
    return {{}, "\"" + address + "\" is no IPv4 address"};
  }
  Answer answer{};
  const ssize_t size = Ask(request, answer);
  nlmsghdr header{};
  if (size < static_cast<ssize_t>(sizeof(header))) return {{}, std::strerror(errno)};
  std::memcpy(&header, answer.data(), sizeof(header));
  if (header.nlmsg_type == NLMSG_ERROR) {
    nlmsgerr error{};
    std::memcpy(&error, answer.data() + NLMSG_HDRLEN, sizeof(error));
    return {{}, std::strerror(-error.error)};
  }
  return {InterfaceIn(answer, static_cast<std::size_t>(size)), {}};
}

PortFacts TryPort(int port) {
  PortFacts facts{.port = port, .is_taken = false, .problem = {}, .holders = {}};
  const host::Descriptor fd(socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0));
  const int on = 1;
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_port = htons(static_cast<std::uint16_t>(port));
  const bool is_bound =
      fd.is_open() && setsockopt(fd.get(), SOL_SOCKET, SO_REUSEADDR, &on, sizeof(on)) == 0 &&
      bind(fd.get(), reinterpret_cast<const sockaddr*>(&address), sizeof(address)) == 0;
  if (is_bound) return facts;
  facts.is_taken = errno == EADDRINUSE;
  if (facts.is_taken) {
    facts.holders = host::UdpPortHolders(port);
  } else {
    facts.problem = std::strerror(errno);
  }
  return facts;
}

std::optional<std::int64_t> ReadCoreLimit(const std::string& name) {
  std::ifstream file("/proc/sys/net/core/" + name);
  std::int64_t value = 0;
  return file >> value ? std::optional(value) : std::nullopt;
}

}  // namespace clearway::doctor
