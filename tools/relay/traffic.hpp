// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <compare>
#include <cstddef>
#include <cstdint>
#include <map>
#include <span>
#include <string>

#include "tools/relay/frame.hpp"

namespace clearway::relay {

/// What has been counted of a channel.
struct ChannelTraffic {
  std::uint64_t frames = 0;
  std::uint64_t bytes = 0;  ///< On the wire: Ethernet, IP, UDP and LCM headers are in it.
  std::uint64_t messages = 0;
  std::uint64_t largest_message_bytes = 0;  ///< Without headers and channel.
  std::uint64_t interval_bytes = 0;         ///< Since StartInterval().
  std::uint64_t interval_messages = 0;      ///< Likewise.
};

struct ChannelKey {
  std::string channel;
  std::uint16_t udp_port = 0;

  auto operator<=>(const ChannelKey&) const = default;
};

/// Counts the LCM traffic that comes in by one port. Fragments of LCM and of IP are counted to the
/// channel of their message as long as the message's first frame went by before them and is among
/// the last few thousand; else they are `other`.
class TrafficMeter {
 public:
  TrafficMeter() = default;
  TrafficMeter(const TrafficMeter&) = delete;
  TrafficMeter& operator=(const TrafficMeter&) = delete;

  void Count(std::span<const std::byte> frame);

  /// Of the first 1000 channels; further ones are `other`.
  [[nodiscard]] const std::map<ChannelKey, ChannelTraffic>& channels() const { return channels_; }
  /// All that is not LCM, or not known to be.
  [[nodiscard]] const ChannelTraffic& other() const { return other_; }

  void StartInterval();

 private:
  // Whose a fragment is. A table of fixed size in which newer messages replace older ones.
  struct Owner {
    std::uint64_t sender = 0;
    std::uint32_t number = 0;
    ChannelTraffic* traffic = nullptr;
  };
  using Owners = std::array<Owner, 4096>;

  static Owner& Slot(Owners& owners, std::uint32_t number) {
    return owners[number % owners.size()];
  }
  ChannelTraffic& TrafficOf(const Frame& frame);
  ChannelTraffic& ChannelOf(const Frame& frame);

  std::map<ChannelKey, ChannelTraffic> channels_;  // Owners point into it.
  ChannelTraffic other_;
  Owners ip_owners_{};
  Owners lcm_owners_{};
};

}  // namespace clearway::relay
