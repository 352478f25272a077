// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "common/core/endpoint.hpp"
#include "common/core/livox/commands.hpp"
#include "common/core/livox/data_packet.hpp"
#include "common/core/simulation/emulated_sensor_faults.hpp"

namespace clearway::core {

inline constexpr std::array<std::pair<const char*, livox::TimestampType>, 4> kTimeSyncNames{
    {{"none", livox::TimestampType::kNoSync},
     {"ptp", livox::TimestampType::kPtp},
     {"gps", livox::TimestampType::kGps},
     {"pps", livox::TimestampType::kPps}}};

/// A MID-70 that the simulator is, on the network. XML element: <simulator><mid70>.
struct EmulatedSensorConfig {
  std::string sensor = "front";
  std::string broadcast_code = "3GGDJ6K00100101";
  std::string ip = "127.0.0.2";
  std::string broadcast_to = "127.0.0.1";
  int broadcast_port = livox::kBroadcastPort;
  std::int64_t boot_us = 200'000;
  std::int64_t start_up_us = 1'000'000;
  std::int64_t host_timeout_us = 5'000'000;
  bool lets_others_take_over = true;
  double uptime_s = 100.0;
  double clock_drift_ppm = 0.0;
  livox::TimestampType time_sync = livox::TimestampType::kNoSync;
  std::int64_t time_sync_error_us = 0;
  std::vector<NetworkFaultConfig> network_faults;
  std::vector<SilenceConfig> silences;
  std::vector<PowerCutConfig> power_cuts;
  std::vector<ClockStepConfig> clock_steps;
  std::vector<AddressChangeConfig> address_changes;
  std::vector<StatusFaultConfig> status_faults;
  std::vector<TimeSyncLossConfig> time_sync_losses;

  template <typename Self, typename Visitor>
  static void Visit(Self& self, Visitor& visitor) {
    VisitIdentity(self, visitor);
    VisitTime(self, visitor);
    visitor.List("network_fault", self.network_faults, "A bad network between it and its host.");
    visitor.List("silence", self.silences, "It is not heard.");
    visitor.List("power_cut", self.power_cuts, "It is switched off, and on again.");
    visitor.List("clock_step", self.clock_steps, "Its clock jumps.");
    visitor.List("address_change", self.address_changes, "It gets another address.");
    visitor.List("status_fault", self.status_faults, "It finds something wrong with itself.");
    visitor.List("time_sync_loss",
                 self.time_sync_losses,
                 "It does not hear its source of time: its own clock again.");
  }

  [[nodiscard]] std::vector<std::string> Validate() const {
    std::vector<std::string> broken;
    for (const std::string* address : {&ip, &broadcast_to}) {
      if (!ParseIpv4(*address)) {
        broken.push_back("\"" + *address + "\" is not an address like 192.168.1.101");
      }
    }
    if (broadcast_code.empty() || broadcast_code.size() > livox::Broadcast::kMaxCodeLength) {
      broken.emplace_back("broadcast_code needs 1 to 15 characters");
    }
    return broken;
  }

 private:
  template <typename Self, typename Visitor>
  static void VisitIdentity(Self& self, Visitor& visitor) {
    visitor.Text("sensor", self.sensor, "Name of its <vehicle><sensor>: where it is mounted.");
    visitor.Text("broadcast_code", self.broadcast_code, "15 characters by which it is known.");
    visitor.Text("ip",
                 self.ip,
                 "Its own address; 127.0.0.2, .3, ... on this host, or that of an interface.");
    visitor.Text("broadcast_to",
                 self.broadcast_to,
                 "Where it announces itself: 255.255.255.255 as real ones do, or one host.");
    visitor.Integer(
        "broadcast_port", self.broadcast_port, 1, 65535, "To which port; real ones use 55000.");
    visitor.Milliseconds(
        "boot_ms", self.boot_us, 0.0, 60000.0, "From power on to its first broadcast [ms].");
    visitor.Milliseconds(
        "start_up_ms", self.start_up_us, 0.0, 600000.0, "From power on until it measures [ms].");
    visitor.Milliseconds("host_timeout_ms",
                         self.host_timeout_us,
                         500.0,
                         60000.0,
                         "Without a heartbeat for so long it stops and announces itself again "
                         "[ms]. What a real one takes is not known.");
    visitor.Flag("lets_others_take_over",
                 self.lets_others_take_over,
                 "A second host's handshake is accepted. What a real one does is not known.");
  }

  template <typename Self, typename Visitor>
  static void VisitTime(Self& self, Visitor& visitor) {
    visitor.Number("uptime_s",
                   self.uptime_s,
                   0.0,
                   1e7,
                   "How long it says to have been on when the simulator starts [s].");
    visitor.Number("clock_drift_ppm",
                   self.clock_drift_ppm,
                   -1000.0,
                   1000.0,
                   "How much faster than true time its clock runs [ppm].");
    visitor.Choice("time_sync",
                   self.time_sync,
                   kTimeSyncNames,
                   "What its stamps come from; \"none\": its own clock since power on.");
    visitor.Milliseconds("time_sync_error_ms",
                         self.time_sync_error_us,
                         -86400000.0,
                         86400000.0,
                         "How far PTP and GPS stamps are off [ms].");
  }
};

}  // namespace clearway::core
