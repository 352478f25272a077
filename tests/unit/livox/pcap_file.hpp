// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <stdexcept>
#include <string>
#include <vector>

#include "common/core/endpoint.hpp"
#include "common/core/livox/little_endian.hpp"

namespace clearway::test {

/// A UDP datagram of a capture.
struct CapturedDatagram {
  core::Endpoint source;
  core::Endpoint destination;
  core::livox::Bytes payload;
};

namespace internal {

inline std::uint32_t BigEndian(core::livox::ByteView bytes, std::size_t at, std::size_t count) {
  std::uint32_t value = 0;
  for (std::size_t i = 0; i < count; ++i) {
    value = value << 8U | static_cast<std::uint32_t>(bytes[at + i]);
  }
  return value;
}

}  // namespace internal

/// The whole UDP datagrams of a classic little-endian pcap file of Ethernet frames, in order; a
/// record that the file's end cuts is left out, and so is what is no UDP over IPv4.
inline std::vector<CapturedDatagram> ReadPcap(const std::filesystem::path& path) {
  std::ifstream stream(path, std::ios::binary);
  const std::string text{std::istreambuf_iterator<char>(stream), {}};
  const core::livox::ByteView file = std::as_bytes(std::span(text));
  if (file.size() < 24 || core::livox::Load<std::uint32_t>(file, 0) != 0xA1B2C3D4 ||
      core::livox::Load<std::uint32_t>(file, 20) != 1) {
    throw std::runtime_error(path.string() + ": no pcap file of Ethernet frames");
  }
  constexpr std::size_t kEthernetBytes = 14;
  std::vector<CapturedDatagram> datagrams;
  std::size_t at = 24;
  while (at + 16 <= file.size()) {
    const auto length = core::livox::Load<std::uint32_t>(file, at + 8);
    at += 16;
    if (length > file.size() - at) break;
    const core::livox::ByteView frame = file.subspan(at, length);
    at += length;
    if (length < kEthernetBytes + 28 || internal::BigEndian(frame, 12, 2) != 0x0800) continue;
    const core::livox::ByteView packet = frame.subspan(kEthernetBytes);
    const std::size_t ip_bytes = 4 * (static_cast<std::size_t>(packet[0]) & 0xFU);
    if (packet[9] != std::byte{17}) continue;
    const std::size_t udp_bytes = internal::BigEndian(packet, ip_bytes + 4, 2);
    const core::livox::ByteView payload = packet.subspan(ip_bytes + 8, udp_bytes - 8);
    const auto port = [&](std::size_t offset) {
      return static_cast<std::uint16_t>(internal::BigEndian(packet, ip_bytes + offset, 2));
    };
    datagrams.push_back({.source = {internal::BigEndian(packet, 12, 4), port(0)},
                         .destination = {internal::BigEndian(packet, 16, 4), port(2)},
                         .payload = {payload.begin(), payload.end()}});
  }
  return datagrams;
}

}  // namespace clearway::test
