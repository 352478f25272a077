// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "common/process/runtime.hpp"

namespace clearway::test {

/// A bad wire: a runtime that hands everything on to another one, except that what is published on
/// one channel may be lost, repeated or delayed as the test decides.
class RelayRuntime final : public process::Runtime {
 public:
  /// What becomes of one message: a delay [us] for each copy that arrives. {} loses it, {0} sends
  /// it at once, {0, 0} repeats it.
  using Deliveries = std::vector<std::int64_t>;
  using Decide = std::function<Deliveries(std::span<const std::byte>)>;

  RelayRuntime(process::Runtime& inner, std::string channel, Decide decide)
      : inner_(inner), channel_(std::move(channel)), decide_(std::move(decide)) {}

  void Publish(messages::BusId bus,
               const std::string& channel,
               std::span<const std::byte> bytes) override {
    if (channel != channel_) {
      inner_.Publish(bus, channel, bytes);
      return;
    }
    for (const std::int64_t delay_us : decide_(bytes)) {
      if (delay_us <= 0) {
        inner_.Publish(bus, channel, bytes);
        continue;
      }
      inner_.After(delay_us, [this, bus, channel, copy = std::vector(bytes.begin(), bytes.end())] {
        inner_.Publish(bus, channel, copy);
      });
    }
  }

  [[nodiscard]] std::int64_t MonotonicUs() const override { return inner_.MonotonicUs(); }
  [[nodiscard]] std::int64_t UtimeNow() const override { return inner_.UtimeNow(); }
  [[nodiscard]] std::int64_t NewSession() override { return inner_.NewSession(); }
  [[nodiscard]] std::string HostName() const override { return inner_.HostName(); }
  [[nodiscard]] int ProcessId() const override { return inner_.ProcessId(); }
  void Subscribe(messages::BusId bus, const std::string& channel, BytesHandler handler) override {
    inner_.Subscribe(bus, channel, std::move(handler));
  }
  TimerId Every(std::int64_t period_us, std::function<void()> callback) override {
    return inner_.Every(period_us, std::move(callback));
  }
  TimerId After(std::int64_t delay_us, std::function<void()> callback) override {
    return inner_.After(delay_us, std::move(callback));
  }
  void Cancel(TimerId timer) override { inner_.Cancel(timer); }
  [[nodiscard]] std::size_t MaxMessageBytes(messages::BusId bus) const override {
    return inner_.MaxMessageBytes(bus);
  }
  [[nodiscard]] std::int64_t BurstIntervalUs(messages::BusId bus) const override {
    return inner_.BurstIntervalUs(bus);
  }
  [[nodiscard]] std::int64_t SendFailures() const override { return inner_.SendFailures(); }
  [[nodiscard]] std::int64_t ReceiveBufferBytes() const override {
    return inner_.ReceiveBufferBytes();
  }

 private:
  process::Runtime& inner_;
  std::string channel_;
  Decide decide_;
};

}  // namespace clearway::test
