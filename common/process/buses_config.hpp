// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace clearway::process {

/// Settings of one bus.
struct BusConfig {
  std::string url = "udpm://239.255.76.67:7667";
  int ttl = 0;
  int max_message_bytes = 58000;
  int receive_buffer_bytes = 4194304;
  std::int64_t burst_interval_us = 2000;

  template <typename Self, typename Visitor>
  static void Visit(Self& self, Visitor& visitor) {
    visitor.Text(
        "url",
        self.url,
        "LCM address udpm://GROUP:PORT, without options. LCM 1.3.1 separates buses by port, "
        "not by group.");
    visitor.Integer("ttl",
                    self.ttl,
                    0,
                    255,
                    "Multicast time to live: 0 stays on this host, 1 reaches the local network.");
    visitor.Integer(
        "max_message_bytes",
        self.max_message_bytes,
        1000,
        65000,
        "Largest message [bytes]; what is larger travels in slices. 58000 within a host, "
        "1400 between hosts, where one lost frame loses the message.");
    visitor.Integer(
        "receive_buffer_bytes",
        self.receive_buffer_bytes,
        65536,
        268435456,
        "Socket buffer to ask for [bytes]; the kernel grants net.core.rmem_max at most.");
    visitor.Milliseconds("burst_interval_ms",
                         self.burst_interval_us,
                         0.0,
                         100.0,
                         "Time between two slices of one burst [ms]. Slices sent at once overflow "
                         "the receivers' buffers.");
  }

  [[nodiscard]] std::vector<std::string> Validate() const;
};

/// XML element <buses>.
struct BusesConfig {
  BusConfig local;
  BusConfig shared;

  template <typename Self, typename Visitor>
  static void Visit(Self& self, Visitor& visitor) {
    visitor.Group("local", self.local, "The bus that never leaves the host.");
    visitor.Group("shared", self.shared, "The bus that may reach other hosts.");
  }

  [[nodiscard]] std::vector<std::string> Validate() const;
};

/// A bus from an address as LCM's own programs take it: udpm://[GROUP[:PORT]][?ttl=N]
/// [&recv_buf_size=N], with LCM's defaults for what is left out; all else as in `defaults`. Throws
/// std::invalid_argument that names the address and what is wrong with it.
[[nodiscard]] BusConfig BusFromUrl(const std::string& url, BusConfig defaults = {});

/// Largest message for a bus that leaves its host and whose size nobody configured [bytes]: one
/// frame of Ethernet, since one lost frame loses the message.
inline constexpr int kMessageBytesBetweenHosts = 1400;

/// The port of udpm://GROUP:PORT; -1 when the address is not of this form.
[[nodiscard]] int PortOf(const std::string& url);

}  // namespace clearway::process
