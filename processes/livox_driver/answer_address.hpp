// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "common/net/datagrams.hpp"

namespace clearway {

/// Where a sensor is to answer.
struct AnswerAddress {
  std::optional<core::Ipv4> ip;  ///< Nothing where there is a problem.
  std::string problem;           ///< With what to do about it; else empty.
};

/// The address of this host that `sensor` can answer to: `host_ip` where it is configured (not
/// empty, and an address), else that of the interface with the narrowest subnet that holds it.
[[nodiscard]] AnswerAddress AnswerAddressFor(core::Ipv4 sensor,
                                             const std::string& host_ip,
                                             const std::vector<net::Interface>& interfaces);

}  // namespace clearway
