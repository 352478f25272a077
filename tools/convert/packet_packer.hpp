// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "common/core/livox/data_packet.hpp"
#include "tools/convert/scan_collector.hpp"

namespace clearway::convert {

/// How a sensor's scans go into packets of a MID-70, which fires once in 10 us.
enum class Packing : std::uint8_t {
  kSingle,  ///< At most one point in 10 us: single return, each point at its time.
  kDual,    ///< At most two with the same time: dual return, each point at its time.
  kDense,   ///< More: dual return, packets spread over the scan, times to about 0.5 ms.
};

/// The least that a scan needs.
[[nodiscard]] Packing PackingFor(const CollectedScan& scan);

/// Turns scans into full data packets whose stamps are nanoseconds since the epoch, as with PTP.
/// Places in a packet for which there is no point become shots without a return; where a scan
/// states shots without a return and no loss, the time between its packets is filled with them, so
/// that nobody takes it for loss. Coordinates are rounded to 1 mm.
class PacketPacker {
 public:
  explicit PacketPacker(Packing packing);

  /// The packets that are full. Throws std::runtime_error when a dense scan has more points than a
  /// MID-70 could send in its time: 200,000 a second.
  [[nodiscard]] std::vector<core::livox::Bytes> Add(const CollectedScan& scan);

  /// The packet that was begun, filled up.
  [[nodiscard]] std::vector<core::livox::Bytes> Finish();

  /// Points that the wire cannot say: not finite, beyond 2,147 km, or within 0.5 mm of the sensor.
  [[nodiscard]] std::int64_t num_unwritable() const { return num_unwritable_; }
  [[nodiscard]] std::int64_t num_points() const { return num_points_; }

 private:
  using Packets = std::vector<core::livox::Bytes>;
  [[nodiscard]] std::optional<core::livox::WirePoint> ToWire(const core::PointCloud& cloud,
                                                             std::size_t i);
  void AddAtItsTime(const core::livox::WirePoint& point,
                    std::int64_t utime,
                    const CollectedScan& scan,
                    Packets& packets);
  [[nodiscard]] std::size_t FreeSlot(std::int64_t utime, const CollectedScan& scan) const;
  void Begin(std::int64_t utime);
  void End(Packets& packets);
  void AddDense(const CollectedScan& scan, Packets& packets);

  Packing packing_;
  core::livox::DataHeader header_;
  std::size_t echoes_ = 1;
  std::size_t shots_ = 0;  // Of a full packet.
  std::vector<core::livox::WirePoint> open_;
  std::vector<std::uint8_t> used_;  // Echoes of each shot that hold a point.
  bool is_open_ = false;
  std::int64_t open_utime_ = 0;
  std::int64_t num_unwritable_ = 0;
  std::int64_t num_points_ = 0;
};

}  // namespace clearway::convert
