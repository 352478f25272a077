// SPDX-License-Identifier: BSD-3-Clause
#include "common/process/node.hpp"

#include <limits>
#include <set>

#include "common/process/log.hpp"

namespace clearway::process {
namespace {

constexpr std::int64_t kStatusPeriodUs = 1'000'000;
constexpr std::size_t kMaxStreams = 64;
// Scans that a process which was not scheduled for a while may hand on at once.
constexpr std::size_t kMaxWaitingBursts = 4;

// Counts saturate instead of overflowing: gaps of hostile sequence numbers are as large as it gets.
std::int64_t AddCounts(std::int64_t a, std::int64_t b) {
  constexpr std::int64_t kMost = std::numeric_limits<std::int64_t>::max();
  return a > kMost - b ? kMost : a + b;
}

}  // namespace

Node::Node(Runtime& runtime, Identity identity, messages::Channel<status_t> status_channel)
    : runtime_(runtime),
      identity_(std::move(identity)),
      status_channel_(status_channel),
      session_(runtime.NewSession()) {
  PublishStatus();
  runtime_.Every(kStatusPeriodUs, [this] { RefreshAndPublishStatus(); });
}

void Node::SetState(const State& state) {
  // The text may carry figures that change all the time; only a new code is worth a line.
  const bool changed = state.code != state_.code || state.ready != state_.ready;
  state_ = state;
  if (!changed) return;
  LogInfo("state: " + state.text);
  PublishStatus();
}

void Node::RefreshAndPublishStatus() {
  if (refresh_) refresh_();
  PublishStatus();
}

std::int64_t Node::InputAgeUs() const {
  return last_input_us_ < 0 ? -1 : runtime_.MonotonicUs() - last_input_us_;
}

void Node::NoteReceived() {
  ++received_;
  last_input_us_ = runtime_.MonotonicUs();
}

void Node::Track(const std::string& stream, std::int64_t session, std::int64_t sequence) {
  // Names come from outside: what is not one of the first few is not watched.
  if (trackers_.size() >= kMaxStreams && !trackers_.contains(stream)) return;
  trackers_[stream].Observe(session, sequence, runtime_.MonotonicUs());
}

void Node::Send(const Outgoing& outgoing) {
  runtime_.Publish(outgoing.bus, outgoing.channel, outgoing.bytes);
  ++published_;
}

void Node::DropOldBursts(const std::string& channel) {
  const auto waits = [&](const Outgoing& outgoing) {
    return outgoing.channel == channel && outgoing.burst != burst_under_way_;
  };
  std::set<std::int64_t> waiting;
  for (const Outgoing& outgoing : queue_) {
    if (waits(outgoing)) waiting.insert(outgoing.burst);
  }
  if (waiting.size() < kMaxWaitingBursts) return;
  const std::int64_t oldest = *waiting.begin();
  dropped_ += static_cast<std::int64_t>(std::erase_if(queue_, [&](const Outgoing& outgoing) {
    return waits(outgoing) && outgoing.burst == oldest;
  }));
}

void Node::SendNextOfQueue() {
  pump_running_ = !queue_.empty();
  if (!pump_running_) return;
  const Outgoing next = std::move(queue_.front());
  queue_.pop_front();
  burst_under_way_ = next.burst;
  Send(next);
  runtime_.After(runtime_.BurstIntervalUs(next.bus), [this] { SendNextOfQueue(); });
}

void Node::PublishStatus() {
  status_t status;
  status.utime = runtime_.UtimeNow();
  status.process = identity_.process;
  status.host = runtime_.HostName();
  status.pid = runtime_.ProcessId();
  status.version = identity_.version;
  status.config_digest = identity_.config_digest;
  status.state = state_.code;
  status.ready = static_cast<std::int8_t>(state_.ready);
  status.text = state_.text;
  status.received = received_;
  status.published = published_;
  status.dropped = dropped_;
  status.invalid = invalid_;
  status.missing = 0;
  status.foreign = 0;
  for (const auto& [stream, tracker] : trackers_) {
    status.missing = AddCounts(status.missing, tracker.counts().missing);
    status.foreign = AddCounts(status.foreign, tracker.counts().foreign);
  }
  const ProcessingTimes::Summary times = times_.Take();
  status.scans = static_cast<std::int32_t>(times.count);
  status.processing_median_ms = times.median_ms;
  status.processing_max_ms = times.max_ms;
  status.input_age_us = InputAgeUs();
  status.receive_buffer_bytes = runtime_.ReceiveBufferBytes();
  for (const auto& [name, value] : counters_) {
    counter_t counter;
    counter.name = name;
    counter.value = value;
    status.counters.push_back(counter);
  }
  counter_t send_failures;
  send_failures.name = "send_failures";
  send_failures.value = runtime_.SendFailures();
  status.counters.push_back(send_failures);
  status.n = static_cast<std::int32_t>(status.counters.size());
  Number(status_channel_.name, status);
  runtime_.Publish(status_channel_.bus, status_channel_.name, messages::Encode(status));
}

}  // namespace clearway::process
