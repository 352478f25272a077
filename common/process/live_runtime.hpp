// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <exception>
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "common/process/buses_config.hpp"
#include "common/process/runtime.hpp"
#include "common/process/timers.hpp"

namespace clearway::process {

class LcmConnection;

/// What a runtime does where a bus cannot be opened.
enum class MissingNetwork {
  kThrow,  ///< A wrong set-up must not start.
  /// For what starts before any network is up: it lives, nothing arrives, and what it sends is lost
  /// and counted, until the bus can be opened. A bus is opened anew when the network changes.
  kWait,
};

/// The real thing: LCM over UDP multicast, the machine's clocks, one thread of ours. (LCM has a
/// receiving thread of its own.)
class LiveRuntime final : public Runtime {
 public:
  /// Blocks SIGINT, SIGTERM, SIGHUP, SIGQUIT, SIGCHLD and SIGWINCH for this thread and those it
  /// starts; Run() receives them. `channel_prefix` is put before every channel name. Throws
  /// std::runtime_error, with what to do about it, when a bus cannot be opened and is not waited
  /// for.
  LiveRuntime(const BusesConfig& buses,
              std::string channel_prefix,
              MissingNetwork missing_network = MissingNetwork::kThrow);
  ~LiveRuntime() override;
  LiveRuntime(const LiveRuntime&) = delete;
  LiveRuntime& operator=(const LiveRuntime&) = delete;

  /// Handles messages, descriptors and timers until a signal that asks to end or Stop(). An
  /// exception from a handler or timer leaves through here, never through LCM's C code.
  void Run();

  /// The same for a limited time, also after a signal or Stop().
  void RunFor(std::int64_t duration_us);

  /// Run() returns after the current handler.
  void Stop() { stop_ = true; }

  /// Hands all signals to `handler` instead: none of them ends Run() by itself then.
  void OnSignal(std::function<void(int signal)> handler) { on_signal_ = std::move(handler); }

  /// Calls `handler` whenever the descriptor is readable or hung up, until it is unwatched.
  void WatchDescriptor(int fd, std::function<void()> handler);
  void UnwatchDescriptor(int fd) { watched_.erase(fd); }

  /// Whether all buses are open; only a runtime that waits for its network ever says no.
  [[nodiscard]] bool IsConnected() const;

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
  /// Returns the watched descriptors that are ready.
  [[nodiscard]] std::vector<int> WaitForEvents(std::vector<bool>& readable);
  void TakeSignals();
  void HandleDescriptors(const std::vector<int>& ready);
  void RunDueTimers();
  void KeepConnected();

  BusesConfig buses_;
  std::string channel_prefix_;
  std::vector<std::unique_ptr<LcmConnection>> connections_;  // One, or local and shared.
  Timers timers_;
  std::map<int, std::function<void()>> watched_;
  std::function<void(int)> on_signal_;
  int signal_fd_ = -1;
  bool stop_ = false;
  std::int64_t send_failures_ = 0;
  bool last_send_failed_ = false;
};

}  // namespace clearway::process
