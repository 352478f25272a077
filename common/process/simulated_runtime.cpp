// SPDX-License-Identifier: BSD-3-Clause
#include "common/process/simulated_runtime.hpp"

#include <stdexcept>

namespace clearway::process {

SimulatedRuntime::SimulatedRuntime(std::int64_t start_utime, const Limits& limits)
    : now_us_(start_utime), limits_(limits) {}

void SimulatedRuntime::RunUntil(std::int64_t utime) {
  DeliverPending();
  for (auto due = timers_.NextDue(); due && *due <= utime; due = timers_.NextDue()) {
    now_us_ = std::max(now_us_, *due);
    timers_.RunOne(now_us_);
    DeliverPending();
  }
  now_us_ = std::max(now_us_, utime);
}

void SimulatedRuntime::Publish(messages::BusId bus,
                               const std::string& channel,
                               std::span<const std::byte> bytes) {
  pending_.push_back({bus, channel, {bytes.begin(), bytes.end()}});
}

void SimulatedRuntime::Subscribe(messages::BusId bus,
                                 const std::string& channel,
                                 BytesHandler handler) {
  subscribers_.push_back({bus, channel, std::move(handler)});
}

Runtime::TimerId SimulatedRuntime::Every(std::int64_t period_us, std::function<void()> callback) {
  if (period_us <= 0) throw std::invalid_argument("Runtime::Every: period must be positive");
  return timers_.Add(now_us_ + period_us, period_us, std::move(callback));
}

Runtime::TimerId SimulatedRuntime::After(std::int64_t delay_us, std::function<void()> callback) {
  return timers_.Add(now_us_ + std::max<std::int64_t>(delay_us, 0), 0, std::move(callback));
}

void SimulatedRuntime::DeliverPending() {
  while (!pending_.empty()) {
    const Message message = std::move(pending_.front());
    pending_.pop_front();
    if (tap_) tap_(message.bus, message.channel, message.bytes);
    const std::size_t count = subscribers_.size();
    for (std::size_t i = 0; i < count; ++i) {
      Subscriber& subscriber = subscribers_[i];
      if (subscriber.bus == message.bus && subscriber.channel == message.channel) {
        subscriber.handler(message.bytes);
      }
    }
  }
}

}  // namespace clearway::process
