// SPDX-License-Identifier: BSD-3-Clause
#include "common/core/endpoint.hpp"

#include <charconv>

namespace clearway::core {

std::string ToString(Ipv4 ip) {
  std::string text;
  for (int shift = 24; shift >= 0; shift -= 8) {
    text += std::to_string((ip >> static_cast<unsigned>(shift)) & 0xFFU);
    if (shift > 0) text += '.';
  }
  return text;
}

std::string ToString(const Endpoint& endpoint) {
  return ToString(endpoint.ip) + ':' + std::to_string(endpoint.port);
}

std::optional<Ipv4> ParseIpv4(std::string_view text) {
  Ipv4 ip = 0;
  for (int i = 0; i < 4; ++i) {
    unsigned value = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    const auto length = static_cast<std::size_t>(end - text.data());
    if (error != std::errc() || value > 255 || length > 3) return std::nullopt;
    ip = (ip << 8U) | value;
    text.remove_prefix(length);
    if (i == 3) break;
    if (text.empty() || text.front() != '.') return std::nullopt;
    text.remove_prefix(1);
  }
  if (!text.empty()) return std::nullopt;
  return ip;
}

}  // namespace clearway::core
