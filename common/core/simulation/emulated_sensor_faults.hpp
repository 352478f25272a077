// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "common/core/endpoint.hpp"
#include "common/core/livox/device_status.hpp"
#include "common/core/simulation/injected_errors.hpp"

// What can be wrong with an emulated sensor, each in an element of its own.
namespace clearway::core {

/// How jitter is spread.
enum class JitterShape : std::uint8_t { kUniform, kExponential };
inline constexpr std::array<std::pair<const char*, JitterShape>, 2> kJitterShapeNames{
    {{"uniform", JitterShape::kUniform}, {"exponential", JitterShape::kExponential}}};

/// A bad network between a sensor and its host. XML element: <simulator><mid70><network_fault>.
struct NetworkFaultConfig {
  ErrorTimes times = {};
  double loss = 0.0;
  double duplicates = 0.0;
  double reorder = 0.0;
  std::int64_t reorder_us = 3'000;
  std::int64_t jitter_us = 0;
  JitterShape jitter_shape = JitterShape::kUniform;
  bool jitter_keeps_order = true;
  double control_loss = 0.0;

  template <typename Self, typename Visitor>
  static void Visit(Self& self, Visitor& visitor) {
    ErrorTimes::Visit(self.times, visitor);
    visitor.Number("loss", self.loss, 0.0, 1.0, "Share of the data packets that never arrive.");
    visitor.Number("duplicates", self.duplicates, 0.0, 1.0, "Share of them that arrives twice.");
    visitor.Number("reorder", self.reorder, 0.0, 1.0, "Share of them that is held back.");
    visitor.Milliseconds("reorder_ms",
                         self.reorder_us,
                         0.001,
                         1000.0,
                         "For how long: less than the time of a packet changes no order [ms].");
    VisitJitter(self, visitor);
    visitor.Number("control_loss",
                   self.control_loss,
                   0.0,
                   1.0,
                   "Share of the commands, answers and broadcasts that never arrive.");
  }
  [[nodiscard]] std::vector<std::string> Validate() const { return times.Validate(); }

 private:
  template <typename Self, typename Visitor>
  static void VisitJitter(Self& self, Visitor& visitor) {
    visitor.Milliseconds("jitter_ms",
                         self.jitter_us,
                         0.0,
                         1000.0,
                         "Each data packet is late: uniform between 0 and this, or exponential "
                         "with this mean and at most 1 s [ms].");
    visitor.Choice("jitter_shape", self.jitter_shape, kJitterShapeNames, "How it is spread.");
    visitor.Flag("jitter_keeps_order",
                 self.jitter_keeps_order,
                 "A packet waits for the one before it, as in a queue.");
  }
};

/// What a sensor does not say.
enum class Silenced : std::uint8_t { kAll, kData, kHeartbeats };
inline constexpr std::array<std::pair<const char*, Silenced>, 3> kSilencedNames{
    {{"all", Silenced::kAll}, {"data", Silenced::kData}, {"heartbeats", Silenced::kHeartbeats}}};

/// A sensor that is not heard. XML element: <simulator><mid70><silence>.
struct SilenceConfig {
  ErrorTimes times = {};
  Silenced what = Silenced::kAll;

  template <typename Self, typename Visitor>
  static void Visit(Self& self, Visitor& visitor) {
    ErrorTimes::Visit(self.times, visitor);
    visitor.Choice("what",
                   self.what,
                   kSilencedNames,
                   "\"all\": as with the cable pulled; \"data\": no points; \"heartbeats\": no "
                   "answers to them.");
  }
  [[nodiscard]] std::vector<std::string> Validate() const { return times.Validate(); }
};

/// A sensor without power. XML element: <simulator><mid70><power_cut>.
struct PowerCutConfig {
  ErrorTimes times = {};

  template <typename Self, typename Visitor>
  static void Visit(Self& self, Visitor& visitor) {
    ErrorTimes::Visit(self.times, visitor);
  }
  [[nodiscard]] std::vector<std::string> Validate() const { return times.Validate(); }
};

/// A jump of a sensor's own clock. XML element: <simulator><mid70><clock_step>.
struct ClockStepConfig {
  double at_s = 0.0;
  double step_s = 1.0;
  bool reset = false;

  template <typename Self, typename Visitor>
  static void Visit(Self& self, Visitor& visitor) {
    visitor.Number("at_s", self.at_s, 0.0, 86400.0, "When, after the simulator's start [s].");
    visitor.Number("step_s", self.step_s, -86400.0, 86400.0, "By how much [s].");
    visitor.Flag("reset", self.reset, "It begins anew at 0 instead, as after power on.");
  }
};

/// A sensor that gets another address. XML element: <simulator><mid70><address_change>.
struct AddressChangeConfig {
  double at_s = 0.0;
  std::string ip = "127.0.0.3";

  template <typename Self, typename Visitor>
  static void Visit(Self& self, Visitor& visitor) {
    visitor.Number("at_s", self.at_s, 0.0, 86400.0, "When, after the simulator's start [s].");
    visitor.Text("ip", self.ip, "Its new address.");
  }
  [[nodiscard]] std::vector<std::string> Validate() const {
    if (ParseIpv4(ip)) return {};
    return {"ip \"" + ip + "\" is not an address like 192.168.1.101"};
  }
};

inline constexpr std::array<std::pair<const char*, livox::Severity>, 3> kSeverityNames{
    {{"ok", livox::Severity::kOk},
     {"warning", livox::Severity::kWarning},
     {"error", livox::Severity::kError}}};

/// What a sensor reports of itself. XML element: <simulator><mid70><status_fault>.
struct StatusFaultConfig {
  ErrorTimes times = {};
  livox::Severity temperature = livox::Severity::kOk;
  livox::Severity voltage = livox::Severity::kOk;
  livox::Severity motor = livox::Severity::kOk;
  livox::Severity window = livox::Severity::kOk;
  bool firmware_abnormal = false;
  bool near_end_of_life = false;
  bool self_heating = false;

  template <typename Self, typename Visitor>
  static void Visit(Self& self, Visitor& visitor) {
    ErrorTimes::Visit(self.times, visitor);
    visitor.Choice("temperature", self.temperature, kSeverityNames, "Too hot or too cold.");
    visitor.Choice("voltage", self.voltage, kSeverityNames, "Its supply.");
    visitor.Choice("motor", self.motor, kSeverityNames, "That turns its prisms.");
    visitor.Choice("window", self.window, kSeverityNames, "Dirty or covered.");
    visitor.Flag("firmware_abnormal", self.firmware_abnormal, "An error of its firmware.");
    visitor.Flag("near_end_of_life", self.near_end_of_life, "It warns of its age.");
    visitor.Flag("self_heating", self.self_heating, "It warms itself; nothing is wrong.");
  }
  [[nodiscard]] std::vector<std::string> Validate() const { return times.Validate(); }

  /// `status` and this, the worse of both for each part.
  [[nodiscard]] livox::DeviceStatus AddTo(livox::DeviceStatus status) const {
    status.temperature = std::max(status.temperature, temperature);
    status.voltage = std::max(status.voltage, voltage);
    status.motor = std::max(status.motor, motor);
    status.window = std::max(status.window, window);
    status.firmware_abnormal = status.firmware_abnormal || firmware_abnormal;
    status.near_end_of_life = status.near_end_of_life || near_end_of_life;
    status.self_heating = status.self_heating || self_heating;
    status.system = std::max({status.system,
                              temperature,
                              voltage,
                              motor,
                              window,
                              firmware_abnormal ? livox::Severity::kError : livox::Severity::kOk,
                              near_end_of_life ? livox::Severity::kWarning : livox::Severity::kOk});
    return status;
  }
};

/// A sensor that does not hear its source of time. XML element:
/// <simulator><mid70><time_sync_loss>.
struct TimeSyncLossConfig {
  ErrorTimes times = {};

  template <typename Self, typename Visitor>
  static void Visit(Self& self, Visitor& visitor) {
    ErrorTimes::Visit(self.times, visitor);
  }
  [[nodiscard]] std::vector<std::string> Validate() const { return times.Validate(); }
};

}  // namespace clearway::core
