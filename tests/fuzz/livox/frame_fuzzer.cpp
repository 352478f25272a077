// SPDX-License-Identifier: BSD-3-Clause
// Any bytes as a control frame: refused, or packed again to the same bytes. They are tried as they
// are and with their checksums mended, since random changes would hardly ever pass these; what is
// accepted goes through every parser of a body.
#include <algorithm>
#include <cstdint>
#include <cstdlib>

#include "common/core/livox/commands.hpp"
#include "common/core/livox/crc.hpp"

namespace {

using namespace clearway::core::livox;

void Require(bool holds) {
  if (!holds) std::abort();
}

template <typename Body>
void RequireSame(const Body& body, ByteView data) {
  if (!body) return;
  const Bytes packed = PackBody(*body);
  Require(std::equal(packed.begin(), packed.end(), data.begin(), data.end()));
}

void CheckBodies(ByteView data) {
  if (const auto broadcast = ParseBroadcast(data)) {
    // What follows the end of the code and the reserved bytes is not kept.
    const Bytes packed = PackBody(*broadcast);
    const auto again = ParseBroadcast(packed);
    Require(again && again->broadcast_code == broadcast->broadcast_code &&
            again->type == broadcast->type);
    Require(!broadcast->broadcast_code.empty() &&
            broadcast->broadcast_code.size() <= Broadcast::kMaxCodeLength);
  }
  const auto handshake = ParseHandshake(data);
  if (data.size() == 10) RequireSame(handshake, data);
  RequireSame(ParseDeviceInfoAck(data), data);
  RequireSame(ParseExtrinsic(data), data);
  RequireSame(ParseExtrinsicAck(data), data);
  const auto heartbeat = ParseHeartbeatAck(data);
  if (heartbeat && heartbeat->state != WorkState::kUnknown) RequireSame(heartbeat, data);
}

void Check(ByteView bytes) {
  const ParsedFrame parsed = ParseFrame(bytes);
  Require(parsed.frame.has_value() == (parsed.defect == FrameDefect::kNone));
  if (!parsed.frame) return;
  if (bytes.size() <= kMaxFrameBytes) {
    const Bytes packed = PackFrame(*parsed.frame);
    Require(std::equal(packed.begin(), packed.end(), bytes.begin(), bytes.end()));
  }
  Require(CommandName(CodeOf(*parsed.frame)) != nullptr);
  CheckBodies(parsed.frame->data);
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const ByteView bytes(reinterpret_cast<const std::byte*>(data), size);
  Check(bytes);
  if (size < kFrameOverhead || size > 65535) return 0;
  Bytes mended(bytes.begin(), bytes.end());
  Store(std::span(mended), 2, static_cast<std::uint16_t>(size));
  Store(std::span(mended), 7, Crc16(ByteView(mended).first(7)));
  Store(std::span(mended), size - 4, Crc32(ByteView(mended).first(size - 4)));
  Check(mended);
  return 0;
}
