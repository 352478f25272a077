// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

namespace clearway::host {

/// Who holds a UDP port.
struct PortHolder {
  int pid = 0;
  std::string program;
  friend bool operator==(const PortHolder&, const PortHolder&) = default;
};

/// The processes with a UDP socket on this port, by ascending pid. Those of other users are not to
/// be seen without their rights; then the list is shorter, or empty. One pass over /proc.
[[nodiscard]] std::vector<PortHolder> UdpPortHolders(int port);

}  // namespace clearway::host
