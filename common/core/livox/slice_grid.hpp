// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cstdint>

#include "common/core/livox/data_packet.hpp"
#include "common/core/scan/scan_assembler.hpp"

namespace clearway::core::livox {

/// Cuts time since the epoch into scans and each scan into `count` slices; slices have one running
/// number, scan * count + index. Borders are whole microseconds.
class SliceGrid {
 public:
  /// As many slices as slice_us asks for, or more, so that one of them holds no more than
  /// `max_points` of the densest data, dual return. @pre all positive.
  SliceGrid(std::int64_t scan_period_us, std::int64_t slice_us, int max_points)
      : period_us_(scan_period_us),
        count_(std::clamp<std::int64_t>(scan_period_us / slice_us, 1, kMaxSlices)) {
    while (count_ < kMaxSlices && MostPoints() > max_points) ++count_;
  }

  [[nodiscard]] std::int64_t count() const { return count_; }
  [[nodiscard]] std::int64_t ScanOf(std::int64_t slice) const { return slice / count_; }
  [[nodiscard]] std::int64_t IndexInScan(std::int64_t slice) const { return slice % count_; }
  [[nodiscard]] std::int64_t ScanStart_us(std::int64_t slice) const {
    return ScanOf(slice) * period_us_;
  }
  [[nodiscard]] std::int64_t Start_us(std::int64_t slice) const {
    return ScanStart_us(slice) + IndexInScan(slice) * period_us_ / count_;
  }
  /// The slice with this moment. @pre utime >= 0.
  [[nodiscard]] std::int64_t SliceAt(std::int64_t utime) const {
    const std::int64_t in_scan_us = utime % period_us_;
    return utime / period_us_ * count_ + ((in_scan_us + 1) * count_ - 1) / period_us_;
  }

 private:
  // Of one slice; the clock's mapping may stretch time by 1 %.
  [[nodiscard]] std::int64_t MostPoints() const {
    const std::int64_t longest_us = (period_us_ + count_ - 1) / count_;
    const std::int64_t shots = longest_us / kShotPeriod_us + longest_us / (100 * kShotPeriod_us);
    return 2 * (shots + 2);
  }

  std::int64_t period_us_;
  std::int64_t count_;
};

}  // namespace clearway::core::livox
