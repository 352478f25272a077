// SPDX-License-Identifier: BSD-3-Clause
// Any bytes as a data packet: refused, or points that are finite, and, where the coordinates are
// those of the wire, packed again to the same bytes.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <vector>

#include "common/core/livox/data_packet.hpp"

namespace {

using namespace clearway::core::livox;

void Require(bool holds) {
  if (!holds) std::abort();
}

// Straight from the bytes, as a second opinion.
std::vector<WirePoint> CartesianPoints(const DataPacket& packet) {
  std::vector<WirePoint> points;
  const std::size_t stride = packet.layout.shot_bytes / packet.layout.echoes;
  for (std::size_t i = 0; i < packet.num_points(); ++i) {
    const std::size_t at = i * stride;
    points.push_back({.x_mm = Load<std::int32_t>(packet.payload, at),
                      .y_mm = Load<std::int32_t>(packet.payload, at + 4),
                      .z_mm = Load<std::int32_t>(packet.payload, at + 8),
                      .reflectivity = Load<std::uint8_t>(packet.payload, at + 12)});
    if (packet.layout.has_tag) points.back().tag = Load<std::uint8_t>(packet.payload, at + 13);
  }
  return points;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const ByteView bytes(reinterpret_cast<const std::byte*>(data), size);
  const ParsedPacket parsed = ParsePacket(bytes);
  Require(parsed.packet.has_value() == (parsed.defect == PacketDefect::kNone));
  if (!parsed.packet) return 0;
  const DataPacket& packet = *parsed.packet;
  Require(packet.num_points() > 0 && packet.num_points() <= kMaxPointsInPacket);
  std::array<Point, kMaxPointsInPacket> points{};
  DecodePoints(packet, points);
  for (const Point& point : points) {
    Require(std::isfinite(point.x_m) && std::isfinite(point.y_m) && std::isfinite(point.z_m));
  }
  if (packet.header.timestamp_type == TimestampType::kGps) {
    const auto utc_ns = GpsUtcNs(packet.header.timestamp);
    Require(!utc_ns || ToGpsTimestamp(*utc_ns) == packet.header.timestamp);
  }
  if (packet.layout.is_spherical) return 0;
  const std::vector<WirePoint> wire = CartesianPoints(packet);
  for (std::size_t i = 0; i < wire.size(); ++i) {
    Require(points[i].x_m == static_cast<float>(wire[i].x_mm) / 1000.0F);
  }
  Bytes packed = PackPacket(packet.header, wire);
  packed[3] = bytes[3];  // Reserved, not kept.
  Require(std::equal(packed.begin(), packed.end(), bytes.begin(), bytes.end()));
  return 0;
}
