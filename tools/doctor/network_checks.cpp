// SPDX-License-Identifier: BSD-3-Clause
#include "tools/doctor/network_checks.hpp"

#include <algorithm>
#include <arpa/inet.h>
#include <charconv>
#include <cstring>

namespace clearway::doctor {
namespace {

using Kind = Interface::Kind;

constexpr char kAllGroups[] = "224.0.0.0/4";
constexpr char kLoopback[] = "lo";

// Of a Livox sensor's subnet: the host that its maker's examples use, where nothing else is.
constexpr std::uint32_t kUsualHost = 50;

const Interface* Find(const std::vector<Interface>& interfaces, const std::string& name) {
  const auto found = std::find_if(interfaces.begin(), interfaces.end(), [&](const Interface& each) {
    return each.name == name;
  });
  return found == interfaces.end() ? nullptr : &*found;
}

// The first that is up, of the kinds in their order.
const Interface* FirstUp(const std::vector<Interface>& interfaces, const std::vector<Kind>& kinds) {
  for (const Kind kind : kinds) {
    for (const Interface& each : interfaces) {
      if (each.kind == kind && each.is_up) return &each;
    }
  }
  return nullptr;
}

bool LeavesHost(const std::vector<BusRoute>& routes) {
  return std::any_of(
      routes.begin(), routes.end(), [](const BusRoute& each) { return each.bus.config.ttl > 0; });
}

void MendFlags(const Interface* interface, const std::string& name, Finding& finding) {
  if (interface != nullptr && !interface->is_up) {
    finding.mend.push_back("sudo ip link set " + name + " up");
  }
  if (interface != nullptr && !interface->has_multicast) {
    finding.mend.push_back("sudo ip link set " + name + " multicast on");
  }
}

// With `verb` "add" or "replace". A bus that leaves the host needs a way out, one that does not
// goes the same way: the kernel has one route for all groups.
void MendRoute(const std::vector<Interface>& interfaces,
               bool leaves_host,
               const std::string& verb,
               Finding& finding) {
  const Interface* const by =
      leaves_host ? FirstUp(interfaces, {Kind::kWired, Kind::kWireless, Kind::kOther})
                  : Find(interfaces, kLoopback);
  if (leaves_host && by == nullptr) {
    finding.text += "; no interface but lo is up: connect a network first";
    return;
  }
  const std::string name = by == nullptr ? kLoopback : by->name;
  MendFlags(by, name, finding);
  finding.mend.push_back("sudo ip route " + verb + ' ' + kAllGroups + " dev " + name);
}

Finding CheckRoute(const BusRoute& checked,
                   const std::vector<Interface>& interfaces,
                   bool leaves_host) {
  const Bus& bus = checked.bus;
  const std::string way = bus.name + ": multicast to " + bus.group;
  Finding finding{.check = "multicast_route", .state = State::kProblem, .text = {}, .mend = {}};
  if (!checked.route.problem.empty()) {
    finding.text = way + " has no route (" + checked.route.problem + ")";
    MendRoute(interfaces, leaves_host, "add", finding);
    return finding;
  }
  const std::string& name = checked.route.interface;
  const Interface* const by = Find(interfaces, name);
  finding.text = way + " goes by " + name;
  if (bus.config.ttl > 0 && by != nullptr && by->kind == Kind::kLoopback) {
    finding.text +=
        ", but with ttl=\"" + std::to_string(bus.config.ttl) + "\" it is to leave the host";
    MendRoute(interfaces, leaves_host, "replace", finding);
  } else if (by != nullptr && (!by->is_up || !by->has_multicast)) {
    finding.text += by->is_up ? ", which has no multicast" : ", which is down";
    MendFlags(by, name, finding);
  } else if (!leaves_host && by != nullptr && by->kind == Kind::kWireless) {
    finding.state = State::kWarning;
    finding.text += ": when that network goes, so do the messages within this host";
    MendFlags(Find(interfaces, kLoopback), kLoopback, finding);
    finding.mend.push_back("sudo ip route add " + bus.group + "/32 dev " + kLoopback);
  } else {
    finding.state = State::kOk;
  }
  return finding;
}

}  // namespace

std::vector<Bus> BusesOf(const process::BusesConfig& config) {
  const auto bus_of = [](const std::string& name, const process::BusConfig& bus) {
    const std::size_t begin = std::strlen("udpm://");
    return Bus{
        name, bus.url.substr(begin, bus.url.rfind(':') - begin), process::PortOf(bus.url), bus};
  };
  if (config.local.url != config.shared.url) {
    return {bus_of("local bus", config.local), bus_of("shared bus", config.shared)};
  }
  Bus both = bus_of("both buses", config.local);
  both.config.receive_buffer_bytes =
      std::max(config.local.receive_buffer_bytes, config.shared.receive_buffer_bytes);
  return {both};
}

Findings CheckRoutes(const std::vector<BusRoute>& routes,
                     const std::vector<Interface>& interfaces) {
  Findings findings;
  for (const BusRoute& each : routes) {
    Finding finding = CheckRoute(each, interfaces, LeavesHost(routes));
    // To add a route a second time is an error.
    const bool is_mended =
        !finding.mend.empty() &&
        std::any_of(findings.begin(), findings.end(), [&](const Finding& before) {
          return before.mend == finding.mend;
        });
    if (is_mended) {
      finding.mend.clear();
      finding.text += "; the same commands mend it";
    }
    findings.push_back(std::move(finding));
  }
  return findings;
}

Finding CheckBuffers(const std::vector<Bus>& buses, const BufferLimits& limits) {
  Finding finding{.check = "receive_buffer", .state = State::kNotChecked, .text = {}, .mend = {}};
  if (!limits.rmem_max) {
    finding.text = "/proc/sys/net/core/rmem_max cannot be read here";
    return finding;
  }
  int wanted = 0;
  for (const Bus& bus : buses) wanted = std::max(wanted, bus.config.receive_buffer_bytes);
  const std::string bytes = std::to_string(wanted);
  finding.text = "net.core.rmem_max is " + std::to_string(*limits.rmem_max) +
                 " bytes, the buses ask for " + bytes;
  if (*limits.rmem_max < wanted) {
    finding.state = State::kProblem;
    finding.text += ": bursts will be lost";
    finding.mend = {
        "sudo sysctl -w net.core.rmem_max=" + bytes,
        "echo 'net.core.rmem_max = " + bytes + "' | sudo tee /etc/sysctl.d/60-clearway.conf"};
    return finding;
  }
  finding.state = State::kOk;
  if (limits.rmem_default) {
    finding.text += " (who does not ask, as lcm-logger, gets rmem_default: " +
                    std::to_string(*limits.rmem_default) + ")";
  }
  return finding;
}

Finding CheckPort(const Bus& bus, const PortFacts& facts) {
  Finding finding{.check = "port", .state = State::kProblem, .text = {}, .mend = {}};
  finding.text = bus.name + ": UDP port " + std::to_string(facts.port);
  if (!facts.problem.empty()) {
    finding.text += " cannot be bound: " + facts.problem;
  } else if (!facts.is_taken) {
    finding.state = State::kOk;
    finding.text += " can be bound";
  } else if (facts.holders.empty()) {
    finding.text += " is held by a program that does not share it, of another user";
    finding.mend = {"sudo ss -lunp 'sport = :" + std::to_string(facts.port) + "'"};
  } else {
    std::vector<std::string> who;
    for (const PortHolder& holder : facts.holders) {
      who.push_back(holder.program + " (process " + std::to_string(holder.pid) + ")");
      finding.mend.push_back("sudo kill " + std::to_string(holder.pid));
    }
    finding.text += " is held by a program that does not share it: " + Join(who);
  }
  return finding;
}

Finding CheckLoopBack(const Bus& bus, const LoopBack& result) {
  Finding finding{.check = "loop_back", .state = State::kOk, .text = {}, .mend = {}};
  finding.text = bus.name + ": LCM hears its own messages";
  if (result.was_heard) return finding;
  finding.state = State::kProblem;
  finding.text =
      bus.name + ": " +
      (result.problem.empty() ? "LCM does not hear its own messages: a firewall?" : result.problem);
  finding.mend = {"sudo iptables -I INPUT -p udp -d " + bus.group + " --dport " +
                  std::to_string(bus.port) + " -j ACCEPT"};
  return finding;
}

bool Subnet::Contains(std::uint32_t other) const {
  if (prefix_bits == 0) return true;
  return ((address ^ other) >> (32 - prefix_bits)) == 0;
}

std::optional<Subnet> ParseSubnet(const std::string& text) {
  const std::size_t slash = text.find('/');
  if (slash == std::string::npos) return std::nullopt;
  Subnet subnet;
  in_addr address{};
  if (inet_pton(AF_INET, text.substr(0, slash).c_str(), &address) != 1) return std::nullopt;
  subnet.address = ntohl(address.s_addr);
  const char* const end = text.data() + text.size();
  const auto [stop, error] = std::from_chars(text.data() + slash + 1, end, subnet.prefix_bits);
  const bool is_good =
      error == std::errc() && stop == end && subnet.prefix_bits >= 0 && subnet.prefix_bits <= 30;
  return is_good ? std::optional(subnet) : std::nullopt;
}

Finding CheckSensorSubnet(const Subnet& subnet, const std::vector<Interface>& interfaces) {
  const auto text_of = [](std::uint32_t address) {
    const in_addr in{htonl(address)};
    return std::string(inet_ntoa(in));
  };
  const std::string bits = std::to_string(subnet.prefix_bits);
  const std::string name = "the sensors' subnet " + text_of(subnet.address) + '/' + bits;
  for (const Interface& each : interfaces) {
    for (const std::uint32_t address : each.addresses) {
      if (!subnet.Contains(address)) continue;
      return {
          "sensor_subnet", State::kOk, name + ": " + each.name + " has " + text_of(address), {}};
    }
  }
  Finding finding{.check = "sensor_subnet",
                  .state = State::kWarning,
                  .text = "no interface has an address in " + name,
                  .mend = {}};
  const std::uint32_t mask = subnet.prefix_bits == 0 ? 0 : ~0U << (32 - subnet.prefix_bits);
  const std::uint32_t size = ~mask;  // Addresses but one; the last is the broadcast's.
  const std::string host = text_of((subnet.address & mask) + (size > kUsualHost ? kUsualHost : 1));
  if (const Interface* const by = FirstUp(interfaces, {Kind::kWired, Kind::kOther})) {
    finding.mend.push_back("sudo ip addr add " + host + '/' + bits + " dev " + by->name);
  } else {
    finding.text += ", and no wired interface is up: connect the sensor";
  }
  return finding;
}

}  // namespace clearway::doctor
