// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "common/host/port_holders.hpp"

/// What this host's network is like, as the kernel says.
namespace clearway::doctor {

struct Interface {
  enum class Kind {
    kLoopback,
    kWired,  ///< Ethernet with a device behind it.
    kWireless,
    kOther,  ///< Bridges, tunnels, virtual Ethernet.
  };
  std::string name;
  Kind kind = Kind::kOther;
  bool is_up = false;
  bool has_multicast = false;
  std::vector<std::uint32_t> addresses;  ///< IPv4, in the host's byte order.
};

/// All interfaces, in the kernel's order. Throws std::runtime_error.
[[nodiscard]] std::vector<Interface> ReadInterfaces();

struct Route {
  std::string interface;  ///< By which the address is reached; empty when it is not.
  std::string problem;    ///< The kernel's reason; empty when there is a way.
};

/// The way to an IPv4 address, as the kernel would go for a message to it. (The source address of a
/// connected socket does not tell: over lo it may be another interface's.)
[[nodiscard]] Route RouteTo(const std::string& address);

using host::PortHolder;

struct PortFacts {
  int port = 0;
  bool is_taken = false;            ///< By who does not share it.
  std::string problem;              ///< Why it cannot be bound otherwise; empty: it can.
  std::vector<PortHolder> holders;  ///< That this user may see; only when it is taken.
};

/// Tries to bind the port as LCM does.
[[nodiscard]] PortFacts TryPort(int port);

/// A limit of /proc/sys/net/core; nothing where it cannot be read.
[[nodiscard]] std::optional<std::int64_t> ReadCoreLimit(const std::string& name);

}  // namespace clearway::doctor
