// SPDX-License-Identifier: BSD-3-Clause
#include "tools/relay/frame.hpp"

#include <algorithm>
#include <optional>

namespace clearway::relay {
namespace {

using Bytes = std::span<const std::byte>;

constexpr std::size_t kEthernetBytes = 14;
constexpr std::size_t kMinIpBytes = 20;
constexpr std::size_t kUdpBytes = 8;
constexpr std::size_t kSmallHeaderBytes = 8;
constexpr std::size_t kFragmentHeaderBytes = 20;
constexpr std::size_t kMaxChannelBytes = 63;
constexpr std::uint32_t kSmallMagic = 0x4c433032;     // "LC02"
constexpr std::uint32_t kFragmentMagic = 0x4c433033;  // "LC03"

// The caller has looked that they are there.
std::uint16_t Load16(Bytes bytes, std::size_t at) {
  return static_cast<std::uint16_t>(std::to_integer<unsigned>(bytes[at]) << 8U |
                                    std::to_integer<unsigned>(bytes[at + 1]));
}
std::uint32_t Load32(Bytes bytes, std::size_t at) {
  return static_cast<std::uint32_t>(Load16(bytes, at)) << 16U | Load16(bytes, at + 2);
}

// The channel and its NUL stand at the beginning of `bytes`.
std::optional<std::string_view> ChannelAt(Bytes bytes) {
  const Bytes longest = bytes.first(std::min(bytes.size(), kMaxChannelBytes + 1));
  const auto end = std::find(longest.begin(), longest.end(), std::byte{0});
  if (end == longest.begin() || end == longest.end()) return std::nullopt;
  return std::string_view(reinterpret_cast<const char*>(bytes.data()),
                          static_cast<std::size_t>(end - longest.begin()));
}

// `datagram_bytes` is the length of the whole UDP payload, of which `bytes` may be the beginning.
Frame WithSmallMessage(Frame frame, Bytes bytes, std::size_t datagram_bytes) {
  const auto channel = ChannelAt(bytes.subspan(kSmallHeaderBytes));
  if (!channel) return frame;
  frame.kind = FrameKind::kSmallMessage;
  frame.sequence = Load32(bytes, 4);
  frame.channel = *channel;
  frame.message_bytes = datagram_bytes - kSmallHeaderBytes - channel->size() - 1;
  return frame;
}

Frame WithFragment(Frame frame, Bytes bytes) {
  if (bytes.size() < kFragmentHeaderBytes) return frame;
  const std::uint16_t number = Load16(bytes, 16);
  if (number >= Load16(bytes, 18)) return frame;
  if (number == 0) {
    const auto channel = ChannelAt(bytes.subspan(kFragmentHeaderBytes));
    if (!channel) return frame;
    frame.channel = *channel;
  }
  frame.kind = number == 0 ? FrameKind::kFirstFragment : FrameKind::kLaterFragment;
  frame.sequence = Load32(bytes, 4);
  frame.message_bytes = Load32(bytes, 8);
  return frame;
}

// `ip_payload` begins with the UDP header.
Frame WithDatagram(Frame frame, Bytes ip_payload) {
  if (ip_payload.size() < kUdpBytes) return frame;
  const std::size_t udp_bytes = Load16(ip_payload, 4);
  const bool is_whole = udp_bytes <= ip_payload.size();
  if (udp_bytes < kUdpBytes || is_whole == frame.more_ip_fragments) return frame;
  frame.source_port = Load16(ip_payload, 0);
  frame.destination_port = Load16(ip_payload, 2);
  const Bytes bytes =
      ip_payload.subspan(kUdpBytes, std::min(udp_bytes, ip_payload.size()) - kUdpBytes);
  if (bytes.size() < kSmallHeaderBytes) return frame;
  switch (Load32(bytes, 0)) {
    case kSmallMagic:
      return WithSmallMessage(frame, bytes, udp_bytes - kUdpBytes);
    case kFragmentMagic:
      return WithFragment(frame, bytes);
    default:
      return frame;
  }
}

}  // namespace

Frame ParseFrame(Bytes bytes) {
  constexpr std::uint16_t kIpv4 = 0x0800;
  constexpr unsigned kUdp = 17;
  Frame frame;
  if (bytes.size() < kEthernetBytes + kMinIpBytes || Load16(bytes, 12) != kIpv4) return frame;
  const Bytes ip = bytes.subspan(kEthernetBytes);
  const unsigned version_and_length = std::to_integer<unsigned>(ip[0]);
  const std::size_t header_bytes = (version_and_length & 0xfU) * std::size_t{4};
  const std::size_t ip_bytes = Load16(ip, 2);  // A short frame is padded behind it.
  if (version_and_length >> 4U != 4 || header_bytes < kMinIpBytes || ip_bytes < header_bytes ||
      ip_bytes > ip.size() || std::to_integer<unsigned>(ip[9]) != kUdp) {
    return frame;
  }
  const unsigned fragment_word = Load16(ip, 6);
  frame.source_ip = Load32(ip, 12);
  frame.destination_ip = Load32(ip, 16);
  frame.ip_id = Load16(ip, 4);
  frame.more_ip_fragments = (fragment_word & 0x2000U) != 0;
  if ((fragment_word & 0x1fffU) != 0) {
    frame.kind = FrameKind::kLaterIpFragment;
    return frame;
  }
  return WithDatagram(frame, ip.subspan(header_bytes, ip_bytes - header_bytes));
}

}  // namespace clearway::relay
