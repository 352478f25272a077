// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "common/core/livox/sensor_link.hpp"
#include "common/core/vehicle.hpp"
#include "common/net/datagrams.hpp"
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
    std::string subnet_problem;  // Why it cannot be answered from here; empty: it can.
  };
  /// Somebody who announced himself.
  struct Heard {
    core::livox::DeviceType type = core::livox::DeviceType::kMid70;
    core::Ipv4 ip = core::kAnyIpv4;
    std::int64_t last_us = 0;
  };

  void OnBroadcasts(std::span<const net::Datagram> datagrams);
  void OnBroadcast(const core::Endpoint& from, const core::livox::Broadcast& body);
  void OnCommands(std::span<const net::Datagram> datagrams);
  void OnData(std::span<const net::Datagram> datagrams);
  [[nodiscard]] std::size_t LidarFor(const core::livox::Broadcast& body, core::Ipv4 ip) const;
  [[nodiscard]] bool IsOnlyUnclaimed(const std::string& code) const;
  [[nodiscard]] bool IsClaimed(const std::string& code, const Heard& heard) const;
  [[nodiscard]] std::optional<core::Ipv4> HostFor(core::Ipv4 sensor, std::string& problem) const;
  void OfferKnownAddress(Lidar& lidar);
  void Tick();
  void Flush(Lidar& lidar);
  void Refresh();
  [[nodiscard]] std::string SearchText(const Lidar& lidar) const;
  [[nodiscard]] std::string UnknownText() const;
  [[nodiscard]] std::int64_t NowUs() const { return node_.runtime().MonotonicUs(); }

  core::livox::DriverConfig config_;
  process::Node& node_;
  net::Network& network_;
  std::vector<std::unique_ptr<Lidar>> lidars_;
  std::map<std::string, Heard> heard_;  // By broadcast code.
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
