// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <utility>
#include <vector>

namespace clearway::relay {

using Bytes = std::vector<std::byte>;

inline void Put(Bytes& bytes, std::uint64_t value, int num_bytes) {
  for (int i = num_bytes - 1; i >= 0; --i) {
    bytes.push_back(static_cast<std::byte>(value >> (8 * static_cast<unsigned>(i))));
  }
}

inline void Put(Bytes& bytes, const std::string& text) {
  for (const char c : text) bytes.push_back(static_cast<std::byte>(c));
  bytes.push_back(std::byte{0});
}

inline Bytes Joined(Bytes a, std::span<const std::byte> b) {
  a.insert(a.end(), b.begin(), b.end());
  return a;
}

/// A datagram's payload: a small message.
inline Bytes SmallMessage(const std::string& channel,
                          std::size_t message_bytes,
                          std::uint32_t sequence = 7) {
  Bytes bytes;
  Put(bytes, 0x4c433032, 4);
  Put(bytes, sequence, 4);
  Put(bytes, channel);
  bytes.resize(bytes.size() + message_bytes, std::byte{0x55});
  return bytes;
}

/// One fragment of a message of `message_bytes`.
inline Bytes LcmFragment(const std::string& channel,
                         std::size_t message_bytes,
                         std::uint16_t number,
                         std::uint16_t count,
                         std::uint32_t sequence = 7) {
  Bytes bytes;
  Put(bytes, 0x4c433033, 4);
  Put(bytes, sequence, 4);
  Put(bytes, message_bytes, 4);
  Put(bytes, number * std::uint64_t{1000}, 4);
  Put(bytes, number, 2);
  Put(bytes, count, 2);
  if (number == 0) Put(bytes, channel);
  bytes.resize(bytes.size() + 1000, std::byte{0x55});
  return bytes;
}

struct Datagram {
  std::uint32_t source_ip = 0x0a4d0001;
  std::uint16_t ip_id = 1;
  std::uint16_t source_port = 40000;
  std::uint16_t destination_port = 7667;
  std::size_t bytes_per_frame = 1480;  ///< Of IP payload.
  std::size_t ip_option_bytes = 0;
};

/// The Ethernet frames of a UDP datagram to 239.255.76.67; several when it has to be split.
inline std::vector<Bytes> Frames(const Bytes& payload, const Datagram& datagram = {}) {
  Bytes ip_payload;
  Put(ip_payload, datagram.source_port, 2);
  Put(ip_payload, datagram.destination_port, 2);
  Put(ip_payload, payload.size() + 8, 2);
  Put(ip_payload, 0, 2);
  ip_payload = Joined(std::move(ip_payload), payload);
  std::vector<Bytes> frames;
  for (std::size_t at = 0; at < ip_payload.size(); at += datagram.bytes_per_frame) {
    const std::size_t length = std::min(datagram.bytes_per_frame, ip_payload.size() - at);
    const bool is_last = at + length == ip_payload.size();
    Bytes frame(12, std::byte{0x02});
    Put(frame, 0x0800, 2);
    Put(frame, 0x45 + datagram.ip_option_bytes / 4, 1);
    Put(frame, 0, 1);
    Put(frame, 20 + datagram.ip_option_bytes + length, 2);
    Put(frame, datagram.ip_id, 2);
    Put(frame, (is_last ? 0U : 0x2000U) | at / 8, 2);
    Put(frame, 1, 1);   // Time to live.
    Put(frame, 17, 1);  // UDP.
    Put(frame, 0, 2);
    Put(frame, datagram.source_ip, 4);
    Put(frame, 0xefff4c43, 4);
    frame.resize(frame.size() + datagram.ip_option_bytes, std::byte{1});
    frames.push_back(Joined(std::move(frame), std::span(ip_payload).subspan(at, length)));
  }
  return frames;
}

inline Bytes OneFrame(const Bytes& payload, const Datagram& datagram = {}) {
  return Frames(payload, datagram).at(0);
}

}  // namespace clearway::relay
