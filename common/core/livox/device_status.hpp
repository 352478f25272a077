// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace clearway::core::livox {

/// How bad a part of the sensor says it is.
enum class Severity : std::uint8_t { kOk = 0, kWarning = 1, kError = 2, kUnknown = 3 };

/// What the sensor derives its stamps from.
enum class TimeSync : std::uint8_t { kNone = 0, kPtp = 1, kGps = 2, kPps = 3, kAbnormal = 4 };

/// The status code of heartbeats and data packets, taken apart.
struct DeviceStatus {
  Severity temperature = Severity::kOk;  ///< Warning: high or low; error: extreme.
  Severity voltage = Severity::kOk;
  Severity motor = Severity::kOk;
  Severity window = Severity::kOk;  ///< Dirty or blocked.
  bool firmware_abnormal = false;
  bool pps_present = false;
  bool near_end_of_life = false;
  bool fan_warning = false;
  bool self_heating = false;
  bool ptp_present = false;
  TimeSync time_sync = TimeSync::kNone;
  Severity system = Severity::kOk;  ///< The sensor's own verdict on itself.
  friend bool operator==(const DeviceStatus&, const DeviceStatus&) = default;
};

/// Bits 0-1 temperature, 2-3 voltage, 4-5 motor, 6-7 window, 8 firmware, 9 PPS, 10 end of life,
/// 11 fan, 12 self-heating, 13 PTP, 14-16 time source, 30-31 system; others are reserved.
[[nodiscard]] DeviceStatus DecodeStatus(std::uint32_t code);
[[nodiscard]] std::uint32_t EncodeStatus(const DeviceStatus& status);

/// The worst that it reports.
[[nodiscard]] Severity WorstOf(const DeviceStatus& status);

/// One sentence for each thing that is not well, with what to do about it; empty when all is well.
[[nodiscard]] std::vector<std::string> Complaints(const DeviceStatus& status);

}  // namespace clearway::core::livox
