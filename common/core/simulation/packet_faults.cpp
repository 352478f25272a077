// SPDX-License-Identifier: BSD-3-Clause
#include "common/core/simulation/packet_faults.hpp"

#include <algorithm>
#include <cmath>

#include "common/core/simulation/noise.hpp"

namespace clearway::core {
namespace {

constexpr std::int64_t kLongestJitter_us = 1'000'000;
// The second copy leaves this much after the first.
constexpr std::int64_t kCopyDelay_us = 1'000;

// What is drawn for each packet, each from a stream of its own.
constexpr std::uint64_t kLoss = 0;
constexpr std::uint64_t kDuplicate = 1;
constexpr std::uint64_t kReorder = 2;
constexpr std::uint64_t kJitter = 3;
constexpr std::uint64_t kControl = 4;
constexpr std::uint64_t kNumDraws = 8;

}  // namespace

const NetworkFaultConfig* PacketFaults::FaultAt(std::int64_t now_us) const {
  const auto fault = std::find_if(faults_.begin(), faults_.end(), [now_us](const auto& each) {
    return each.times.Hold(now_us);
  });
  return fault == faults_.end() ? nullptr : &*fault;
}

// Uniform in [0, 1).
double PacketFaults::Draw(std::int64_t number, std::uint64_t what) const {
  const std::uint64_t counter = static_cast<std::uint64_t>(number) * kNumDraws + what;
  const std::uint64_t bits = SplitMix64(SplitMix64(seed_) ^ counter);
  return static_cast<double>(bits >> 11U) * 0x1.0p-53;
}

std::int64_t PacketFaults::Jitter(const NetworkFaultConfig& fault, std::int64_t number) const {
  const double share = Draw(number, kJitter);
  const double scale = fault.jitter_shape == JitterShape::kUniform ? share : -std::log1p(-share);
  const double jitter_us = scale * static_cast<double>(fault.jitter_us);
  return std::min(static_cast<std::int64_t>(jitter_us), kLongestJitter_us);
}

void PacketFaults::Put(Packet packet, std::int64_t now_us) {
  const std::int64_t number = next_number_++;
  const NetworkFaultConfig* fault = FaultAt(now_us);
  if (fault == nullptr) {
    last_due_us_ = std::max(last_due_us_, now_us);
    Enqueue(last_due_us_, {std::move(packet), number, false});
    return;
  }
  if (Draw(number, kLoss) < fault->loss) {
    ++counts_.lost;
    return;
  }
  std::int64_t due_us = now_us + Jitter(*fault, number);
  if (fault->jitter_keeps_order) {
    due_us = std::max(due_us, last_due_us_);
    last_due_us_ = due_us;
  }
  if (Draw(number, kReorder) < fault->reorder) due_us += fault->reorder_us;
  if (Draw(number, kDuplicate) < fault->duplicates) {
    Enqueue(due_us + kCopyDelay_us, {packet, number, true});
  }
  Enqueue(due_us, {std::move(packet), number, false});
}

void PacketFaults::Enqueue(std::int64_t due_us, UnderWay under_way) {
  queue_.emplace(std::pair(due_us, num_enqueued_++), std::move(under_way));
}

std::optional<PacketFaults::Packet> PacketFaults::Take(std::int64_t now_us) {
  if (queue_.empty() || queue_.begin()->first.first > now_us) return std::nullopt;
  UnderWay next = std::move(queue_.begin()->second);
  queue_.erase(queue_.begin());
  if (next.is_copy) {
    ++counts_.duplicates;
  } else if (next.number < newest_out_) {
    ++counts_.reordered;
  }
  newest_out_ = std::max(newest_out_, next.number);
  return std::move(next.packet);
}

std::optional<std::int64_t> PacketFaults::NextDue() const {
  if (queue_.empty()) return std::nullopt;
  return queue_.begin()->first.first;
}

void PacketFaults::DropAll() {
  counts_.lost += std::count_if(
      queue_.begin(), queue_.end(), [](const auto& entry) { return !entry.second.is_copy; });
  queue_.clear();
}

bool PacketFaults::LosesControl(std::int64_t now_us) {
  const NetworkFaultConfig* fault = FaultAt(now_us);
  const std::int64_t number = num_control_++;
  if (fault == nullptr || Draw(number, kControl) >= fault->control_loss) return false;
  ++counts_.control_lost;
  return true;
}

}  // namespace clearway::core
