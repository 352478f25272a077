// SPDX-License-Identifier: BSD-3-Clause
// Any datagrams at the command port of an emulated MID-70, each with three bytes before it: what it
// is, how much time passes, how long it is. With the lowest bit of the first set, set, id and data
// of a command follow, which gets a frame that is right; else the datagram itself.
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <vector>

#include "common/core/simulation/emulated_mid70.hpp"

namespace {

using clearway::core::EmulatedMid70;
using clearway::core::Endpoint;
namespace livox = clearway::core::livox;

void Require(bool holds) {
  if (!holds) std::abort();
}

void CheckFrames(const std::vector<EmulatedMid70::Outgoing>& outgoing) {
  Require(outgoing.size() <= 1);
  for (const EmulatedMid70::Outgoing& out : outgoing) {
    Require(out.to.port != 0);
    const livox::ParsedFrame parsed = livox::ParseFrame(out.bytes);
    Require(parsed.frame.has_value() && livox::CodeOf(*parsed.frame) == out.code);
    // Every answer begins with a result.
    Require(parsed.frame->type != livox::FrameType::kAck || !parsed.frame->data.empty());
  }
}

livox::Bytes FrameOf(const livox::Bytes& bytes, std::uint8_t flags) {
  if ((flags & 1U) == 0 || bytes.size() < 2) return bytes;
  const auto type = (flags & 2U) != 0 ? livox::FrameType::kAck : livox::FrameType::kCommand;
  return livox::PackFrame({.type = type,
                           .sequence = flags,
                           .command_set = static_cast<std::uint8_t>(bytes[0]),
                           .command_id = static_cast<std::uint8_t>(bytes[1]),
                           .data = livox::ByteView(bytes).subspan(2)});
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  EmulatedMid70 device({}, {.ip = 0xC0A80165}, 0);
  std::int64_t now_us = 0;
  for (std::size_t at = 0; at + 3 <= size;) {
    const std::uint8_t flags = data[at];
    now_us += data[at + 1] * std::int64_t{40'000};
    const std::size_t asked = data[at + 2];
    at += 3;
    const std::size_t length = asked < size - at ? asked : size - at;
    const auto* begin = reinterpret_cast<const std::byte*>(data + at);
    // In memory of its own, so that a read beyond the datagram is seen.
    const livox::Bytes datagram = FrameOf({begin, begin + length}, flags);
    const Endpoint from{(flags & 4U) != 0 ? 0xC0A80133 : 0xC0A80132, 55501};
    CheckFrames(device.Advance(now_us));
    CheckFrames(device.Receive(from, datagram, now_us));
    Require(!device.sampling(now_us) || device.host().has_value());
    Require(device.memory().slot >= 1 && device.memory().slot <= 9);
    at += length;
  }
  return 0;
}
