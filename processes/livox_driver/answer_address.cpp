// SPDX-License-Identifier: BSD-3-Clause
#include "processes/livox_driver/answer_address.hpp"

#include <algorithm>

namespace clearway {
namespace {

std::string ListOf(const std::vector<net::Interface>& interfaces) {
  std::string text;
  for (const net::Interface& interface : interfaces) {
    text += (text.empty() ? "" : ", ") + core::ToString(interface.ip) + " (" + interface.name + ')';
  }
  return text.empty() ? "no address" : text;
}

}  // namespace

AnswerAddress AnswerAddressFor(core::Ipv4 sensor,
                               const std::string& host_ip,
                               const std::vector<net::Interface>& interfaces) {
  if (const std::optional<core::Ipv4> configured = core::ParseIpv4(host_ip)) {
    const bool is_ours = std::any_of(interfaces.begin(), interfaces.end(), [&](const auto& each) {
      return each.ip == *configured;
    });
    if (is_ours) return {configured, {}};
    return {std::nullopt,
            "livox_driver.host_ip " + host_ip + " is no address of this host, which has " +
                ListOf(interfaces)};
  }
  const net::Interface* best = nullptr;
  for (const net::Interface& interface : interfaces) {
    if (interface.Reaches(sensor) && (best == nullptr || interface.mask > best->mask)) {
      best = &interface;
    }
  }
  if (best != nullptr) return {best->ip, {}};
  return {std::nullopt,
          core::ToString(sensor) + " is in another subnet than this host, which has " +
              ListOf(interfaces) +
              ": give this host an address there, or set livox_driver.host_ip"};
}

}  // namespace clearway
