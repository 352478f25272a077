// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <vector>

#include "common/net/datagrams.hpp"
#include "common/process/live_runtime.hpp"

namespace clearway::net {

/// The kernel's UDP over IPv4. Sockets do not block and are read on the runtime's thread, in
/// batches, into buffers that are allocated once; a port is never shared with another program.
/// Arrival is the kernel's time stamp. A socket may be destroyed by its own handler.
/// Thread safety: none.
class UdpNetwork final : public Network {
 public:
  /// `runtime` outlives the network and its sockets.
  explicit UdpNetwork(process::LiveRuntime& runtime) : runtime_(runtime) {}

  [[nodiscard]] std::unique_ptr<Socket> Open(const SocketSettings& settings,
                                             Handler handler) override;
  [[nodiscard]] std::vector<Interface> Interfaces() const override;

 private:
  process::LiveRuntime& runtime_;
};

}  // namespace clearway::net
