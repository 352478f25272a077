// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <compare>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace clearway::core {

/// An IPv4 address, the first byte in the highest bits: 192.168.1.50 is 0xC0A80132.
using Ipv4 = std::uint32_t;
inline constexpr Ipv4 kAnyIpv4 = 0;                 ///< 0.0.0.0
inline constexpr Ipv4 kBroadcastIpv4 = 0xFFFFFFFF;  ///< 255.255.255.255

/// Where a datagram comes from or goes to.
struct Endpoint {
  Ipv4 ip = kAnyIpv4;
  std::uint16_t port = 0;
  friend auto operator<=>(const Endpoint&, const Endpoint&) = default;
};

/// "192.168.1.50"
[[nodiscard]] std::string ToString(Ipv4 ip);
/// "192.168.1.50:65000"
[[nodiscard]] std::string ToString(const Endpoint& endpoint);
/// Four decimal numbers 0..255 with dots, nothing else; nothing where the text is none.
[[nodiscard]] std::optional<Ipv4> ParseIpv4(std::string_view text);

}  // namespace clearway::core
