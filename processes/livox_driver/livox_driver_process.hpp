// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "common/core/livox/sensor_link.hpp"
#include "common/core/vehicle.hpp"
#include "common/net/datagrams.hpp"
#include "processes/livox_driver/heard_sensors.hpp"
#include "processes/livox_driver/lidar_output.hpp"

namespace clearway {

/// Throws std::runtime_error unless each lidar's `sensor` is one of the vehicle.
void CheckSensors(const core::livox::DriverConfig& config, const core::VehicleConfig& vehicle);

/// Livox sensors on the network -> LIDAR_POINTS. See README.md beside this file.
class LivoxDriverProcess {
 public:
  /// Hears each data packet of a configured sensor as it came: its place in DriverConfig::lidars.
  using PacketTap = std::function<void(std::size_t lidar, const net::Datagram& datagram)>;

  /// Opens its three ports. Throws net::NetworkError where one cannot be had, std::runtime_error
  /// as CheckSensors() does.
  LivoxDriverProcess(const core::livox::DriverConfig& config,
                     const core::VehicleConfig& vehicle,
                     process::Node& node,
                     net::Network& network);
  /// Says goodbye to the sensors.
  ~LivoxDriverProcess();
  LivoxDriverProcess(const LivoxDriverProcess&) = delete;
  LivoxDriverProcess& operator=(const LivoxDriverProcess&) = delete;

  void SetPacketTap(PacketTap tap) { tap_ = std::move(tap); }

  [[nodiscard]] const core::livox::SensorLink& link(std::size_t lidar) const {
    return lidars_[lidar]->link;
  }
  [[nodiscard]] const LidarOutput& output(std::size_t lidar) const {
    return lidars_[lidar]->output;
  }

 private:
  struct Lidar {
    Lidar(const core::livox::LidarConfig& lidar_config,
          const core::livox::LinkConfig& link_config,
          const core::livox::DriverConfig& driver,
          process::Node& node)
        : config(lidar_config), link(link_config), output(driver, lidar_config, node) {}
    core::livox::LidarConfig config;
    core::livox::SensorLink link;
    LidarOutput output;
    std::string address_problem;  // Why it cannot answer to this host; empty: it can.
  };
  void OnBroadcasts(std::span<const net::Datagram> datagrams);
  void OnBroadcast(const core::Endpoint& from, const core::livox::Broadcast& body);
  void OnCommands(std::span<const net::Datagram> datagrams);
  void OnData(std::span<const net::Datagram> datagrams);
  void Approach(Lidar& lidar, const core::Endpoint& sensor);
  [[nodiscard]] std::vector<net::Interface> OwnInterfaces() const;
  void RenewAddresses();
  void Tick();
  void Flush(Lidar& lidar);
  void Refresh();
  [[nodiscard]] core::livox::LinkReport ReportOf(std::size_t index) const;
  [[nodiscard]] core::livox::LinkReport SearchReport(std::size_t index) const;
  void SetCounters();
  [[nodiscard]] std::int64_t NowUs() const { return node_.runtime().MonotonicUs(); }

  core::livox::DriverConfig config_;
  process::Node& node_;
  net::Network& network_;
  std::vector<std::unique_ptr<Lidar>> lidars_;
  HeardSensors heard_;
  std::int64_t addresses_renewed_us_ = 0;
  std::array<std::int64_t, core::livox::kNumFrameDefects> frame_defects_{};
  std::int64_t foreign_frames_ = 0;
  std::int64_t foreign_packets_ = 0;
  std::int64_t started_us_ = 0;
  PacketTap tap_;
  process::Runtime::TimerId timer_ = 0;
  std::unique_ptr<net::Socket> broadcast_socket_;
  std::unique_ptr<net::Socket> command_socket_;
  std::unique_ptr<net::Socket> data_socket_;
};

}  // namespace clearway
