// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "common/core/livox/data_packet.hpp"

namespace clearway::core::livox {

/// Packets that wait until their time is known, with bytes of their own.
class HeldPackets {
 public:
  static constexpr std::size_t kMax = 256;

  struct Held {
    DataPacket packet;  // Its payload is `bytes`.
    std::uint64_t device_ns = 0;
    bool is_reordered = false;
    std::array<std::byte, kMaxDataPacketBytes> bytes;
  };

  [[nodiscard]] bool empty() const { return size_ == 0; }
  [[nodiscard]] bool full() const { return size_ == kMax; }
  [[nodiscard]] std::size_t size() const { return size_; }
  void Clear() { size_ = 0; }

  /// @pre !full().
  void Push(const DataPacket& packet, std::uint64_t device_ns, bool is_reordered) {
    if (held_.empty()) held_.resize(kMax);
    Held& held = held_[size_++];
    held.packet = packet;
    held.device_ns = device_ns;
    held.is_reordered = is_reordered;
    std::copy(packet.payload.begin(), packet.payload.end(), held.bytes.begin());
    held.packet.payload = ByteView(held.bytes).first(packet.payload.size());
  }

  /// In order of their stamps; the first of equal ones came first.
  [[nodiscard]] std::vector<const Held*> InOrder() const {
    std::vector<const Held*> order;
    for (std::size_t i = 0; i < size_; ++i) order.push_back(&held_[i]);
    std::stable_sort(order.begin(), order.end(), [](const Held* a, const Held* b) {
      return static_cast<std::int64_t>(a->device_ns - b->device_ns) < 0;
    });
    return order;
  }

 private:
  std::vector<Held> held_;
  std::size_t size_ = 0;
};

}  // namespace clearway::core::livox
