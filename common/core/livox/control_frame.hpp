// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>

#include "common/core/livox/little_endian.hpp"

namespace clearway::core::livox {

// Ports of Livox's SDK-1 protocol, UDP over IPv4.
inline constexpr std::uint16_t kBroadcastPort = 55000;  ///< Of the host: sensors announce here.
inline constexpr std::uint16_t kDevicePort = 65000;     ///< Of the sensor: commands go here.

/// Bytes of a frame round its data, and of the longest frame that is sent.
inline constexpr std::size_t kFrameOverhead = 15;
inline constexpr std::size_t kMaxFrameBytes = 1536;

enum class FrameType : std::uint8_t {
  kCommand = 0,  ///< Wants an acknowledgement.
  kAck = 1,      ///< The vendor's SDK sends its handshake as this one, too.
  kMessage = 2   ///< Wants none.
};

/// One control frame, without what frames it.
struct ControlFrame {
  FrameType type = FrameType::kCommand;
  std::uint16_t sequence = 0;  ///< An acknowledgement repeats that of its command.
  std::uint8_t command_set = 0;
  std::uint8_t command_id = 0;
  ByteView data = {};  ///< Of somebody else's buffer.
};

/// What is wrong with a datagram that should hold a control frame.
enum class FrameDefect : std::uint8_t {
  kNone,
  kTooShort,   ///< Less than kFrameOverhead bytes.
  kStart,      ///< Does not begin with 0xAA.
  kVersion,    ///< Not version 1.
  kLength,     ///< The length it states is not that of the datagram.
  kHeaderCrc,  ///< The first checksum does not match.
  kCrc,        ///< The second checksum does not match.
  kType,       ///< No FrameType.
};
inline constexpr std::size_t kNumFrameDefects = 8;
/// In words, for messages.
[[nodiscard]] const char* DefectText(FrameDefect defect);

struct ParsedFrame {
  std::optional<ControlFrame> frame;  ///< There exactly when `defect` is kNone.
  FrameDefect defect = FrameDefect::kNone;
};

/// Takes one datagram as one control frame: each alone, so that a broken one harms no other.
/// Layout: 0xAA, version 1, length u16, type u8, sequence u16, crc16, set u8, id u8, data, crc32.
/// O(n). `frame.data` points into `datagram`.
[[nodiscard]] ParsedFrame ParseFrame(ByteView datagram);

/// The bytes of a frame. @pre kFrameOverhead + data.size() <= kMaxFrameBytes.
[[nodiscard]] Bytes PackFrame(const ControlFrame& frame);

}  // namespace clearway::core::livox
