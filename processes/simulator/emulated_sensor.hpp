// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <vector>

#include "common/core/simulation/emulated_clock.hpp"
#include "common/core/simulation/emulated_mid70.hpp"
#include "common/core/simulation/emulated_sensor_config.hpp"
#include "common/core/simulation/simulated_lidar.hpp"
#include "common/net/datagrams.hpp"
#include "common/process/runtime.hpp"

namespace clearway {

/// What a sensor put on the network, and what was kept from it on purpose.
struct EmulatedSensorCounts {
  std::int64_t packets = 0;     ///< Made.
  std::int64_t lost = 0;        ///< Of them, by <network_fault>.
  std::int64_t silenced = 0;    ///< Of them, by <silence>.
  std::int64_t duplicates = 0;  ///< Second copies.
  std::int64_t reordered = 0;   ///< Delayed, so that others overtake them.
  std::int64_t skipped = 0;     ///< Not made, since the simulator was late by more than 50 ms.
};

/// A MID-70 on a network: its port for commands, its data packets at their pace, and the faults of
/// its configuration. A driver does not know the difference. The world's time starts with it.
class EmulatedSensor {
 public:
  /// What a sensor sees: `shots` of numbers from `first_shot` on, the first of them at `time_us` of
  /// the world's time.
  using Fire = std::function<void(std::int64_t first_shot,
                                  std::int64_t time_us,
                                  core::livox::ReturnMode mode,
                                  std::span<core::SimulatedShot> shots)>;

  /// Throws net::NetworkError where its address or a port cannot be had.
  EmulatedSensor(const core::EmulatedSensorConfig& config,
                 std::uint64_t seed,
                 process::Runtime& runtime,
                 net::Network& network,
                 Fire fire);
  ~EmulatedSensor();
  EmulatedSensor(const EmulatedSensor&) = delete;
  EmulatedSensor& operator=(const EmulatedSensor&) = delete;

  [[nodiscard]] const EmulatedSensorCounts& counts() const { return counts_; }
  [[nodiscard]] const core::EmulatedMid70& device() const { return device_; }
  [[nodiscard]] const core::EmulatedSensorConfig& config() const { return config_; }
  [[nodiscard]] bool is_on() const { return is_on_; }

 private:
  [[nodiscard]] std::int64_t Now() const { return runtime_.MonotonicUs() - start_us_; }
  void OpenSockets();
  void CloseSockets();
  void Tick();
  void FollowSchedule(std::int64_t now_us);
  void OnCommands(std::span<const net::Datagram> datagrams);
  void SendControl(const std::vector<core::EmulatedMid70::Outgoing>& outgoing, std::int64_t now_us);
  void SendPackets(std::int64_t now_us);
  void MakePacket(const core::EmulatedMid70::Sampling& sampling, std::int64_t begin_us);
  void SendData(const core::Endpoint& to, core::livox::Bytes packet, std::int64_t now_us);
  void Deliver(const core::Endpoint& to, core::livox::Bytes packet, std::int64_t delay_us);
  [[nodiscard]] bool IsSilent(core::Silenced what, std::int64_t now_us) const;
  [[nodiscard]] double NextRandom();

  core::EmulatedSensorConfig config_;
  std::uint64_t seed_;
  std::uint64_t num_random_ = 0;
  process::Runtime& runtime_;
  net::Network& network_;
  Fire fire_;
  std::int64_t start_us_;
  std::int64_t utime_minus_true_us_;
  core::EmulatedMid70 device_;
  core::EmulatedClock clock_;
  EmulatedSensorCounts counts_;
  bool is_on_ = true;
  std::size_t num_clock_steps_ = 0;  // Done so far, as are the next ones.
  std::size_t num_address_changes_ = 0;
  std::int64_t last_start_us_ = 0;  // Of the device, as the clock knows it.
  std::int64_t next_oscillator_ns_ =
      -1;                         // Of the next packet's first shot; -1: it does not sample.
  std::int64_t last_due_us_ = 0;  // Of a packet that jitter delayed.
  std::vector<core::SimulatedShot> shots_;
  std::vector<core::livox::WirePoint> points_;
  std::unique_ptr<net::Socket> command_socket_;
  std::unique_ptr<net::Socket> data_socket_;
  process::Runtime::TimerId timer_ = 0;
  std::shared_ptr<int> alive_ = std::make_shared<int>(0);  // For what is sent later.
};

}  // namespace clearway
