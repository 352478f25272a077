// SPDX-License-Identifier: BSD-3-Clause
#include "common/core/livox/control_frame.hpp"

#include <cassert>

#include "common/core/livox/crc.hpp"

namespace clearway::core::livox {
namespace {

constexpr std::byte kStart{0xAA};
constexpr std::byte kVersion{1};
constexpr std::size_t kHeaderBytes = 7;  // What the first checksum covers.
constexpr std::size_t kCrc32Bytes = 4;
constexpr std::size_t kDataOffset = 11;

FrameDefect Judge(ByteView datagram) {
  if (datagram.size() < kFrameOverhead) return FrameDefect::kTooShort;
  if (datagram[0] != kStart) return FrameDefect::kStart;
  if (datagram[1] != kVersion) return FrameDefect::kVersion;
  if (Load<std::uint16_t>(datagram, kHeaderBytes) != Crc16(datagram.first(kHeaderBytes))) {
    return FrameDefect::kHeaderCrc;
  }
  if (Load<std::uint16_t>(datagram, 2) != datagram.size()) return FrameDefect::kLength;
  const std::size_t crc_offset = datagram.size() - kCrc32Bytes;
  if (Load<std::uint32_t>(datagram, crc_offset) != Crc32(datagram.first(crc_offset))) {
    return FrameDefect::kCrc;
  }
  if (Load<std::uint8_t>(datagram, 4) > static_cast<std::uint8_t>(FrameType::kMessage)) {
    return FrameDefect::kType;
  }
  return FrameDefect::kNone;
}

}  // namespace

const char* DefectText(FrameDefect defect) {
  switch (defect) {
    case FrameDefect::kNone:
      return "nothing";
    case FrameDefect::kTooShort:
      return "shorter than a frame";
    case FrameDefect::kStart:
      return "does not begin with 0xAA";
    case FrameDefect::kVersion:
      return "not protocol version 1";
    case FrameDefect::kLength:
      return "states another length than it has";
    case FrameDefect::kHeaderCrc:
      return "wrong checksum of the header";
    case FrameDefect::kCrc:
      return "wrong checksum";
    case FrameDefect::kType:
      return "unknown frame type";
  }
  return "unknown";
}

ParsedFrame ParseFrame(ByteView datagram) {
  const FrameDefect defect = Judge(datagram);
  if (defect != FrameDefect::kNone) return {.frame = std::nullopt, .defect = defect};
  return {.frame =
              ControlFrame{.type = static_cast<FrameType>(datagram[4]),
                           .sequence = Load<std::uint16_t>(datagram, 5),
                           .command_set = Load<std::uint8_t>(datagram, 9),
                           .command_id = Load<std::uint8_t>(datagram, 10),
                           .data = datagram.subspan(kDataOffset, datagram.size() - kFrameOverhead)},
          .defect = FrameDefect::kNone};
}

Bytes PackFrame(const ControlFrame& frame) {
  assert(kFrameOverhead + frame.data.size() <= kMaxFrameBytes);
  Bytes bytes;
  bytes.reserve(kFrameOverhead + frame.data.size());
  bytes.push_back(kStart);
  bytes.push_back(kVersion);
  Append(bytes, static_cast<std::uint16_t>(kFrameOverhead + frame.data.size()));
  Append(bytes, static_cast<std::uint8_t>(frame.type));
  Append(bytes, frame.sequence);
  Append(bytes, Crc16(bytes));
  Append(bytes, frame.command_set);
  Append(bytes, frame.command_id);
  bytes.insert(bytes.end(), frame.data.begin(), frame.data.end());
  Append(bytes, Crc32(bytes));
  return bytes;
}

}  // namespace clearway::core::livox
