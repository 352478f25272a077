// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "common/core/simulation/emulated_clock.hpp"
#include "common/core/simulation/emulated_mid70.hpp"
#include "common/core/simulation/emulated_sensor_config.hpp"
#include "common/core/simulation/packet_faults.hpp"
#include "common/core/simulation/simulated_lidar.hpp"
#include "common/net/datagrams.hpp"
#include "common/process/runtime.hpp"

namespace clearway {

/// What a sensor put on the network, and what was kept from it on purpose.
struct EmulatedSensorCounts {
  std::int64_t packets = 0;       ///< Made.
  std::int64_t lost = 0;          ///< Of them, by <network_fault>, or under way in a power cut.
  std::int64_t silenced = 0;      ///< Of them, by <silence>.
  std::int64_t refused = 0;       ///< Of them, and of second copies, by the network itself.
  std::int64_t duplicates = 0;    ///< Second copies that left.
  std::int64_t reordered = 0;     ///< First copies that left after a younger packet had.
  std::int64_t under_way = 0;     ///< Neither lost nor gone yet, with second copies.
  std::int64_t control_lost = 0;  ///< Commands, answers and broadcasts, by <network_fault>.
  std::int64_t skipped = 0;       ///< Not made, since the simulator was late by more than 50 ms.
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

  [[nodiscard]] EmulatedSensorCounts counts() const;
  [[nodiscard]] const core::EmulatedMid70& device() const { return device_; }
  [[nodiscard]] const core::EmulatedSensorConfig& config() const { return config_; }
  [[nodiscard]] bool is_on() const { return is_on_; }
  /// Why it is not on the network, in words; empty when all is well. It tries again each second.
  [[nodiscard]] const std::string& problem() const { return problem_; }

 private:
  [[nodiscard]] std::int64_t Now() const { return runtime_.MonotonicUs() - start_us_; }
  [[nodiscard]] bool HasPower(std::int64_t now_us) const;
  void OpenSockets();
  void TryOpenSockets(std::int64_t now_us);
  void CloseSockets();
  void Tick();
  void FollowPower(std::int64_t now_us);
  void FollowSchedule(std::int64_t now_us);
  void FollowRestart();
  void MeasureUtime();
  [[nodiscard]] core::EmulatedTimeSync SyncAt(std::int64_t now_us) const;
  [[nodiscard]] core::livox::DeviceStatus StatusAt(std::int64_t now_us) const;
  [[nodiscard]] bool IsSilent(core::Silenced what, std::int64_t now_us) const;
  void OnCommands(std::span<const net::Datagram> datagrams);
  void SendControl(const std::vector<core::EmulatedMid70::Outgoing>& outgoing, std::int64_t now_us);
  void SendPackets(std::int64_t now_us);
  void MakePacket(const core::EmulatedMid70::Sampling& sampling,
                  std::int64_t begin_us,
                  std::int64_t now_us);
  void Flush();

  core::EmulatedSensorConfig config_;
  process::Runtime& runtime_;
  net::Network& network_;
  Fire fire_;
  std::int64_t start_us_;
  std::int64_t utime_minus_true_us_;
  core::EmulatedMid70 device_;
  core::EmulatedClock clock_;
  core::PacketFaults faults_;
  EmulatedSensorCounts counts_;  // Those that are counted here.
  bool is_on_ = true;
  std::string problem_;
  core::Ipv4 bound_ip_ = core::kAnyIpv4;
  std::int64_t next_try_us_ = 0;
  std::size_t num_clock_steps_ = 0;  // Done so far, as are the next ones.
  std::size_t num_address_changes_ = 0;
  std::int64_t last_start_us_ = 0;        // Of the device, as the clock knows it.
  std::int64_t next_oscillator_ns_ = -1;  // Of the next packet's first shot; -1: none.
  std::vector<core::SimulatedShot> shots_;
  std::vector<core::livox::WirePoint> points_;
  std::unique_ptr<net::Socket> command_socket_;
  std::unique_ptr<net::Socket> data_socket_;
  process::Runtime::TimerId timer_ = 0;
  std::optional<std::int64_t> flush_due_us_;
  process::Runtime::TimerId flush_timer_ = 0;
};

}  // namespace clearway
