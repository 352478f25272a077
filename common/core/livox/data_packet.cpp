// SPDX-License-Identifier: BSD-3-Clause
#include "common/core/livox/data_packet.hpp"

#include <cassert>
#include <cmath>
#include <numbers>

namespace clearway::core::livox {
namespace {

constexpr std::uint8_t kVersion = 5;

constexpr std::array<DataLayout, 6> kLayouts{{
    {.shot_bytes = 13,
     .echoes = 1,
     .shots_in_packet = 100,
     .has_tag = false,
     .is_spherical = false},
    {.shot_bytes = 9, .echoes = 1, .shots_in_packet = 100, .has_tag = false, .is_spherical = true},
    {.shot_bytes = 14, .echoes = 1, .shots_in_packet = 96, .has_tag = true, .is_spherical = false},
    {.shot_bytes = 10, .echoes = 1, .shots_in_packet = 96, .has_tag = true, .is_spherical = true},
    {.shot_bytes = 28, .echoes = 2, .shots_in_packet = 48, .has_tag = true, .is_spherical = false},
    {.shot_bytes = 16, .echoes = 2, .shots_in_packet = 48, .has_tag = true, .is_spherical = true},
}};

float Metres(std::int32_t mm) {
  return static_cast<float>(mm) / 1000.0F;
}

Point CartesianAt(ByteView bytes, std::size_t offset, bool has_tag) {
  return {.x_m = Metres(Load<std::int32_t>(bytes, offset)),
          .y_m = Metres(Load<std::int32_t>(bytes, offset + 4)),
          .z_m = Metres(Load<std::int32_t>(bytes, offset + 8)),
          .reflectivity = Load<std::uint8_t>(bytes, offset + 12),
          .tag = has_tag ? Load<std::uint8_t>(bytes, offset + 13) : std::uint8_t{0}};
}

struct Direction {
  double x;
  double y;
  double z;
};

Direction DirectionAt(ByteView bytes, std::size_t offset) {
  constexpr double kRadians = std::numbers::pi / 18000.0;
  const double theta = kRadians * Load<std::uint16_t>(bytes, offset);
  const double phi = kRadians * Load<std::uint16_t>(bytes, offset + 2);
  return {std::sin(theta) * std::cos(phi), std::sin(theta) * std::sin(phi), std::cos(theta)};
}

Point SphericalPoint(std::uint32_t depth_mm, const Direction& direction) {
  const double depth_m = static_cast<double>(depth_mm) / 1000.0;
  return {.x_m = static_cast<float>(depth_m * direction.x),
          .y_m = static_cast<float>(depth_m * direction.y),
          .z_m = static_cast<float>(depth_m * direction.z)};
}

Point SingleSphericalAt(ByteView bytes, std::size_t offset, bool has_tag) {
  Point point = SphericalPoint(Load<std::uint32_t>(bytes, offset), DirectionAt(bytes, offset + 4));
  point.reflectivity = Load<std::uint8_t>(bytes, offset + 8);
  if (has_tag) point.tag = Load<std::uint8_t>(bytes, offset + 9);
  return point;
}

Point EchoAt(ByteView bytes, std::size_t offset, const Direction& direction) {
  Point point = SphericalPoint(Load<std::uint32_t>(bytes, offset), direction);
  point.reflectivity = Load<std::uint8_t>(bytes, offset + 4);
  point.tag = Load<std::uint8_t>(bytes, offset + 5);
  return point;
}

struct Spherical {
  std::uint32_t depth_mm = 0;
  std::uint16_t theta = 0;  // [0.01 deg]
  std::uint16_t phi = 0;    // [0.01 deg]
};

Spherical ToSpherical(const WirePoint& point) {
  constexpr double kHundredths = 18000.0 / std::numbers::pi;
  const double x = point.x_mm;
  const double y = point.y_mm;
  const double z = point.z_mm;
  const double depth = std::sqrt(x * x + y * y + z * z);
  if (depth == 0.0) return {};
  double phi = std::atan2(y, x) * kHundredths;
  if (phi < 0.0) phi += 36000.0;
  return {.depth_mm = static_cast<std::uint32_t>(std::llround(depth)),
          .theta = static_cast<std::uint16_t>(std::lround(std::acos(z / depth) * kHundredths)),
          .phi = static_cast<std::uint16_t>(std::lround(phi))};
}

void AppendCartesian(Bytes& bytes, const WirePoint& point, bool has_tag) {
  Append(bytes, point.x_mm);
  Append(bytes, point.y_mm);
  Append(bytes, point.z_mm);
  Append(bytes, point.reflectivity);
  if (has_tag) Append(bytes, point.tag);
}

void AppendSpherical(Bytes& bytes, std::span<const WirePoint> echoes, const DataLayout& layout) {
  const Spherical first = ToSpherical(echoes.front());
  if (layout.echoes == 1) {
    Append(bytes, first.depth_mm);
    Append(bytes, first.theta);
    Append(bytes, first.phi);
    Append(bytes, echoes.front().reflectivity);
    if (layout.has_tag) Append(bytes, echoes.front().tag);
    return;
  }
  // One direction for both: that of an echo which has one.
  const Spherical second = ToSpherical(echoes.back());
  const Spherical& direction = first.depth_mm > 0 ? first : second;
  Append(bytes, direction.theta);
  Append(bytes, direction.phi);
  for (std::size_t i = 0; i < echoes.size(); ++i) {
    Append(bytes, i == 0 ? first.depth_mm : second.depth_mm);
    Append(bytes, echoes[i].reflectivity);
    Append(bytes, echoes[i].tag);
  }
}

}  // namespace

std::optional<DataLayout> LayoutOf(std::uint8_t data_type) {
  if (data_type >= kLayouts.size()) return std::nullopt;
  return kLayouts[data_type];
}

const char* DefectText(PacketDefect defect) {
  switch (defect) {
    case PacketDefect::kNone:
      return "nothing";
    case PacketDefect::kTooShort:
      return "shorter than a data packet's header";
    case PacketDefect::kVersion:
      return "not version 5";
    case PacketDefect::kForeignType:
      return "a data type that no MID-70 sends";
    case PacketDefect::kTimestampType:
      return "unknown type of time stamp";
    case PacketDefect::kSize:
      return "not a whole number of shots";
  }
  return "unknown";
}

ParsedPacket ParsePacket(ByteView datagram) {
  const auto refuse = [](PacketDefect defect) { return ParsedPacket{std::nullopt, defect}; };
  if (datagram.size() < kDataHeaderBytes) return refuse(PacketDefect::kTooShort);
  if (Load<std::uint8_t>(datagram, 0) != kVersion) return refuse(PacketDefect::kVersion);
  const auto data_type = Load<std::uint8_t>(datagram, 9);
  const std::optional<DataLayout> layout = LayoutOf(data_type);
  if (!layout) return refuse(PacketDefect::kForeignType);
  const auto timestamp_type = Load<std::uint8_t>(datagram, 8);
  if (timestamp_type > static_cast<std::uint8_t>(TimestampType::kUnknown)) {
    return refuse(PacketDefect::kTimestampType);
  }
  const ByteView payload = datagram.subspan(kDataHeaderBytes);
  const std::size_t shots = payload.size() / layout->shot_bytes;
  if (shots == 0 || shots > layout->shots_in_packet ||
      shots * layout->shot_bytes != payload.size()) {
    return refuse(PacketDefect::kSize);
  }
  const DataHeader header{.slot_id = Load<std::uint8_t>(datagram, 1),
                          .lidar_id = Load<std::uint8_t>(datagram, 2),
                          .status_code = Load<std::uint32_t>(datagram, 4),
                          .timestamp_type = static_cast<TimestampType>(timestamp_type),
                          .data_type = static_cast<DataType>(data_type),
                          .timestamp = Load<std::uint64_t>(datagram, 10)};
  return {.packet = DataPacket{header, *layout, payload, shots}, .defect = PacketDefect::kNone};
}

void DecodePoints(const DataPacket& packet, std::span<Point> points) {
  assert(points.size() >= packet.num_points());
  const DataLayout& layout = packet.layout;
  for (std::size_t shot = 0; shot < packet.shots; ++shot) {
    const std::size_t offset = shot * layout.shot_bytes;
    if (layout.echoes == 2) {
      Point* const pair = &points[2 * shot];
      if (layout.is_spherical) {
        const Direction direction = DirectionAt(packet.payload, offset);
        pair[0] = EchoAt(packet.payload, offset + 4, direction);
        pair[1] = EchoAt(packet.payload, offset + 10, direction);
      } else {
        pair[0] = CartesianAt(packet.payload, offset, true);
        pair[1] = CartesianAt(packet.payload, offset + 14, true);
      }
    } else if (layout.is_spherical) {
      points[shot] = SingleSphericalAt(packet.payload, offset, layout.has_tag);
    } else {
      points[shot] = CartesianAt(packet.payload, offset, layout.has_tag);
    }
  }
}

Bytes PackPacket(const DataHeader& header, std::span<const WirePoint> points) {
  const DataLayout layout = LayoutOf(header.data_type);
  assert(!points.empty() && points.size() % layout.echoes == 0);
  Bytes bytes;
  bytes.reserve(kDataHeaderBytes + points.size() / layout.echoes * layout.shot_bytes);
  Append(bytes, kVersion);
  Append(bytes, header.slot_id);
  Append(bytes, header.lidar_id);
  Append(bytes, std::uint8_t{0});
  Append(bytes, header.status_code);
  Append(bytes, static_cast<std::uint8_t>(header.timestamp_type));
  Append(bytes, static_cast<std::uint8_t>(header.data_type));
  Append(bytes, header.timestamp);
  for (std::size_t i = 0; i < points.size(); i += layout.echoes) {
    const std::span<const WirePoint> echoes = points.subspan(i, layout.echoes);
    if (layout.is_spherical) {
      AppendSpherical(bytes, echoes, layout);
      continue;
    }
    for (const WirePoint& echo : echoes) AppendCartesian(bytes, echo, layout.has_tag);
  }
  return bytes;
}

}  // namespace clearway::core::livox
