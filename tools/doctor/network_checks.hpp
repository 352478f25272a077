// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "common/process/buses_config.hpp"
#include "tools/doctor/finding.hpp"
#include "tools/doctor/network_facts.hpp"

/// What is to be said of the host's network. Nothing is read here.
namespace clearway::doctor {

/// A bus, or both where they are one.
struct Bus {
  std::string name;  ///< "local bus", "shared bus" or "both buses".
  std::string group;
  int port = 0;
  process::BusConfig config;
};

[[nodiscard]] std::vector<Bus> BusesOf(const process::BusesConfig& config);

struct BusRoute {
  Bus bus;
  Route route;
};

/// One finding for each bus.
[[nodiscard]] Findings CheckRoutes(const std::vector<BusRoute>& routes,
                                   const std::vector<Interface>& interfaces);

struct BufferLimits {
  std::optional<std::int64_t> rmem_max;
  std::optional<std::int64_t> rmem_default;
};

[[nodiscard]] Finding CheckBuffers(const std::vector<Bus>& buses, const BufferLimits& limits);

[[nodiscard]] Finding CheckPort(const Bus& bus, const PortFacts& facts);

/// Whether LCM heard itself on a bus.
struct LoopBack {
  bool was_heard = false;
  std::string problem;  ///< Why it could not even be tried; empty: it could.
};

[[nodiscard]] Finding CheckLoopBack(const Bus& bus, const LoopBack& result);

/// An IPv4 subnet.
struct Subnet {
  std::uint32_t address = 0;  ///< In the host's byte order.
  int prefix_bits = 0;
  [[nodiscard]] bool Contains(std::uint32_t other) const;
  friend bool operator==(const Subnet&, const Subnet&) = default;
};

/// From "192.168.1.0/24"; nothing when it is none.
[[nodiscard]] std::optional<Subnet> ParseSubnet(const std::string& text);

/// Whether an interface is in the sensors' subnet.
[[nodiscard]] Finding CheckSensorSubnet(const Subnet& subnet,
                                        const std::vector<Interface>& interfaces);

}  // namespace clearway::doctor
