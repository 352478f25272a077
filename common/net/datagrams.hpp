// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <stdexcept>
#include <string>
#include <vector>

#include "common/core/endpoint.hpp"

namespace clearway::net {

using core::Endpoint;
using core::Ipv4;

/// One datagram that has arrived.
struct Datagram {
  Endpoint from;
  std::span<const std::byte> bytes;  ///< Valid until the handler returns.
  std::int64_t arrival_utime = 0;    ///< When the kernel took it in [us since the epoch].
};

/// What a socket is asked to be.
struct SocketSettings {
  Endpoint bind;                 ///< 0.0.0.0 listens on all interfaces; port 0 takes a free one.
  bool can_broadcast = false;    ///< Send() to 255.255.255.255 is allowed.
  int receive_buffer_bytes = 0;  ///< Asked for; 0: as the kernel gives it.
};

/// What has come and gone through a socket.
struct SocketCounts {
  std::int64_t received = 0;
  std::int64_t dropped_by_kernel = 0;  ///< The receive buffer was full.
  std::int64_t truncated = 0;          ///< Longer than kMaxDatagramBytes; not handed on.
  std::int64_t sent = 0;
  std::int64_t send_failures = 0;
};
inline constexpr std::size_t kMaxDatagramBytes = 2048;

/// An open UDP socket; closing is destroying it.
class Socket {
 public:
  virtual ~Socket() = default;
  /// False when the network refused it; counted.
  virtual bool Send(const Endpoint& to, std::span<const std::byte> bytes) = 0;
  [[nodiscard]] virtual Endpoint local() const = 0;
  [[nodiscard]] virtual SocketCounts counts() const = 0;
  /// What the kernel granted; -1 where there is no kernel.
  [[nodiscard]] virtual int receive_buffer_bytes() const = 0;
  /// Why the last Send() was refused, in the system's words; empty when it was not.
  [[nodiscard]] virtual std::string send_error() const { return {}; }
};

/// An IPv4 address of this host, with its subnet.
struct Interface {
  std::string name;
  Ipv4 ip = core::kAnyIpv4;
  Ipv4 mask = 0;
  [[nodiscard]] bool Reaches(Ipv4 other) const { return (ip & mask) == (other & mask); }
};

/// A socket that cannot be opened: what() says which, why, and what to do about it.
class NetworkError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// UDP over IPv4 as a process sees it; handlers run on the runtime's thread. The same process runs
/// over the kernel's network and over one in memory, in virtual time.
class Network {
 public:
  /// Gets what has arrived, oldest first, several datagrams at a time where they queue up.
  using Handler = std::function<void(std::span<const Datagram>)>;

  virtual ~Network() = default;
  /// Throws NetworkError, e.g. where another program has the port.
  [[nodiscard]] virtual std::unique_ptr<Socket> Open(const SocketSettings& settings,
                                                     Handler handler) = 0;
  /// The interfaces that are up, loopback among them.
  [[nodiscard]] virtual std::vector<Interface> Interfaces() const = 0;
};

}  // namespace clearway::net
