// SPDX-License-Identifier: BSD-3-Clause
#include "tools/relay/delay_line.hpp"

namespace clearway::relay {

bool DelayLine::Push(DelayedPacket packet) {
  if (packet.bytes->size() > max_bytes_ - num_bytes_) return false;
  num_bytes_ += packet.bytes->size();
  packets_.push({std::move(packet), next_number_++});
  return true;
}

std::optional<DelayedPacket> DelayLine::PopDue(std::int64_t now_ns) {
  if (packets_.empty() || packets_.top().packet.due_ns > now_ns) return std::nullopt;
  DelayedPacket packet = packets_.top().packet;
  packets_.pop();
  num_bytes_ -= packet.bytes->size();
  return packet;
}

std::optional<std::int64_t> DelayLine::next_due_ns() const {
  if (packets_.empty()) return std::nullopt;
  return packets_.top().packet.due_ns;
}

}  // namespace clearway::relay
