// SPDX-License-Identifier: BSD-3-Clause
#include "tools/convert/packet_packer.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <string>

namespace clearway::convert {
namespace {

using core::livox::Bytes;
using core::livox::kShotPeriod_us;
using core::livox::WirePoint;

// Packets of a sensor never overlap.
constexpr std::int64_t kLeastSpacing_us = 480;

// A point goes into the shot at or before its time; a microsecond less is the rounding of offsets.
std::int64_t SlotOf(std::int64_t us) {
  return (us + 1) / kShotPeriod_us;
}

core::livox::DataType TypeFor(Packing packing) {
  return packing == Packing::kSingle ? core::livox::DataType::kExtendedCartesian
                                     : core::livox::DataType::kDualCartesian;
}

}  // namespace

Packing PackingFor(const CollectedScan& scan) {
  Packing packing = Packing::kSingle;
  const std::vector<std::int32_t>& times_us = scan.cloud_sensor.time_offset_us;
  std::size_t same = 1;
  for (std::size_t i = 1; i < times_us.size(); ++i) {
    const std::int32_t step_us = times_us[i] - times_us[i - 1];
    if (step_us == 0 && ++same <= 2) {
      packing = std::max(packing, Packing::kDual);
      continue;
    }
    // A microsecond less: offsets of real shots are rounded.
    if (step_us < kShotPeriod_us - 1) return Packing::kDense;
    same = 1;
  }
  return packing;
}

PacketPacker::PacketPacker(Packing packing)
    : packing_(packing),
      header_{.timestamp_type = core::livox::TimestampType::kPtp, .data_type = TypeFor(packing)},
      echoes_(core::livox::LayoutOf(header_.data_type).echoes),
      shots_(core::livox::LayoutOf(header_.data_type).shots_in_packet) {}

std::vector<Bytes> PacketPacker::Add(const CollectedScan& scan) {
  Packets packets;
  if (packing_ == Packing::kDense) {
    AddDense(scan, packets);
    return packets;
  }
  const core::PointCloud& cloud = scan.cloud_sensor;
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    if (const auto point = ToWire(cloud, i)) {
      AddAtItsTime(*point, scan.utime_start + cloud.time_offset_us[i], scan, packets);
    }
  }
  return packets;
}

std::vector<Bytes> PacketPacker::Finish() {
  Packets packets;
  if (is_open_) End(packets);
  return packets;
}

std::optional<WirePoint> PacketPacker::ToWire(const core::PointCloud& cloud, std::size_t i) {
  const auto millimetres = [](float metres) {
    return std::round(static_cast<double>(metres) * 1000.0);
  };
  const double x = millimetres(cloud.x[i]);
  const double y = millimetres(cloud.y[i]);
  const double z = millimetres(cloud.z[i]);
  constexpr double kMost = std::numeric_limits<std::int32_t>::max();
  const bool is_writable = std::abs(x) <= kMost && std::abs(y) <= kMost && std::abs(z) <= kMost &&
                           (x != 0.0 || y != 0.0 || z != 0.0);
  if (!is_writable) {
    ++num_unwritable_;
    return std::nullopt;
  }
  ++num_points_;
  return WirePoint{.x_mm = static_cast<std::int32_t>(x),
                   .y_mm = static_cast<std::int32_t>(y),
                   .z_mm = static_cast<std::int32_t>(z),
                   .reflectivity = cloud.intensity[i],
                   .tag = cloud.tag[i]};
}

void PacketPacker::AddAtItsTime(const WirePoint& point,
                                std::int64_t utime,
                                const CollectedScan& scan,
                                Packets& packets) {
  const bool fills_gaps = scan.zero_returns > 0 && scan.lost_packets == 0;
  const auto duration_us = static_cast<std::int64_t>(shots_) * kShotPeriod_us;
  while (is_open_ && SlotOf(utime - open_utime_) >= static_cast<std::int64_t>(shots_)) {
    const std::int64_t next_utime = open_utime_ + duration_us;
    End(packets);
    if (fills_gaps && SlotOf(utime - next_utime) >= 0) Begin(next_utime);
  }
  if (!is_open_) Begin(utime);
  std::size_t slot = FreeSlot(utime, scan);
  if (slot == shots_) {
    End(packets);
    Begin(utime);
    slot = 0;
  }
  open_[slot * echoes_ + used_[slot]] = point;
  ++used_[slot];
}

// That of the shot at this time or the next one with room, within the scan; none: shots_.
std::size_t PacketPacker::FreeSlot(std::int64_t utime, const CollectedScan& scan) const {
  std::int64_t wanted = std::max<std::int64_t>(SlotOf(utime - open_utime_), 0);
  const auto utime_of = [&](std::int64_t slot) { return open_utime_ + slot * kShotPeriod_us; };
  if (utime_of(wanted) < scan.utime_start) ++wanted;
  if (utime_of(wanted) >= scan.utime_end && wanted > 0) --wanted;
  auto slot = static_cast<std::size_t>(wanted);
  while (slot < shots_ && used_[slot] == echoes_) ++slot;
  return std::min(slot, shots_);
}

void PacketPacker::Begin(std::int64_t utime) {
  is_open_ = true;
  open_utime_ = utime;
  open_.assign(shots_ * echoes_, {});
  used_.assign(shots_, 0);
}

void PacketPacker::End(Packets& packets) {
  header_.timestamp = static_cast<std::uint64_t>(open_utime_) * 1000U;
  packets.push_back(core::livox::PackPacket(header_, open_));
  is_open_ = false;
}

void PacketPacker::AddDense(const CollectedScan& scan, Packets& packets) {
  std::vector<WirePoint> points;
  for (std::size_t i = 0; i < scan.cloud_sensor.size(); ++i) {
    if (const auto point = ToWire(scan.cloud_sensor, i)) points.push_back(*point);
  }
  const std::size_t in_packet = shots_ * echoes_;
  const std::size_t n = (points.size() + in_packet - 1) / in_packet;
  const std::int64_t last_us =
      scan.utime_end - scan.utime_start - static_cast<std::int64_t>(shots_) * kShotPeriod_us;
  const auto steps = static_cast<std::int64_t>(n > 1 ? n - 1 : 1);
  if (n > 1 && last_us / steps < kLeastSpacing_us) {
    throw std::runtime_error(
        "the scan at " + std::to_string(scan.utime_start) + " us has " +
        std::to_string(points.size()) + " points; packets of a MID-70 hold at most " +
        std::to_string((last_us / kLeastSpacing_us + 1) * static_cast<std::int64_t>(in_packet)) +
        " in its time: write an LCM log or a folder");
  }
  for (std::size_t k = 0; k < n; ++k) {
    Begin(scan.utime_start +
          std::max<std::int64_t>(last_us, 0) * static_cast<std::int64_t>(k) / steps);
    const std::size_t first = k * in_packet;
    const std::size_t count = std::min(in_packet, points.size() - first);
    std::copy_n(points.begin() + static_cast<std::ptrdiff_t>(first), count, open_.begin());
    End(packets);
  }
}

}  // namespace clearway::convert
