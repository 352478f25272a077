// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

#include "common/core/livox/little_endian.hpp"

namespace clearway::core::livox {

/// Time between two shots of a MID-70: 100,000 shots/s [us].
inline constexpr std::int64_t kShotPeriod_us = 10;

/// What the points of a data packet look like. 6 (IMU), 7 and 8 (triple return) exist, but no
/// MID-70 sends them.
enum class DataType : std::uint8_t {
  kCartesian = 0,
  kSpherical = 1,
  kExtendedCartesian = 2,  ///< A MID-70, single return.
  kExtendedSpherical = 3,
  kDualCartesian = 4,  ///< A MID-70, dual return.
  kDualSpherical = 5,
};

/// What the stamp of a data packet counts.
enum class TimestampType : std::uint8_t {
  kNoSync = 0,  ///< Nanoseconds since power-on.
  kPtp = 1,     ///< Nanoseconds of the PTP master's clock.
  kReserved = 2,
  kGps = 3,  ///< UTC: year, month, day, hour (a byte each), microseconds of the hour.
  kPps = 4,  ///< Nanoseconds since the last pulse.
  kUnknown = 5,
};

/// Sizes of a data type.
struct DataLayout {
  std::size_t shot_bytes = 0;       ///< Of all echoes of one shot.
  std::size_t echoes = 1;           ///< Points for each shot.
  std::size_t shots_in_packet = 0;  ///< In a packet as sensors send it.
  bool has_tag = false;
  bool is_spherical = false;
};
/// Nothing for types that are none of DataType.
[[nodiscard]] std::optional<DataLayout> LayoutOf(std::uint8_t data_type);
[[nodiscard]] inline DataLayout LayoutOf(DataType type) {
  return *LayoutOf(static_cast<std::uint8_t>(type));
}

inline constexpr std::size_t kDataHeaderBytes = 18;
inline constexpr std::size_t kMaxShotsInPacket = 100;
inline constexpr std::size_t kMaxPointsInPacket = 100;
inline constexpr std::size_t kMaxDataPacketBytes = 1400;

/// The first 18 bytes of a data packet.
struct DataHeader {
  std::uint8_t slot_id = 1;
  std::uint8_t lidar_id = 1;
  std::uint32_t status_code = 0;  ///< DecodeStatus()
  TimestampType timestamp_type = TimestampType::kNoSync;
  DataType data_type = DataType::kExtendedCartesian;
  std::uint64_t timestamp = 0;  ///< Of the first shot: the eight bytes as a little-endian number.
  friend bool operator==(const DataHeader&, const DataHeader&) = default;
};

/// What is wrong with a datagram that should be a data packet.
enum class PacketDefect : std::uint8_t {
  kNone,
  kTooShort,       ///< Less than kDataHeaderBytes.
  kVersion,        ///< Not version 5.
  kForeignType,    ///< A data type that no MID-70 sends.
  kTimestampType,  ///< No TimestampType.
  kSize,           ///< Not a whole number of shots, none, or more than a packet holds.
};
inline constexpr std::size_t kNumPacketDefects = 6;
[[nodiscard]] const char* DefectText(PacketDefect defect);

struct DataPacket {
  DataHeader header;
  DataLayout layout;
  ByteView payload;  ///< shots * layout.shot_bytes, of somebody else's buffer.
  std::size_t shots = 0;
  [[nodiscard]] std::size_t num_points() const { return shots * layout.echoes; }
};

struct ParsedPacket {
  std::optional<DataPacket> packet;  ///< There exactly when `defect` is kNone.
  PacketDefect defect = PacketDefect::kNone;
};

/// Takes one datagram as one data packet. There is no checksum: size, version and types must match
/// exactly. O(1).
[[nodiscard]] ParsedPacket ParsePacket(ByteView datagram);

/// A point in the sensor's frame (x forward, y left, z up). All zero: the shot did not return.
struct Point {
  float x_m = 0.0F;
  float y_m = 0.0F;
  float z_m = 0.0F;
  std::uint8_t reflectivity = 0;
  std::uint8_t tag = 0;  ///< 0 where the data type has none.
  [[nodiscard]] bool is_return() const { return x_m != 0.0F || y_m != 0.0F || z_m != 0.0F; }
  friend bool operator==(const Point&, const Point&) = default;
};

/// The points of a packet, in order of the shots; of dual types echo 1 and echo 2 of each shot in
/// turn. Millimetres become metres by one division in float. O(points), allocates nothing.
/// Source: spherical x = r sin(theta) cos(phi), y = r sin(theta) sin(phi), z = r cos(theta).
/// @pre points.size() >= packet.num_points().
void DecodePoints(const DataPacket& packet, std::span<Point> points);

/// A point as a sensor measures it.
struct WirePoint {
  std::int32_t x_mm = 0;
  std::int32_t y_mm = 0;
  std::int32_t z_mm = 0;
  std::uint8_t reflectivity = 0;
  std::uint8_t tag = 0;
  friend bool operator==(const WirePoint&, const WirePoint&) = default;
};

/// The bytes of a data packet that holds `points`, in the order that DecodePoints() gives them.
/// Spherical types round to 1 mm and 0.01 deg; types without tags lose them. O(points).
/// @pre points.size() is a multiple of the layout's echoes, at least one shot and at most
/// kMaxShotsInPacket.
[[nodiscard]] Bytes PackPacket(const DataHeader& header, std::span<const WirePoint> points);

/// Nanoseconds since the epoch of a GPS stamp; nothing where it states no moment.
[[nodiscard]] std::optional<std::int64_t> GpsUtcNs(std::uint64_t timestamp);
/// The GPS stamp of a moment, cut to whole microseconds. @pre years 2000 to 2255.
[[nodiscard]] std::uint64_t ToGpsTimestamp(std::int64_t utc_ns);

}  // namespace clearway::core::livox
