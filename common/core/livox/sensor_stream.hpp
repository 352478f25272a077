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
  int max_points = 3000;  ///< In one slice; slices are made shorter where dual return needs it.
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

/// What came and what did not, since the start. Each packet is exactly one of: used (with its shots
/// in a slice), duplicate, late, unfit, or still waiting for the clock to settle.
struct StreamCounts {
  std::int64_t packets = 0;
  std::int64_t lost_packets = 0;   ///< By gaps of the stamps; of late ones, too.
  std::int64_t duplicates = 0;     ///< Packets whose stamp was there already; left out.
  std::int64_t reordered = 0;      ///< Packets that came after a younger one, in time to be used.
  std::int64_t late_packets = 0;   ///< Packets whose slice had gone out already; left out.
  std::int64_t unfit_packets = 0;  ///< Packets whose stamp fits no clock; left out.
  std::int64_t pauses = 0;         ///< Gaps of more than kMaxGap_us, which are not counted as loss.
  std::int64_t shots = 0;
  std::int64_t zero_returns = 0;
  std::int64_t overflow_points = 0;  ///< Beyond max_points of a slice; left out.
  std::int64_t slices = 0;
};

/// Cuts one sensor's packets into slices: by the time of each shot, on the grid of scan_period_us
/// since the epoch, so that scan_id = start / scan_period_us is the same for all sensors. A packet
/// that straddles a border is split.
///
/// A slice leaves when packets have come without a gap up to its end, or slice_grace_us after it.
/// What is then missing of the packets that would have begun in it is lost, if a younger one shows
/// that time went on; else that loss is counted in the next slice that leaves. A packet that comes
/// later still is late, and the loss stays counted; one that comes in time is sorted in and no
/// loss. A slice in whose time nothing came leaves, empty, once a younger packet has come; a silent
/// sensor sends no slices. When even the quickest packets come late (DeviceClock::lag_us()), slices
/// wait as much longer.
///
/// While the clock settles, at the start and after a reset or step, packets are held: slices are
/// then up to DeviceClock::kMaxSettle_us late, but nothing is lost. After such a jump scans go on
/// in order: what falls into a time whose slices have gone is late, unless that is more than one
/// scan, when the order begins again there.
///
/// Add() allocates nothing once sizes have settled; Take() makes each slice's own arrays. Thread
/// safety: none.
class SensorStream {
 public:
  /// A longer time without packets is a pause: whether the sensor sent then nobody knows [us].
  static constexpr std::int64_t kMaxGap_us = 1'000'000;

  /// @pre config is as DriverConfig::Validate() wants it.
  explicit SensorStream(const StreamConfig& config);
  ~SensorStream();
  SensorStream(const SensorStream&) = delete;
  SensorStream& operator=(const SensorStream&) = delete;

  /// Takes a packet that arrived at `arrival_utime` on the host's clock. O(points). Says what
  /// happened to the sensor's clock with it.
  ClockEvent Add(const DataPacket& packet, std::int64_t arrival_utime);

  /// The slices that are whole or due, oldest first. @pre what arrived before now_utime has been
  /// added: empty the socket first, or slices leave without what waits in it.
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
