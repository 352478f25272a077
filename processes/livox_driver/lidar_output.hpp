// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdint>
#include <string>

#include "common/core/livox/driver_config.hpp"
#include "common/core/livox/sensor_stream.hpp"
#include "common/process/node.hpp"

namespace clearway {

/// The way of one sensor's points: data packets in, slices on LIDAR_POINTS out.
class LidarOutput {
 public:
  LidarOutput(const core::livox::DriverConfig& driver,
              const core::livox::LidarConfig& lidar,
              process::Node& node);

  /// Takes a datagram that should be a data packet; false when it is none, counted by defect.
  /// Returns its header's status code.
  std::optional<std::uint32_t> OnPacket(core::livox::ByteView datagram, std::int64_t arrival_utime);

  /// Publishes the slices that are whole or due.
  void PublishDue(std::int64_t now_utime);

  /// The sensor was connected anew.
  void Restart() { stream_.Restart(); }

  /// Puts its counts into the node's status.
  void SetCounters() const;

  [[nodiscard]] const std::string& sensor() const { return lidar_.sensor; }
  [[nodiscard]] const core::livox::SensorStream& stream() const { return stream_; }
  /// How the time of the points comes about, in words: "PTP", "its own clock, +12 ppm", ...
  [[nodiscard]] std::string TimeText() const;

 private:
  core::livox::LidarConfig lidar_;
  process::Node& node_;
  core::livox::SensorStream stream_;
  std::array<std::int64_t, core::livox::kNumPacketDefects> defects_{};
};

}  // namespace clearway
