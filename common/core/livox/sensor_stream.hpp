// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "common/core/livox/data_packet.hpp"
#include "common/core/livox/device_clock.hpp"
#include "common/core/scan/scan_assembler.hpp"

namespace clearway::core::livox {

/// How packets become slices of scans. Times as in DriverConfig.
struct StreamConfig {
  std::int64_t scan_period_us = 100'000;
  std::int64_t slice_us = 10'000;  ///< Divides scan_period_us.
  std::int64_t slice_grace_us = 15'000;
  int max_points = 3000;  ///< In one slice; slices are made shorter where this asks for it.
  ClockConfig clock;
};

/// A slice with what a driver knows beyond it. Session and sequence of `slice`, and its sensor,
/// are left to the caller.
struct StreamSlice {
  Slice slice;
  std::int64_t lost_packets = 0;  ///< That never came, of those that would have begun in it.
  TimeSource time_source = TimeSource::kHost;
  bool is_dual = false;
};

/// What came and what did not, since the start.
struct StreamCounts {
  std::int64_t packets = 0;
  std::int64_t lost_packets = 0;  ///< By gaps of the stamps.
  std::int64_t duplicates = 0;    ///< Packets whose stamp was there already; left out.
  std::int64_t reordered = 0;     ///< Packets that came after a younger one, in time to be used.
  std::int64_t late_packets = 0;  ///< Packets whose slice had gone out already; left out.
  std::int64_t shots = 0;
  std::int64_t zero_returns = 0;
  std::int64_t overflow_points = 0;  ///< Beyond max_points of a slice; left out.
  std::int64_t slices = 0;
};

/// Cuts one sensor's packets into slices: by the time of each shot, on the grid of scan_period_us
/// since the epoch, so that scan_id = start / scan_period_us is the same for all sensors. A slice
/// leaves when a packet beyond its end has come and no gap within it is open, or slice_grace_us
/// after its end; a slice in whose time the sensor sent nothing at all does not leave.
/// Add() allocates nothing once sizes have settled. Thread safety: none.
class SensorStream {
 public:
  /// @pre config is as DriverConfig::Validate() wants it.
  explicit SensorStream(const StreamConfig& config);
  ~SensorStream();
  SensorStream(const SensorStream&) = delete;
  SensorStream& operator=(const SensorStream&) = delete;

  /// Takes a packet that arrived at `arrival_utime` on the host's clock. O(points).
  void Add(const DataPacket& packet, std::int64_t arrival_utime);

  /// The slices that are whole or due, oldest first.
  [[nodiscard]] std::vector<StreamSlice> Take(std::int64_t now_utime);

  /// When Take() should be called at the latest; nothing while nothing waits.
  [[nodiscard]] std::optional<std::int64_t> NextDue() const;

  /// The sensor was connected anew: what waits is dropped, the clock is found anew, counts go on.
  void Restart();

  [[nodiscard]] const StreamCounts& counts() const;
  [[nodiscard]] const DeviceClock& clock() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace clearway::core::livox
