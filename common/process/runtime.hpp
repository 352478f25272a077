// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <string>

#include "common/messages/channel.hpp"

namespace clearway::process {

/// What a process lives in: two buses, two clocks, timers. The same process object runs on a
/// LiveRuntime (LCM, real time) and on a SimulatedRuntime (in memory, virtual time).
/// All handlers and timers run one after the other on the thread that runs the runtime; no member
/// may be called from another thread.
class Runtime {
 public:
  using BytesHandler = std::function<void(std::span<const std::byte>)>;
  using TimerId = std::uint64_t;

  virtual ~Runtime() = default;

  /// A clock that never jumps, for ages and deadlines [us]. Its zero means nothing.
  [[nodiscard]] virtual std::int64_t MonotonicUs() const = 0;

  /// The time of day, for the stamps of messages [us since the epoch].
  [[nodiscard]] virtual std::int64_t UtimeNow() const = 0;

  /// A number that tells this life of a process from all others; positive.
  [[nodiscard]] virtual std::int64_t NewSession() = 0;

  /// Where the process runs, for its status: the host's name and the process id.
  [[nodiscard]] virtual std::string HostName() const = 0;
  [[nodiscard]] virtual int ProcessId() const = 0;

  /// Sends bytes. Throws std::runtime_error when the bus has never taken anything; what it refuses
  /// later is lost and counted by SendFailures().
  virtual void Publish(messages::BusId bus,
                       const std::string& channel,
                       std::span<const std::byte> bytes) = 0;

  /// Messages that a bus refused, since the start.
  [[nodiscard]] virtual std::int64_t SendFailures() const = 0;

  /// Calls `handler` with each message of exactly this channel. Throws std::runtime_error when the
  /// bus cannot be listened to.
  virtual void Subscribe(messages::BusId bus, const std::string& channel, BytesHandler handler) = 0;

  /// Calls `callback` every `period_us` > 0, first after one period. Missed calls are not made up.
  virtual TimerId Every(std::int64_t period_us, std::function<void()> callback) = 0;

  /// Calls `callback` once, `delay_us` from now (at once, but not from within this call, when <=
  /// 0).
  virtual TimerId After(std::int64_t delay_us, std::function<void()> callback) = 0;

  /// The timer does not fire any more. Unknown ids are ignored.
  virtual void Cancel(TimerId timer) = 0;

  /// Largest message that the bus may carry [bytes].
  [[nodiscard]] virtual std::size_t MaxMessageBytes(messages::BusId bus) const = 0;

  /// Time to leave between two messages of one burst [us].
  [[nodiscard]] virtual std::int64_t BurstIntervalUs(messages::BusId bus) const = 0;

  /// Least socket receive buffer that the kernel granted; -1 when nothing listens on a socket.
  [[nodiscard]] virtual std::int64_t ReceiveBufferBytes() const = 0;
};

}  // namespace clearway::process
