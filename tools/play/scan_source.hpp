// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>

#include "common/core/cloud.hpp"
#include "common/graph/graph_config.hpp"

namespace clearway::play {

/// A scan as it is played.
struct PlayedScan {
  core::PointCloud cloud_sensor;  ///< (0, 0, 0) where nothing returned.
  std::int64_t utime = 0;         ///< Start of the scan [us since the epoch].
  std::string name;
};

/// What clearway-play plays: scans in order of time.
class ScanSource {
 public:
  virtual ~ScanSource() = default;
  [[nodiscard]] virtual std::size_t size() const = 0;
  /// Time that a scan lasts [us].
  [[nodiscard]] virtual std::int64_t period_us() const = 0;
  /// Start of scan i [us since the epoch].
  [[nodiscard]] virtual std::int64_t utime(std::size_t i) const = 0;
  /// Throws io::ReadError when scan i cannot be read; the others still can.
  [[nodiscard]] virtual PlayedScan Read(std::size_t i) = 0;
};

/// The recording at `input` (see io::CloudSource), or, for a scene file (.xml), what the first
/// sensor of the configuration sees of it during `scene_s` seconds while the vehicle stands where
/// the scene starts. Throws io::ReadError or config::ConfigError.
[[nodiscard]] std::unique_ptr<ScanSource> OpenSource(const std::filesystem::path& input,
                                                     const graph::GraphConfig& config,
                                                     double scene_s);

}  // namespace clearway::play
