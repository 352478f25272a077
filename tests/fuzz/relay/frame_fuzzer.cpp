// SPDX-License-Identifier: BSD-3-Clause
// Any bytes as frames that come to a hub, each with two bytes before it that say its length.
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <span>
#include <vector>

#include "tools/relay/hub.hpp"
#include "tools/relay/report.hpp"

namespace {

using clearway::relay::Hub;

void Require(bool holds) {
  if (!holds) std::abort();
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  std::size_t sent = 0;
  Hub hub({"a", "b"}, {}, [&sent](std::size_t, std::span<const std::byte>) {
    ++sent;
    return true;
  });
  std::size_t received = 0;
  for (std::size_t at = 0; at + 2 <= size;) {
    const std::size_t asked = data[at] * std::size_t{256} + data[at + 1];
    at += 2;
    const std::size_t length = asked < size - at ? asked : size - at;
    // In memory of its own, so that a read beyond the frame is seen.
    const std::vector<std::byte> frame(reinterpret_cast<const std::byte*>(data + at),
                                       reinterpret_cast<const std::byte*>(data + at + length));
    hub.OnPacket(received % 2, frame, 0);
    ++received;
    at += length;
  }
  Require(sent == received);
  std::uint64_t counted = 0;
  for (const Hub::Port& port : hub.ports()) {
    counted += port.traffic.other().frames;
    for (const auto& [key, traffic] : port.traffic.channels()) {
      Require(!key.channel.empty() && key.channel.size() <= 63);
      Require(traffic.messages <= traffic.frames);
      counted += traffic.frames;
    }
  }
  Require(counted == received);
  Require(!clearway::relay::FormatStatistics(hub, {0, 0}, 1.0).empty());
  return 0;
}
