// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "tools/convert/packet_packer.hpp"
#include "tools/convert/slice_source.hpp"

namespace clearway::convert {

/// What was written.
struct SinkCounts {
  std::int64_t scans = 0;
  std::int64_t points = 0;
  std::int64_t packets = 0;     ///< Of an LVX file; messages of a log.
  std::int64_t unwritable = 0;  ///< Points that the format cannot hold.
  std::int64_t unused = 0;      ///< Slices that are no part of a scan: copies, late ones.
};

/// Takes slices in the order of their source. Both throw std::runtime_error with the file.
class SliceSink {
 public:
  virtual ~SliceSink() = default;
  virtual void Take(const TimedSlice& slice) = 0;
  /// Writes what is left. Nothing may be taken after.
  virtual SinkCounts Finish() = 0;
};

/// LIDAR_POINTS in an LCM log, each logged when it would have been sent.
[[nodiscard]] std::unique_ptr<SliceSink> MakeLogSink(const std::filesystem::path& path,
                                                     const std::vector<std::string>& sensors,
                                                     const std::string& channel_prefix);

/// A .pcd file for each scan, named after its start in seconds; a folder of its own for each sensor
/// where there are several. The folder is made; throws when it holds scans already.
[[nodiscard]] std::unique_ptr<SliceSink> MakeFolderSink(const std::filesystem::path& folder,
                                                        const std::vector<std::string>& sensors);

/// LVX 1.1; one device for each sensor, whose code is its name. `packings`: by sensor.
[[nodiscard]] std::unique_ptr<SliceSink> MakeLvxSink(const std::filesystem::path& path,
                                                     const std::vector<std::string>& sensors,
                                                     const std::vector<Packing>& packings);

}  // namespace clearway::convert
