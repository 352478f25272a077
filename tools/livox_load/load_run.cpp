// SPDX-License-Identifier: BSD-3-Clause
#include "tools/livox_load/load_run.hpp"

#include <stdexcept>

#include "common/host/process_table.hpp"
#include "common/messages/channels.hpp"
#include "common/process/plain_channels.hpp"

namespace clearway::livox_load {
namespace {

constexpr std::int64_t kSecond = 1'000'000;
constexpr core::Ipv4 kFirstIp = 0x7F000002;  // 127.0.0.2

// A wall of 10 m by 10 m, 5 m ahead, and something a metre behind it.
void FireAtAWall(std::int64_t first_shot,
                 std::int64_t /*time_us*/,
                 core::livox::ReturnMode /*mode*/,
                 std::span<core::SimulatedShot> shots) {
  for (std::size_t i = 0; i < shots.size(); ++i) {
    const std::int64_t shot = first_shot + static_cast<std::int64_t>(i);
    const auto y_mm = static_cast<std::int32_t>(shot % 10'000) - 5'000;
    const auto z_mm = static_cast<std::int32_t>(shot / 100 % 10'000) - 5'000;
    shots[i].echoes[0].point_sensor = {5'000, y_mm, z_mm, 60, 0x10};
    shots[i].echoes[1].point_sensor = {6'000, y_mm, z_mm, 30, 0x20};
  }
}

}  // namespace

LoadRun::LoadRun(const graph::GraphConfig& config, process::LiveRuntime& runtime)
    : runtime_(runtime), network_(runtime) {
  process::Subscribe<status_t>(
      runtime_,
      messages::channels::kLivoxDriverStatus,
      [this](const status_t& status) { status_ = status; },
      [] {});
  for (const core::livox::LidarConfig& lidar : config.livox_driver.lidars) {
    core::EmulatedSensorConfig sensor;
    sensor.sensor = lidar.sensor;
    sensor.broadcast_code = lidar.broadcast_code;
    sensor.ip = core::ToString(kFirstIp + static_cast<core::Ipv4>(sensors_.size()));
    sensor.broadcast_to = "127.0.0.1";
    sensors_.push_back(std::make_unique<EmulatedSensor>(
        sensor, sensors_.size(), runtime_, network_, &FireAtAWall));
  }
}

void LoadRun::WaitFor(const char* what,
                      std::int64_t timeout_us,
                      const std::function<bool()>& holds) {
  const std::int64_t deadline_us = runtime_.MonotonicUs() + timeout_us;
  while (!holds()) {
    if (runtime_.MonotonicUs() > deadline_us) {
      throw std::runtime_error(std::string(what) + (status_ ? ": " + status_->text : ""));
    }
    runtime_.RunFor(kSecond / 10);
  }
}

double LoadRun::DriverCpuSeconds() const {
  const auto process = host::ReadProcess(status_->pid);
  if (!process) throw std::runtime_error("the driver has ended");
  return host::SecondsOf(process->cpu_ticks);
}

LoadResult LoadRun::Measure(double seconds) {
  WaitFor("no driver is heard", 20 * kSecond, [this] { return status_.has_value(); });
  WaitFor("the driver has no points of all sensors", 30 * kSecond, [this] {
    return status_->state == status_t::STATE_OK;
  });
  LoadResult result;
  const double cpu_before_s = DriverCpuSeconds();
  const std::int64_t before_us = runtime_.MonotonicUs();
  runtime_.RunFor(static_cast<std::int64_t>(seconds * 1e6));
  result.seconds = static_cast<double>(runtime_.MonotonicUs() - before_us) * 1e-6;
  result.driver_cpu = (DriverCpuSeconds() - cpu_before_s) / result.seconds;
  result.driver_text = status_->text;
  for (const auto& sensor : sensors_) {
    const EmulatedSensorCounts counts = sensor->counts();
    result.sent += counts.packets - counts.lost - counts.silenced - counts.refused;
    result.refused += counts.refused;
    result.skipped += counts.skipped;
  }
  sensors_.clear();
  // Two statuses later all that was sent has been counted.
  const std::int64_t sequence = status_->sequence;
  WaitFor("the driver is silent", 20 * kSecond, [&] { return status_->sequence > sequence + 2; });
  for (const counter_t& counter : status_->counters) {
    const std::size_t begin = counter.name.find('_') + 1;
    const bool is_of_sensor = counter.name.rfind("sensor", 0) == 0;
    result.driver[is_of_sensor ? counter.name.substr(begin) : counter.name] += counter.value;
  }
  return result;
}

}  // namespace clearway::livox_load
