// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "common/core/vehicle.hpp"
#include "common/io/lvx/lvx_reader.hpp"
#include "processes/livox_driver/lidar_output.hpp"

namespace clearway {

struct LvxReplaySettings {
  std::filesystem::path file;
  double speed = 1.0;  ///< Times real time; 0: as fast as it goes.
  bool loop = false;
};

/// The packets of an LVX file -> LIDAR_POINTS, on the way that packets of the network take, at the
/// pace of their stamps. Time goes on from the moment of the start as the stamps do: each packet
/// counts as arrived when it was full. A device of the file is the lidar of the configuration with
/// its broadcast code; devices without one take the lidars that are left, in order; more devices
/// than lidars are told and left out.
class LvxReplay {
 public:
  /// `on_done` is called after the last packet. Throws io::ReadError, and std::runtime_error as
  /// CheckSensors() does.
  LvxReplay(const core::livox::DriverConfig& config,
            const core::VehicleConfig& vehicle,
            const LvxReplaySettings& settings,
            process::Node& node,
            std::function<void()> on_done);

  /// What the file held, after the end.
  [[nodiscard]] const io::LvxReport& report() const { return reader_->report(); }
  [[nodiscard]] std::int64_t packages() const { return packages_; }

 private:
  struct Track {
    LidarOutput* output = nullptr;  // Null: not used.
    std::optional<std::int64_t> last_stamp_ns;
    std::int64_t utime = 0;  // Of the last packet's first shot, as it is played.
  };

  void AssignDevices();
  void Step();
  void Play(const io::LvxPackage& package);
  [[nodiscard]] std::int64_t DueUtime(const core::livox::DataPacket& packet, Track& track) const;
  void Finish();
  void Refresh();

  core::livox::DriverConfig config_;
  LvxReplaySettings settings_;
  process::Node& node_;
  std::function<void()> on_done_;
  std::unique_ptr<io::LvxReader> reader_;
  std::vector<std::unique_ptr<LidarOutput>> outputs_;
  std::map<std::uint8_t, Track> tracks_;  // By device index.
  std::string unused_;
  std::optional<io::LvxPackage> waiting_;
  std::int64_t waiting_utime_ = 0;  // When it is full.
  std::int64_t start_utime_ = 0;
  std::int64_t start_us_ = 0;
  std::int64_t played_utime_ = 0;  // How far the recording's time has come.
  std::int64_t packages_ = 0;
  bool is_done_ = false;
};

}  // namespace clearway
