// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <deque>
#include <optional>
#include <vector>

#include "common/core/livox/data_packet.hpp"
#include "common/core/livox/device_clock.hpp"
#include "common/core/livox/packet_gaps.hpp"
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
  std::int64_t lost_packets = 0;  ///< By gaps of the stamps; also those that came too late.
  std::int64_t duplicates = 0;    ///< Packets whose stamp was there already; left out.
  std::int64_t reordered = 0;     ///< Packets that came after a younger one, in time to be used.
  std::int64_t late_packets = 0;  ///< Packets whose slice had gone out already; left out.
  std::int64_t misfits = 0;       ///< Packets whose stamp fits nothing that was seen; left out.
  std::int64_t shots = 0;
  std::int64_t zero_returns = 0;     ///< Shots without any echo.
  std::int64_t overflow_points = 0;  ///< Beyond max_points of a slice; left out.
  std::int64_t slices = 0;
};

/// Cuts one sensor's packets into slices: by the time of each shot, on the grid of scan_period_us
/// since the epoch, so that scan_id = start / scan_period_us is the same for all sensors. A slice
/// leaves when a packet beyond its end has come and no gap within it is open, or slice_grace_us
/// after its end. One whose packets were all lost leaves empty, when a younger packet shows that
/// the sensor went on; while the sensor is silent, nothing leaves.
/// Packets that come before the clock has settled are held until it has.
/// Add() allocates nothing once sizes have settled. Thread safety: none.
class SensorStream {
 public:
  /// @pre config is as DriverConfig::Validate() wants it.
  explicit SensorStream(const StreamConfig& config);

  /// Takes a packet that arrived at `arrival_utime` on the host's clock. O(points).
  void Add(const DataPacket& packet, std::int64_t arrival_utime);

  /// The slices that are whole or due, oldest first.
  [[nodiscard]] std::vector<StreamSlice> Take(std::int64_t now_utime);

  /// When Take() should be called at the latest; nothing while nothing waits.
  [[nodiscard]] std::optional<std::int64_t> NextDue() const;

  /// The sensor was connected anew: what waits is dropped, the clock is found anew, counts go on.
  void Restart();

  [[nodiscard]] const StreamCounts& counts() const { return counts_; }
  [[nodiscard]] const DeviceClock& clock() const { return clock_; }
  [[nodiscard]] int slices_in_scan() const { return static_cast<int>(slices_in_scan_); }

 private:
  // A slice that is being filled. Its number counts slices since the epoch.
  struct Open {
    std::int64_t number = 0;
    std::int64_t shots = 0;
    std::int64_t zero_returns = 0;
    bool is_dual = false;
    bool is_in_order = true;
    PointCloud cloud_sensor;
  };
  // A packet that waits for the clock.
  struct Held {
    DataPacket packet;
    std::uint64_t device_ns = 0;
    bool is_device_stamp = false;
    std::vector<std::byte> payload;
  };

  void BeginAnew();
  void Hold(const DataPacket& packet, const DeviceClock::Reading& reading, std::int64_t arrival);
  void ReleaseHeld();
  void Place(const DataPacket& packet, std::uint64_t device_ns, bool is_device_stamp);
  void Fill(const DataPacket& packet, std::int64_t utime_ns);
  [[nodiscard]] Open& OpenFor(std::int64_t number);
  void AddShot(Open& open, std::span<const Point> echoes, std::int64_t utime);
  [[nodiscard]] std::int64_t NumberOf(std::int64_t utime) const;
  [[nodiscard]] std::int64_t BeginOf(std::int64_t number) const;
  [[nodiscard]] bool IsWhole(const Open& open) const;
  void LeaveUpTo(std::int64_t number, std::vector<StreamSlice>& out);
  void LeaveFront(std::vector<StreamSlice>& out);
  [[nodiscard]] StreamSlice Make(std::int64_t number, const Open* open);

  StreamConfig config_;
  std::int64_t slices_in_scan_ = 1;
  DeviceClock clock_;
  PacketGaps gaps_;
  StreamCounts counts_;
  std::deque<Open> open_;         // Ascending number.
  std::vector<Open> spare_;       // Their clouds keep their memory.
  std::vector<StreamSlice> due_;  // What has left before Take() was called.
  std::vector<Held> held_;
  std::size_t num_held_ = 0;
  std::int64_t first_held_utime_ = 0;
  std::optional<std::int64_t> next_number_;  // No slice below it will leave any more.
  std::int64_t reached_utime_ = 0;           // End of the youngest packet.
};

}  // namespace clearway::core::livox
