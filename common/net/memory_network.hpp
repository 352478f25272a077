// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "common/net/datagrams.hpp"
#include "common/process/runtime.hpp"

namespace clearway::net {

namespace internal {
struct WireState;
struct HostState;
}  // namespace internal

/// The cable and the switch between hosts that exist in memory only. What is sent at one moment
/// arrives at that moment of the runtime's clock, after the handler that sent it has returned, in
/// the order of sending, several datagrams for one socket at a time. Same sends, same arrivals.
/// Nothing is lost unless the filter says so, and no buffer is ever full.
/// The runtime must outlive the wire, its hosts and their sockets; these three end in any order.
class MemoryWire {
 public:
  /// Looks at a datagram that is sent to another address than its sender's host has: how much
  /// later it arrives [us]; nothing when it is lost.
  using Filter = std::function<std::optional<std::int64_t>(const Endpoint& from,
                                                           const Endpoint& to,
                                                           std::span<const std::byte> bytes)>;

  explicit MemoryWire(process::Runtime& runtime);

  /// Replaces the filter; without one all arrives at once.
  void SetFilter(Filter filter);

 private:
  friend class MemoryHost;
  std::shared_ptr<internal::WireState> state_;
};

/// One host's network: its addresses in subnets of 24 bits, and, as on Linux, all of 127.0.0.0/8,
/// which never leaves it.
/// - Binding a port twice on overlapping addresses, and to an address that the host does not have,
///   throws NetworkError. Port 0 takes the lowest free one from 32768 on.
/// - A datagram from 0.0.0.0 leaves with the address of the interface that reaches its destination.
/// - 255.255.255.255 reaches the sockets of all hosts, the sender's too, that are bound to 0.0.0.0
///   and that port. Send() refuses it unless SocketSettings::can_broadcast.
/// - Send() refuses what no interface reaches, and more than kMaxUdpBytes. What nobody listens to
///   is sent and lost.
class MemoryHost final : public Network {
 public:
  static constexpr std::size_t kMaxUdpBytes = 65507;

  /// @pre no other host on the wire has one of the addresses (std::invalid_argument).
  MemoryHost(MemoryWire& wire, std::vector<Ipv4> addresses);
  ~MemoryHost() override;
  MemoryHost(const MemoryHost&) = delete;
  MemoryHost& operator=(const MemoryHost&) = delete;

  [[nodiscard]] std::unique_ptr<Socket> Open(const SocketSettings& settings,
                                             Handler handler) override;
  [[nodiscard]] std::vector<Interface> Interfaces() const override;

  /// Pulls or plugs the cable: without, only the host's own addresses are reached. Sockets live on.
  void SetPlugged(bool is_plugged);

 private:
  std::shared_ptr<internal::WireState> wire_;
  std::shared_ptr<internal::HostState> state_;
};

}  // namespace clearway::net
