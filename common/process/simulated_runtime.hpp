// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <deque>
#include <memory>
#include <vector>

#include "common/process/runtime.hpp"
#include "common/process/timers.hpp"

namespace clearway::process {

/// An in-memory bus in virtual time, on one thread: many process objects share one. Messages are
/// delivered in the order in which they were published, to the subscribers in the order in which
/// they subscribed, after the handler that published them has returned. Virtual time moves only
/// between events, so a handler takes no time. Same events in, same events out, always.
class SimulatedRuntime final : public Runtime {
 public:
  struct Limits {
    std::size_t max_message_bytes = 58000;
    std::int64_t burst_interval_us = 2000;
  };
  using Tap = std::function<
      void(messages::BusId bus, const std::string& channel, std::span<const std::byte> bytes)>;

  /// Virtual time starts at `start_utime` [us since the epoch].
  SimulatedRuntime(std::int64_t start_utime, const Limits& limits);

  /// Delivers what is pending and runs timers in order until virtual time is `utime`. An exception
  /// from a handler leaves through here.
  void RunUntil(std::int64_t utime);

  /// Sees every message when it is delivered, before the subscribers do (logs, tests).
  void SetTap(Tap tap) { tap_ = std::move(tap); }

  [[nodiscard]] std::int64_t MonotonicUs() const override { return now_us_; }
  [[nodiscard]] std::int64_t UtimeNow() const override { return now_us_; }
  [[nodiscard]] std::int64_t NewSession() override { return next_session_++; }
  [[nodiscard]] std::string HostName() const override { return "simulated"; }
  [[nodiscard]] int ProcessId() const override { return 0; }
  void Publish(messages::BusId bus,
               const std::string& channel,
               std::span<const std::byte> bytes) override;
  [[nodiscard]] std::int64_t SendFailures() const override { return 0; }
  void Subscribe(messages::BusId bus, const std::string& channel, BytesHandler handler) override;
  TimerId Every(std::int64_t period_us, std::function<void()> callback) override;
  TimerId After(std::int64_t delay_us, std::function<void()> callback) override;
  void Cancel(TimerId timer) override { timers_.Cancel(timer); }
  [[nodiscard]] std::size_t MaxMessageBytes(messages::BusId) const override {
    return limits_.max_message_bytes;
  }
  [[nodiscard]] std::int64_t BurstIntervalUs(messages::BusId) const override {
    return limits_.burst_interval_us;
  }
  [[nodiscard]] std::int64_t ReceiveBufferBytes() const override { return -1; }

 private:
  struct Subscriber {
    messages::BusId bus;
    std::string channel;
    BytesHandler handler;
  };
  struct Message {
    messages::BusId bus;
    std::string channel;
    std::vector<std::byte> bytes;
  };

  void DeliverPending();

  std::int64_t now_us_;
  Limits limits_;
  std::int64_t next_session_ = 1;
  Timers timers_;
  // A deque: handlers may subscribe while messages are delivered.
  std::deque<Subscriber> subscribers_;
  std::deque<Message> pending_;
  Tap tap_;
};

}  // namespace clearway::process
