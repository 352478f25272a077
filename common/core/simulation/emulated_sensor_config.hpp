// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "common/core/endpoint.hpp"
#include "common/core/livox/commands.hpp"

namespace clearway::core {

/// A MID-70 that the simulator is, on the network. XML element: <simulator><mid70>.
struct EmulatedSensorConfig {
  std::string sensor = "front";
  std::string broadcast_code = "3GGDJ6K00100101";
  std::string ip = "127.0.0.2";
  std::string broadcast_to = "127.0.0.1";
  std::int64_t host_timeout_us = 5'000'000;

  template <typename Self, typename Visitor>
  static void Visit(Self& self, Visitor& visitor) {
    visitor.Text("sensor", self.sensor, "Name of its <vehicle><sensor>: where it is mounted.");
    visitor.Text("broadcast_code", self.broadcast_code, "15 characters by which it is known.");
    visitor.Text("ip",
                 self.ip,
                 "Its own address; 127.0.0.2, .3, ... on this host, or that of an interface.");
    visitor.Text("broadcast_to",
                 self.broadcast_to,
                 "Where it announces itself: 255.255.255.255 as real ones do, or one host.");
    visitor.Milliseconds("host_timeout_ms",
                         self.host_timeout_us,
                         500.0,
                         60000.0,
                         "Without a heartbeat for so long it stops and announces itself again "
                         "[ms]. What a real one takes is not known.");
  }

  [[nodiscard]] std::vector<std::string> Validate() const {
    std::vector<std::string> broken;
    for (const std::string* address : {&ip, &broadcast_to}) {
      if (!ParseIpv4(*address)) {
        broken.push_back("\"" + *address + "\" is not an address like 192.168.1.101");
      }
    }
    if (broadcast_code.empty() || broadcast_code.size() > livox::Broadcast::kMaxCodeLength) {
      broken.push_back("broadcast_code needs 1 to 15 characters");
    }
    return broken;
  }
};

}  // namespace clearway::core
