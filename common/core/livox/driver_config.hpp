// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdint>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "common/core/endpoint.hpp"
#include "common/core/livox/commands.hpp"

namespace clearway::core::livox {

inline constexpr std::array<std::pair<const char*, ReturnMode>, 3> kReturnModeNames{
    {{"first", ReturnMode::kFirst},
     {"strongest", ReturnMode::kStrongest},
     {"dual", ReturnMode::kDual}}};

/// Coordinates that a sensor is asked to send.
enum class Coordinates : std::uint8_t { kCartesian = 0, kSpherical = 1 };
inline constexpr std::array<std::pair<const char*, Coordinates>, 2> kCoordinatesNames{
    {{"cartesian", Coordinates::kCartesian}, {"spherical", Coordinates::kSpherical}}};

/// A sensor that the driver uses. XML element: <livox_driver><lidar>.
struct LidarConfig {
  std::string sensor = "front";
  std::string broadcast_code;
  std::string ip;
  ReturnMode return_mode = ReturnMode::kFirst;
  Coordinates coordinates = Coordinates::kCartesian;
  bool write_extrinsic = false;

  template <typename Self, typename Visitor>
  static void Visit(Self& self, Visitor& visitor) {
    visitor.Text(
        "sensor", self.sensor, "Name of its <vehicle><sensor>, which says where it is mounted.");
    visitor.Text("broadcast_code",
                 self.broadcast_code,
                 "The 15 characters on its label, with the digit 1 at the end. Empty: known by ip "
                 "alone; with neither, the one MID-70 that is heard is taken.");
    visitor.Text("ip",
                 self.ip,
                 "Its address, e.g. 192.168.1.101: asked directly, also where broadcasts do not "
                 "arrive. Empty: wherever its broadcasts come from.");
    visitor.Choice("return_mode",
                   self.return_mode,
                   kReturnModeNames,
                   "Which echoes of a shot are sent; \"dual\" doubles points and network load.");
    visitor.Choice("coordinates",
                   self.coordinates,
                   kCoordinatesNames,
                   "What travels from the sensor; spherical is a quarter smaller and rounds "
                   "directions to 0.01 deg.");
    visitor.Flag("write_extrinsic",
                 self.write_extrinsic,
                 "Store the place of <vehicle><sensor> in the sensor itself. Without, what it "
                 "holds is read and a difference is told.");
  }

  [[nodiscard]] std::vector<std::string> Validate() const {
    std::vector<std::string> broken;
    if (!ip.empty() && !ParseIpv4(ip)) {
      broken.push_back("ip \"" + ip + "\" is not an address like 192.168.1.101");
    }
    if (broadcast_code.size() > Broadcast::kMaxCodeLength) {
      broken.push_back("broadcast_code \"" + broadcast_code + "\" is longer than 15 characters");
    }
    return broken;
  }
};

/// Settings of the driver of Livox sensors. XML element: <livox_driver>.
struct DriverConfig {
  std::string host_ip;
  int broadcast_port = kBroadcastPort;
  int command_port = 55501;
  int data_port = 56001;
  int imu_port = 57001;
  int receive_buffer_bytes = 8 * 1024 * 1024;
  std::int64_t scan_period_us = 100'000;
  std::int64_t slice_us = 10'000;
  std::int64_t slice_grace_us = 15'000;
  std::int64_t heartbeat_us = 800'000;
  std::int64_t answer_timeout_us = 500'000;
  std::int64_t lost_after_us = 3'000'000;
  std::int64_t max_clock_error_us = 50'000;
  std::vector<LidarConfig> lidars = {LidarConfig{}};

  template <typename Self, typename Visitor>
  static void Visit(Self& self, Visitor& visitor) {
    VisitNetwork(self, visitor);
    VisitTimes(self, visitor);
    visitor.List("lidar", self.lidars, "Every Livox sensor that is used.");
  }

  [[nodiscard]] std::vector<std::string> Validate() const {
    std::vector<std::string> broken;
    if (!host_ip.empty() && !ParseIpv4(host_ip)) {
      broken.push_back("host_ip \"" + host_ip + "\" is not an address like 192.168.1.50");
    }
    const std::set<int> ports{broadcast_port, command_port, data_port, imu_port};
    if (ports.size() != 4) {
      broken.emplace_back("broadcast_port, command_port, data_port and imu_port must differ");
    }
    if (scan_period_us % slice_us != 0) {
      broken.emplace_back("scan_period_ms must be a multiple of slice_ms");
    }
    std::set<std::string> sensors;
    std::set<std::string> codes;
    for (const LidarConfig& lidar : lidars) {
      if (!sensors.insert(lidar.sensor).second) {
        broken.push_back("two lidar elements have sensor \"" + lidar.sensor + "\"");
      }
      if (!codes.insert(lidar.broadcast_code + '@' + lidar.ip).second) {
        broken.push_back("two lidar elements have broadcast_code \"" + lidar.broadcast_code +
                         "\" and ip \"" + lidar.ip + "\"");
      }
    }
    return broken;
  }

 private:
  template <typename Self, typename Visitor>
  static void VisitNetwork(Self& self, Visitor& visitor) {
    visitor.Text("host_ip",
                 self.host_ip,
                 "This host's address on the sensors' network. Empty: that of the interface in "
                 "whose subnet a sensor is.");
    visitor.Integer("broadcast_port",
                    self.broadcast_port,
                    1,
                    65535,
                    "Where sensors announce themselves; real ones use 55000.");
    visitor.Integer("command_port",
                    self.command_port,
                    1,
                    65535,
                    "Of this host, for answers of all sensors; open it in a firewall (UDP).");
    visitor.Integer("data_port", self.data_port, 1, 65535, "Of this host, for points; likewise.");
    visitor.Integer("imu_port",
                    self.imu_port,
                    1,
                    65535,
                    "Told to sensors; a MID-70 has no IMU, nothing listens there.");
    visitor.Integer("receive_buffer_bytes",
                    self.receive_buffer_bytes,
                    4096,
                    1 << 30,
                    "Socket buffer for points that is asked for; the kernel's net.core.rmem_max "
                    "bounds it. A MID-70 fills 1.5 MB/s.");
  }

  template <typename Self, typename Visitor>
  static void VisitTimes(Self& self, Visitor& visitor) {
    visitor.Milliseconds("scan_period_ms",
                         self.scan_period_us,
                         10.0,
                         10000.0,
                         "Scans are cut on the multiples of this time [ms]. Longer scans are "
                         "denser and later.");
    visitor.Milliseconds("slice_ms",
                         self.slice_us,
                         1.0,
                         1000.0,
                         "Scans travel in slices of this time [ms]; the stop guard's quickest "
                         "answer. Shorter costs more messages.");
    visitor.Milliseconds("slice_grace_ms",
                         self.slice_grace_us,
                         1.0,
                         1000.0,
                         "How long a slice that is not full is waited for after its end [ms].");
    visitor.Milliseconds("heartbeat_ms",
                         self.heartbeat_us,
                         50.0,
                         2000.0,
                         "A connected sensor is greeted this often [ms].");
    visitor.Milliseconds("answer_timeout_ms",
                         self.answer_timeout_us,
                         10.0,
                         10000.0,
                         "A command without an answer is repeated after this time [ms].");
    visitor.Milliseconds("lost_after_ms",
                         self.lost_after_us,
                         500.0,
                         60000.0,
                         "A sensor that answers no heartbeat for so long is connected anew [ms].");
    visitor.Milliseconds("max_clock_error_ms",
                         self.max_clock_error_us,
                         1.0,
                         60000.0,
                         "PTP and GPS stamps further from this host's clock than this are not "
                         "believed; arrival is used instead [ms].");
  }
};

}  // namespace clearway::core::livox
