// SPDX-License-Identifier: BSD-3-Clause
#include "common/io/lvx/lvx_float_package.hpp"

#include <cmath>
#include <limits>
#include <optional>

namespace clearway::io::lvx {
namespace {

using core::livox::ByteView;
using core::livox::Load;
using core::livox::Point;
using core::livox::WirePoint;

// A coordinate as the wire has it. What the wire cannot say is no return.
std::optional<std::int32_t> Millimetres(float metres) {
  const double mm = std::round(static_cast<double>(metres) * 1000.0);
  if (!(std::abs(mm) <= std::numeric_limits<std::int32_t>::max())) return std::nullopt;
  return static_cast<std::int32_t>(mm);
}

WirePoint ToWire(const Point& point) {
  const auto x = Millimetres(point.x_m);
  const auto y = Millimetres(point.y_m);
  const auto z = Millimetres(point.z_m);
  if (!x || !y || !z) return {};
  return {.x_mm = *x, .y_mm = *y, .z_mm = *z, .reflectivity = point.reflectivity};
}

}  // namespace

FloatPackage ConvertFloatPackage(ByteView package) {
  FloatPackage converted;
  std::array<WirePoint, kFloatPoints> wire{};
  for (std::size_t i = 0; i < kFloatPoints; ++i) {
    const std::size_t at = kPackageHeadBytes + i * kFloatPointBytes;
    converted.points[i] = {.x_m = Load<float>(package, at),
                           .y_m = Load<float>(package, at + 4),
                           .z_m = Load<float>(package, at + 8),
                           .reflectivity = Load<std::uint8_t>(package, at + 12)};
    wire[i] = ToWire(converted.points[i]);
  }
  const ByteView head = package.subspan(1);
  converted.packet =
      core::livox::PackPacket({.slot_id = Load<std::uint8_t>(head, 1),
                               .lidar_id = Load<std::uint8_t>(head, 2),
                               .status_code = Load<std::uint32_t>(head, 4),
                               .timestamp_type = static_cast<core::livox::TimestampType>(head[8]),
                               .data_type = core::livox::DataType::kCartesian,
                               .timestamp = Load<std::uint64_t>(head, 10)},
                              wire);
  return converted;
}

}  // namespace clearway::io::lvx
