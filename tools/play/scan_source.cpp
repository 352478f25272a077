// SPDX-License-Identifier: BSD-3-Clause
#include "tools/play/scan_source.hpp"

#include "common/core/simulation/lidar_scan.hpp"
#include "common/io/cloud_source.hpp"

namespace clearway::play {
namespace {

class RecordedScans final : public ScanSource {
 public:
  RecordedScans(const std::filesystem::path& input, const io::RecordingConfig& config)
      : source_(input, config) {}

  [[nodiscard]] std::size_t size() const override { return source_.size(); }
  [[nodiscard]] std::int64_t period_us() const override { return source_.period_us(); }
  [[nodiscard]] std::int64_t utime(std::size_t i) const override { return source_.utime(i); }
  [[nodiscard]] PlayedScan Read(std::size_t i) override {
    io::ScanFile file = source_.Read(i);
    return {std::move(file.cloud), file.utime, std::move(file.name)};
  }

 private:
  io::CloudSource source_;
};

class SceneScans final : public ScanSource {
 public:
  SceneScans(const std::filesystem::path& file, const graph::GraphConfig& config, double scene_s)
      : scene_(config::Load<core::SceneFile>(file).root.scene),
        T_vehicle_sensor_(config.vehicle.sensors.front().T_vehicle_sensor()),
        period_us_(static_cast<std::int64_t>(1e6 / config.recording.rate_hz)),
        size_(static_cast<std::size_t>(1e6 * scene_s / static_cast<double>(period_us_))) {}

  [[nodiscard]] std::size_t size() const override { return size_; }
  [[nodiscard]] std::int64_t period_us() const override { return period_us_; }
  [[nodiscard]] std::int64_t utime(std::size_t i) const override {
    return io::kFirstScanUtime + static_cast<std::int64_t>(i) * period_us_;
  }
  [[nodiscard]] PlayedScan Read(std::size_t i) override {
    core::ScanRequest request;
    request.T_map_vehicle = scene_.start.T_map_vehicle();
    request.T_vehicle_sensor = T_vehicle_sensor_;
    request.begin_us = static_cast<std::int64_t>(i) * period_us_;
    request.duration_us = period_us_;
    return {core::GenerateScan(scene_, {}, request).cloud_sensor,
            utime(i),
            "scene#" + std::to_string(i)};
  }

 private:
  core::SceneConfig scene_;
  Eigen::Isometry3d T_vehicle_sensor_;
  std::int64_t period_us_;
  std::size_t size_;
};

}  // namespace

std::unique_ptr<ScanSource> OpenSource(const std::filesystem::path& input,
                                       const graph::GraphConfig& config,
                                       double scene_s) {
  if (input.extension() == ".xml") return std::make_unique<SceneScans>(input, config, scene_s);
  return std::make_unique<RecordedScans>(input, config.recording);
}

}  // namespace clearway::play
