// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <map>
#include <utility>
#include <vector>

#include "common/core/scan/scan_assembler.hpp"
#include "tools/convert/slice_source.hpp"

namespace clearway::convert {

/// One sensor's scan.
struct CollectedScan {
  int sensor = 0;
  std::int64_t utime_start = 0;
  std::int64_t utime_end = 0;
  core::PointCloud cloud_sensor;  ///< Time offsets count from utime_start.
  std::int64_t zero_returns = 0;
  std::int64_t lost_packets = 0;
};

/// Puts slices together to scans of one sensor each, as the graph does: core::ScanAssembler.
class ScanCollector {
 public:
  explicit ScanCollector(std::size_t num_sensors);

  /// Takes a slice; the scans that are whole or due.
  [[nodiscard]] std::vector<CollectedScan> Add(const TimedSlice& slice);

  /// What is left.
  [[nodiscard]] std::vector<CollectedScan> Finish();

  /// Slices that were not used: duplicates, late ones.
  [[nodiscard]] std::int64_t num_unused() const { return num_unused_; }

 private:
  struct Extra {
    std::int64_t zero_returns = 0;
    std::int64_t lost_packets = 0;
  };
  [[nodiscard]] std::vector<CollectedScan> Poll();

  core::ScanAssembler assembler_;
  std::map<std::pair<std::int64_t, int>, Extra> extras_;  // By scan id and sensor.
  std::int64_t now_us_ = 0;
  std::int64_t num_unused_ = 0;
};

}  // namespace clearway::convert
