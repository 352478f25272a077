// SPDX-License-Identifier: BSD-3-Clause
#include "tools/convert/scan_collector.hpp"

#include <algorithm>

namespace clearway::convert {

ScanCollector::ScanCollector(std::size_t num_sensors)
    : assembler_({}, static_cast<int>(num_sensors)) {}

std::vector<CollectedScan> ScanCollector::Add(const TimedSlice& slice) {
  now_us_ = std::max(now_us_, slice.utime);
  std::vector<CollectedScan> ready = Poll();
  if (assembler_.Add(slice.slice, now_us_) == core::SliceOutcome::kAccepted) {
    Extra& extra = extras_[{slice.slice.scan_id, slice.slice.sensor}];
    extra.zero_returns += slice.slice.zero_returns;
    extra.lost_packets += slice.lost_packets;
  } else {
    ++num_unused_;
  }
  for (CollectedScan& scan : Poll()) ready.push_back(std::move(scan));
  return ready;
}

std::vector<CollectedScan> ScanCollector::Finish() {
  now_us_ += 2 * core::kMaxScan_us;
  return Poll();
}

std::vector<CollectedScan> ScanCollector::Poll() {
  std::vector<CollectedScan> scans;
  for (core::AssembledScan& scan : assembler_.Poll(now_us_)) {
    for (std::size_t i = 0; i < scan.sensors.size(); ++i) {
      core::SensorScan& part = scan.sensors[i];
      if (!part.present) continue;
      const Extra& extra = extras_[{scan.scan_id, static_cast<int>(i)}];
      scans.push_back({.sensor = static_cast<int>(i),
                       .utime_start = part.utime_start,
                       .utime_end = part.utime_end,
                       .cloud_sensor = std::move(part.cloud_sensor),
                       .zero_returns = extra.zero_returns,
                       .lost_packets = extra.lost_packets});
      extras_.erase({scan.scan_id, static_cast<int>(i)});
    }
  }
  return scans;
}

}  // namespace clearway::convert
