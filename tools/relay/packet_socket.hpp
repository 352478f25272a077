// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>

namespace clearway::relay {

/// The frames of one network interface. Each goes with a virtio_net_hdr before it, which says what
/// of checksum and segmentation was left to the hardware: between veth interfaces nothing does it,
/// and a frame sent on without that word would be damaged. Needs CAP_NET_RAW.
class PacketSocket {
 public:
  /// Bytes before the frame in every packet: the size of virtio_net_hdr, whose header in Debian 12
  /// is no C++.
  static constexpr std::size_t kHeaderBytes = 10;
  /// Room for every packet: segmentation offload makes frames of up to 64 KiB.
  static constexpr std::size_t kMaxPacketBytes = (std::size_t{64} << 10U) + 512;

  /// Throws std::runtime_error when there is no such interface or it may not be opened.
  explicit PacketSocket(const std::string& interface_name);
  ~PacketSocket();
  PacketSocket(const PacketSocket&) = delete;
  PacketSocket& operator=(const PacketSocket&) = delete;

  [[nodiscard]] int file_descriptor() const { return file_descriptor_; }

  /// The next packet that came in, in `buffer`; nothing when none waits.
  [[nodiscard]] std::optional<std::span<const std::byte>> Receive(std::span<std::byte> buffer);

  /// Whether the interface took it.
  [[nodiscard]] bool Send(std::span<const std::byte> packet);

  /// Frames that came faster than they were read, since the start.
  [[nodiscard]] std::uint64_t KernelDrops();

 private:
  int file_descriptor_ = -1;
  std::uint64_t kernel_drops_ = 0;
};

}  // namespace clearway::relay
