// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <exception>
#include <memory>
#include <string>
#include <vector>

#include "common/process/buses_config.hpp"
#include "common/process/runtime.hpp"
#include "common/process/timers.hpp"

namespace clearway::process {

class LcmConnection;

/// The real thing: LCM over UDP multicast, the machine's clocks, one thread of ours. (LCM has a
/// receiving thread of its own.)
class LiveRuntime final : public Runtime {
 public:
  /// Blocks SIGINT and SIGTERM for this thread and those it starts; Run() receives them.
  /// `channel_prefix` is put before every channel name. Throws std::runtime_error, with what to do
  /// about it, when a bus cannot be opened.
  LiveRuntime(const BusesConfig& buses, std::string channel_prefix);
  ~LiveRuntime() override;
  LiveRuntime(const LiveRuntime&) = delete;
  LiveRuntime& operator=(const LiveRuntime&) = delete;

  /// Handles messages and timers until SIGINT, SIGTERM or Stop(). An exception from a handler or
  /// timer leaves through here, never through LCM's C code.
  void Run();

  /// The same for a limited time, also after a signal or Stop().
  void RunFor(std::int64_t duration_us);

  /// Run() returns after the current handler.
  void Stop() { stop_ = true; }

  [[nodiscard]] std::int64_t MonotonicUs() const override;
  [[nodiscard]] std::int64_t UtimeNow() const override;
  [[nodiscard]] std::int64_t NewSession() override;
  [[nodiscard]] std::string HostName() const override;
  [[nodiscard]] int ProcessId() const override;
  void Publish(messages::BusId bus,
               const std::string& channel,
               std::span<const std::byte> bytes) override;
  [[nodiscard]] std::int64_t SendFailures() const override { return send_failures_; }
  void Subscribe(messages::BusId bus, const std::string& channel, BytesHandler handler) override;
  TimerId Every(std::int64_t period_us, std::function<void()> callback) override;
  TimerId After(std::int64_t delay_us, std::function<void()> callback) override;
  void Cancel(TimerId timer) override { timers_.Cancel(timer); }
  [[nodiscard]] std::size_t MaxMessageBytes(messages::BusId bus) const override;
  [[nodiscard]] std::int64_t BurstIntervalUs(messages::BusId bus) const override;
  [[nodiscard]] std::int64_t ReceiveBufferBytes() const override;

 private:
  [[nodiscard]] LcmConnection& ConnectionOf(messages::BusId bus) const;
  void WaitForEvents(std::vector<bool>& readable);
  void RunDueTimers();

  BusesConfig buses_;
  std::string channel_prefix_;
  std::vector<std::unique_ptr<LcmConnection>> connections_;  // One, or local and shared.
  Timers timers_;
  int signal_fd_ = -1;
  bool stop_ = false;
  std::int64_t send_failures_ = 0;
  bool last_send_failed_ = false;
};

}  // namespace clearway::process
