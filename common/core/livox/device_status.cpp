// SPDX-License-Identifier: BSD-3-Clause
#include "common/core/livox/device_status.hpp"

#include <algorithm>

namespace clearway::core::livox {
namespace {

void Complain(Severity severity,
              const char* warning,
              const char* error,
              std::vector<std::string>& complaints) {
  if (severity == Severity::kWarning) complaints.emplace_back(warning);
  if (severity == Severity::kError || severity == Severity::kUnknown) {
    complaints.emplace_back(error);
  }
}

}  // namespace

DeviceStatus DecodeStatus(std::uint32_t code) {
  const auto severity = [code](unsigned bit) { return static_cast<Severity>((code >> bit) & 3U); };
  const auto flag = [code](unsigned bit) { return ((code >> bit) & 1U) != 0; };
  const std::uint32_t sync = (code >> 14U) & 7U;
  return {.temperature = severity(0),
          .voltage = severity(2),
          .motor = severity(4),
          .window = severity(6),
          .firmware_abnormal = flag(8),
          .pps_present = flag(9),
          .near_end_of_life = flag(10),
          .fan_warning = flag(11),
          .self_heating = flag(12),
          .ptp_present = flag(13),
          .time_sync = static_cast<TimeSync>(std::min(sync, 4U)),
          .system = severity(30)};
}

std::uint32_t EncodeStatus(const DeviceStatus& status) {
  const auto bits = [](auto value, unsigned bit) {
    return static_cast<std::uint32_t>(value) << bit;
  };
  return bits(status.temperature, 0) | bits(status.voltage, 2) | bits(status.motor, 4) |
         bits(status.window, 6) | bits(status.firmware_abnormal, 8) | bits(status.pps_present, 9) |
         bits(status.near_end_of_life, 10) | bits(status.fan_warning, 11) |
         bits(status.self_heating, 12) | bits(status.ptp_present, 13) | bits(status.time_sync, 14) |
         bits(status.system, 30);
}

Severity WorstOf(const DeviceStatus& status) {
  Severity worst =
      std::max({status.temperature, status.voltage, status.motor, status.window, status.system});
  if (status.firmware_abnormal) worst = std::max(worst, Severity::kError);
  if (status.near_end_of_life || status.fan_warning) worst = std::max(worst, Severity::kWarning);
  return worst;
}

std::vector<std::string> Complaints(const DeviceStatus& status) {
  std::vector<std::string> complaints;
  Complain(status.temperature,
           "its temperature is high or low: shade or warm it",
           "its temperature is extreme: switch it off until it has cooled or warmed",
           complaints);
  Complain(status.voltage,
           "its supply voltage is off: it needs 10 to 15 V",
           "its supply voltage is far off: it needs 10 to 15 V",
           complaints);
  Complain(
      status.motor, "its motor warns", "its motor has failed: switch it off and on", complaints);
  Complain(status.window,
           "its window is dirty or blocked: clean it",
           "its window is covered: uncover or clean it",
           complaints);
  if (status.firmware_abnormal) complaints.emplace_back("its firmware is abnormal: load it anew");
  if (status.near_end_of_life) complaints.emplace_back("it is near the end of its life");
  if (status.fan_warning) complaints.emplace_back("its fan warns");
  if (status.time_sync == TimeSync::kAbnormal) {
    complaints.emplace_back("its time synchronisation is abnormal");
  }
  if (complaints.empty()) {
    Complain(
        status.system, "it warns, without a reason", "it has failed, without a reason", complaints);
  }
  return complaints;
}

}  // namespace clearway::core::livox
