// SPDX-License-Identifier: BSD-3-Clause
#include "common/core/procman/output_queue.hpp"

#include <algorithm>

namespace clearway::core::procman {
namespace {

// Of one command; more is dropped.
constexpr std::size_t kMaxWaitingBytes = 65536;
// Length fields and ends of the two strings of one command in a message.
constexpr std::size_t kFieldBytes = 10;
// Ids are bounded where they are defined by people, not on the wire.
constexpr std::size_t kLeastTextBytes = 64;

}  // namespace

OutputQueue::OutputQueue(const OutputConfig& config, std::size_t max_text_bytes)
    : config_(config), max_text_bytes_(max_text_bytes), credit_bytes_(config.bytes_per_s) {}

void OutputQueue::Add(const std::string& command_id, std::string_view text, std::int64_t now_us) {
  if (text.empty()) return;
  if (waiting_.empty()) since_us_ = now_us;
  Waiting& waiting = waiting_[command_id];
  if (waiting.text.size() + text.size() > kMaxWaitingBytes) {
    const auto bytes = static_cast<std::int64_t>(text.size());
    waiting.unsaid_bytes += bytes;
    dropped_[command_id] += bytes;
    return;
  }
  SayWhatWasDropped(waiting);
  for (const char c : text) {
    if (c == '\0') {
      waiting.text += "^@";
    } else {
      waiting.text += c;
    }
  }
}

void OutputQueue::SayWhatWasDropped(Waiting& waiting) {
  if (waiting.unsaid_bytes == 0) return;
  waiting.text += "\n[" + std::to_string(waiting.unsaid_bytes) +
                  " bytes of output were not sent: too much at once. The log on disk has them.]\n";
  waiting.unsaid_bytes = 0;
}

std::vector<OutputQueue::Batch> OutputQueue::Take(std::int64_t now_us) {
  std::vector<Batch> batches;
  Refill(now_us);
  if (waiting_.empty() || now_us - since_us_ < config_.batch_us) return batches;
  while (!waiting_.empty() && credit_bytes_ > 0.0) batches.push_back(NextBatch());
  since_us_ = now_us;
  return batches;
}

void OutputQueue::Refill(std::int64_t now_us) {
  const double rate = config_.bytes_per_s;
  credit_bytes_ += rate * static_cast<double>(now_us - refilled_us_) * 1e-6;
  credit_bytes_ = std::min(credit_bytes_, rate);
  refilled_us_ = now_us;
}

// One message: of each command in turn as much as fits.
OutputQueue::Batch OutputQueue::NextBatch() {
  Batch batch;
  std::size_t room = max_text_bytes_;
  auto next = waiting_.upper_bound(last_served_);
  while (!waiting_.empty()) {
    if (next == waiting_.end()) next = waiting_.begin();
    auto& [id, waiting] = *next;
    const std::size_t overhead = id.size() + kFieldBytes;
    if (!batch.empty() && room < overhead + kLeastTextBytes) break;
    const std::size_t fits = room > overhead + kLeastTextBytes ? room - overhead : kLeastTextBytes;
    batch.emplace_back(id, waiting.text.substr(0, fits));
    waiting.text.erase(0, fits);
    credit_bytes_ -= static_cast<double>(batch.back().second.size() + overhead);
    room -= std::min(room, batch.back().second.size() + overhead);
    last_served_ = id;
    if (waiting.text.empty()) SayWhatWasDropped(waiting);
    if (!waiting.text.empty()) break;  // The message is full.
    next = waiting_.erase(next);
  }
  return batch;
}

std::optional<std::int64_t> OutputQueue::NextDue() const {
  if (waiting_.empty()) return std::nullopt;
  const double lacking = std::max(0.0, 1.0 - credit_bytes_);
  const auto refill_us = static_cast<std::int64_t>(lacking / config_.bytes_per_s * 1e6) + 1;
  return std::max(since_us_ + config_.batch_us, refilled_us_ + refill_us);
}

std::int64_t OutputQueue::DroppedBytes(const std::string& command_id) const {
  const auto found = dropped_.find(command_id);
  return found == dropped_.end() ? 0 : found->second;
}

}  // namespace clearway::core::procman
