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

// Inodes of the sockets that are bound to the port, from a table such as /proc/net/udp:
//   sl  local_address rem_address st tx_queue:rx_queue tr:tm->when retrnsmt uid timeout inode ...
std::vector<std::string> InodesIn(const fs::path& table, int port) {
  std::vector<std::string> inodes;
  std::ifstream file(table);
  std::string line;
  std::getline(file, line);
  while (std::getline(file, line)) {
    std::istringstream words(line);
    std::array<std::string, 10> fields;
    for (std::string& field : fields) words >> field;
    const std::size_t colon = fields[1].rfind(':');
    if (!words || colon == std::string::npos) continue;
    if (std::strtol(fields[1].c_str() + colon + 1, nullptr, 16) == port)
      inodes.push_back(fields[9]);
  }
  return inodes;
}

bool HoldsOneOf(const fs::path& process, const std::vector<std::string>& inodes) {
  std::error_code error;
  for (fs::directory_iterator fd(process / "fd", error); !error && fd != fs::directory_iterator();
       fd.increment(error)) {
    std::error_code gone;
    const std::string target = fs::read_symlink(fd->path(), gone).string();
    const bool is_one = std::any_of(inodes.begin(), inodes.end(), [&](const std::string& inode) {
      return target == "socket:[" + inode + "]";
    });
    if (is_one) return true;
  }
  return false;
}

std::vector<PortHolder> HoldersOf(int port) {
  std::vector<std::string> inodes = InodesIn("/proc/net/udp", port);
  for (std::string& inode : InodesIn("/proc/net/udp6", port)) inodes.push_back(std::move(inode));
  std::vector<PortHolder> holders;
  std::error_code error;
  for (const auto& entry : fs::directory_iterator("/proc", error)) {
    const int pid = std::atoi(entry.path().filename().c_str());
    if (pid <= 0 || !HoldsOneOf(entry.path(), inodes)) continue;
    std::string program;
    std::ifstream name(entry.path() / "comm");
    std::getline(name, program);
    holders.push_back({pid, program});
  }
  std::sort(holders.begin(), holders.end(), [](const PortHolder& a, const PortHolder& b) {
    return a.pid < b.pid;
  });
  return holders;
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
    facts.holders = HoldersOf(port);
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
