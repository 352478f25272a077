// SPDX-License-Identifier: BSD-3-Clause
#include "processes/livox_driver/lvx_recorder.hpp"

#include <numbers>
#include <stdexcept>

#include "common/process/log.hpp"

namespace clearway {
namespace {

io::LvxHeader HeaderOf(const core::livox::DriverConfig& config,
                       const core::VehicleConfig& vehicle) {
  constexpr double kDegrees = 180.0 / std::numbers::pi;
  io::LvxHeader header;
  for (std::size_t i = 0; i < config.lidars.size(); ++i) {
    const core::livox::LidarConfig& lidar = config.lidars[i];
    const auto place = static_cast<std::size_t>(*vehicle.FindSensor(lidar.sensor));
    const core::SensorConfig& sensor = vehicle.sensors[place];
    // A sensor that is known by its address alone goes by its name.
    const std::string& code = lidar.broadcast_code.empty() ? lidar.sensor : lidar.broadcast_code;
    header.devices.push_back({.lidar_code = code.substr(0, 15),
                              .hub_code = {},
                              .index = static_cast<std::uint8_t>(i),
                              .type = core::livox::DeviceType::kMid70,
                              .extrinsic_enabled = true,
                              .roll_deg = static_cast<float>(sensor.roll_rad * kDegrees),
                              .pitch_deg = static_cast<float>(sensor.pitch_rad * kDegrees),
                              .yaw_deg = static_cast<float>(sensor.yaw_rad * kDegrees),
                              .x_m = static_cast<float>(sensor.x_m),
                              .y_m = static_cast<float>(sensor.y_m),
                              .z_m = static_cast<float>(sensor.z_m)});
  }
  return header;
}

}  // namespace

LvxRecorder::LvxRecorder(const std::filesystem::path& file,
                         const core::livox::DriverConfig& config,
                         const core::VehicleConfig& vehicle)
    : writer_(std::in_place, file, HeaderOf(config, vehicle)) {}

void LvxRecorder::Add(std::size_t lidar, const net::Datagram& datagram) {
  if (!writer_) return;
  try {
    if (writer_->Add(static_cast<std::uint8_t>(lidar), datagram.bytes, datagram.arrival_utime)) {
      ++packages_;
    }
  } catch (const std::runtime_error& error) {
    Fail(error.what());
  }
}

bool LvxRecorder::Close() {
  if (!writer_) return problem_.empty();
  try {
    writer_->Close();
  } catch (const std::runtime_error& error) {
    Fail(error.what());
  }
  writer_.reset();
  return problem_.empty();
}

void LvxRecorder::Fail(const std::string& why) {
  problem_ = why;
  process::LogError("the recording has ended: " + why);
  writer_.reset();
}

}  // namespace clearway
