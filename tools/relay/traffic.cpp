// SPDX-License-Identifier: BSD-3-Clause
#include "tools/relay/traffic.hpp"

#include <algorithm>

namespace clearway::relay {
namespace {

constexpr std::size_t kMaxChannels = 1000;

std::uint64_t IpSender(const Frame& frame) {
  return static_cast<std::uint64_t>(frame.source_ip) << 32U | frame.destination_ip;
}

std::uint64_t LcmSender(const Frame& frame) {
  return static_cast<std::uint64_t>(frame.source_ip) << 16U | frame.source_port;
}

void Start(ChannelTraffic& traffic) {
  traffic.interval_bytes = 0;
  traffic.interval_messages = 0;
}

}  // namespace

ChannelTraffic& TrafficMeter::ChannelOf(const Frame& frame) {
  ChannelKey key{std::string(frame.channel), frame.destination_port};
  const auto found = channels_.find(key);
  if (found != channels_.end()) return found->second;
  return channels_.size() < kMaxChannels ? channels_[std::move(key)] : other_;
}

ChannelTraffic& TrafficMeter::TrafficOf(const Frame& frame) {
  const auto known = [this](Owners& owners, std::uint64_t sender, std::uint32_t number) {
    const Owner& owner = Slot(owners, number);
    const bool is_known =
        owner.traffic != nullptr && owner.sender == sender && owner.number == number;
    return is_known ? owner.traffic : &other_;
  };
  switch (frame.kind) {
    case FrameKind::kOther:
      return other_;
    case FrameKind::kLaterIpFragment:
      return *known(ip_owners_, IpSender(frame), frame.ip_id);
    case FrameKind::kLaterFragment:
      return *known(lcm_owners_, LcmSender(frame), frame.sequence);
    case FrameKind::kFirstFragment:
    case FrameKind::kSmallMessage:
      break;
  }
  ChannelTraffic& traffic = ChannelOf(frame);
  ++traffic.messages;
  ++traffic.interval_messages;
  traffic.largest_message_bytes =
      std::max<std::uint64_t>(traffic.largest_message_bytes, frame.message_bytes);
  if (frame.kind == FrameKind::kFirstFragment) {
    Slot(lcm_owners_, frame.sequence) = {LcmSender(frame), frame.sequence, &traffic};
  }
  return traffic;
}

void TrafficMeter::Count(std::span<const std::byte> bytes) {
  const Frame frame = ParseFrame(bytes);
  ChannelTraffic& traffic = TrafficOf(frame);
  ++traffic.frames;
  traffic.bytes += bytes.size();
  traffic.interval_bytes += bytes.size();
  if (frame.more_ip_fragments && frame.kind != FrameKind::kLaterIpFragment) {
    Slot(ip_owners_, frame.ip_id) = {IpSender(frame), frame.ip_id, &traffic};
  }
}

void TrafficMeter::StartInterval() {
  for (auto& [key, traffic] : channels_) Start(traffic);
  Start(other_);
}

}  // namespace clearway::relay
