// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>

namespace clearway::relay {

/// What an Ethernet frame is to LCM.
enum class FrameKind {
  kOther,            ///< No IPv4/UDP, no LCM, or damaged.
  kSmallMessage,     ///< "LC02": a whole message in one datagram.
  kFirstFragment,    ///< "LC03", fragment 0: the only one that names the channel.
  kLaterFragment,    ///< "LC03", any other.
  kLaterIpFragment,  ///< Of a UDP datagram; its ports and what it carries stand in the first one.
};

/// An Ethernet frame as far as it is understood; all fields that its kind does not have are 0.
/// Source: LCM's udp-multicast-protocol.md; RFC 791 for IPv4, RFC 768 for UDP.
struct Frame {
  FrameKind kind = FrameKind::kOther;
  std::uint32_t source_ip = 0;  ///< Host byte order, as all numbers here.
  std::uint32_t destination_ip = 0;
  std::uint16_t ip_id = 0;  ///< The same in all IP fragments of a datagram.
  bool more_ip_fragments = false;
  std::uint16_t source_port = 0;
  std::uint16_t destination_port = 0;
  std::uint32_t sequence = 0;     ///< LCM's; the same in all LCM fragments of a message.
  std::string_view channel;       ///< 1 to 63 bytes, into the frame that was parsed.
  std::size_t message_bytes = 0;  ///< Payload of the whole message, without the channel.
};

/// Never reads beyond `bytes`; any bytes are allowed. O(1).
[[nodiscard]] Frame ParseFrame(std::span<const std::byte> bytes);

}  // namespace clearway::relay
