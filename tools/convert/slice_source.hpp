// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "common/core/scan/scan_assembler.hpp"

namespace clearway::convert {

/// What clearway-convert reads and writes.
enum class Format : std::uint8_t { kLvx, kLog, kFolder };

/// By the path alone: .lvx, a folder (or a path without an ending that is not there yet), else an
/// LCM log.
[[nodiscard]] Format FormatOf(const std::filesystem::path& path);

/// What the files do not say themselves.
struct SourceSettings {
  std::filesystem::path input = {};
  std::vector<std::string> sensors = {};  ///< Names, in the order of the devices of an LVX file.
  std::string channel_prefix = {};        ///< Of a log.
  std::int64_t scan_period_us = 100'000;  ///< Scans that packets are cut into; of a folder.
  std::optional<std::int64_t> start_utime = {};  ///< Of stamps that count from power-on [us].
  int floats_per_point = 4;      ///< Of .bin files in a folder: 3 (x y z) or 4 (x y z intensity).
  double intensity_scale = 1.0;  ///< Of a folder: a file's intensity times this is 0..255.
};

/// A slice of one sensor with what LIDAR_POINTS tells beyond it.
struct TimedSlice {
  core::Slice slice;  ///< Its sensor is an index into SliceSource::sensors().
  std::int64_t lost_packets = 0;
  std::int8_t time_source = 0;  ///< lidar_points_t::TIME_*
  std::int8_t return_mode = 0;  ///< lidar_points_t::RETURN_*
  std::int64_t utime = 0;       ///< When it was, or would have been, sent [us since the epoch].
};

/// What a source held, for the summary line.
struct SourceCounts {
  std::int64_t packets = 0;
  std::int64_t lost_packets = 0;
  std::int64_t zero_returns = 0;
  std::int64_t left_out = 0;  ///< Packets, messages or files that could not be used.
  std::vector<std::string> problems =
      {};  ///< One line each; a damaged input is converted all the same.
  std::vector<std::string> remarks = {};  ///< Likewise, of what is no fault.
};

/// A recording as slices, in order of time for each sensor.
class SliceSource {
 public:
  virtual ~SliceSource() = default;
  /// Names of the sensors, at least one.
  [[nodiscard]] virtual const std::vector<std::string>& sensors() const = 0;
  /// The next slice; nothing at the end. Throws io::ReadError.
  [[nodiscard]] virtual std::optional<TimedSlice> Next() = 0;
  /// How much has been read, 0..1.
  [[nodiscard]] virtual double progress() const = 0;
  /// Complete after the end.
  [[nodiscard]] virtual SourceCounts counts() const = 0;
};

/// Throws io::ReadError.
[[nodiscard]] std::unique_ptr<SliceSource> OpenSource(const SourceSettings& settings);

}  // namespace clearway::convert
