// SPDX-License-Identifier: BSD-3-Clause
#include "common/core/livox/data_packet.hpp"

#include <array>
#include <cmath>
#include <limits>
#include <numbers>

#include <gtest/gtest.h>

#include "tests/unit/livox/protocol_maker.hpp"

namespace clearway::core::livox {
namespace {

std::vector<Point> Decode(ByteView bytes) {
  const ParsedPacket parsed = ParsePacket(bytes);
  EXPECT_EQ(parsed.defect, PacketDefect::kNone);
  std::vector<Point> points(parsed.packet->num_points());
  DecodePoints(*parsed.packet, points);
  return points;
}

DataHeader RandomHeader(std::mt19937& random, DataType type) {
  return {.slot_id = static_cast<std::uint8_t>(random()),
          .lidar_id = static_cast<std::uint8_t>(random()),
          .status_code = static_cast<std::uint32_t>(random()),
          .timestamp_type = static_cast<TimestampType>(test::Random(random, 6)),
          .data_type = type,
          .timestamp = std::uint64_t{random()} << 32U | random()};
}

// The CRC-32 of zlib, bit by bit.
std::uint32_t PlainCrc32(ByteView bytes) {
  std::uint32_t crc = ~0U;
  for (const std::byte byte : bytes) {
    crc ^= static_cast<std::uint32_t>(byte);
    for (int bit = 0; bit < 8; ++bit) crc = (crc >> 1U) ^ ((crc & 1U) != 0 ? 0xEDB88320U : 0U);
  }
  return ~crc;
}

class DataPacketTypeTest : public testing::TestWithParam<std::uint8_t> {
 protected:
  DataType type_ = static_cast<DataType>(GetParam());
  DataLayout layout_ = LayoutOf(type_);
};

TEST_P(DataPacketTypeTest, HeaderComesBackAndPackingIsStable) {
  std::mt19937 random(6U + GetParam());
  for (std::size_t shots = 1; shots <= layout_.shots_in_packet; ++shots) {
    const DataHeader header = RandomHeader(random, type_);
    const auto points = test::RandomPoints(random, shots * layout_.echoes);

    const Bytes bytes = PackPacket(header, points);
    const ParsedPacket parsed = ParsePacket(bytes);

    ASSERT_EQ(parsed.defect, PacketDefect::kNone);
    EXPECT_EQ(parsed.packet->header, header);
    EXPECT_EQ(parsed.packet->shots, shots);
    EXPECT_EQ(bytes.size(), kDataHeaderBytes + shots * layout_.shot_bytes);
  }
}

TEST_P(DataPacketTypeTest, PointsComeBackToTheRoundingOfTheWire) {
  std::mt19937 random(60U + GetParam());
  const auto points = test::RandomPoints(random, layout_.shots_in_packet * layout_.echoes);

  const std::vector<Point> back = Decode(PackPacket({.data_type = type_}, points));

  ASSERT_EQ(back.size(), points.size());
  for (std::size_t i = 0; i < points.size(); ++i) {
    SCOPED_TRACE(i);
    // Half a millimetre of depth, half a hundredth of a degree in each of two angles, and floats.
    const double depth_m = std::hypot(points[i].x_mm, points[i].y_mm, points[i].z_mm) / 1000.0;
    const double tolerance_m =
        layout_.is_spherical ? 0.0006 + depth_m * 1.5 * 0.005 * std::numbers::pi / 180.0 : 0.0;
    if (layout_.is_spherical && layout_.echoes == 2) {
      // Both echoes share the direction of the first: only the depth of the second is its own.
      const double back_m = std::hypot(back[i].x_m, back[i].y_m, back[i].z_m);
      EXPECT_NEAR(back_m, depth_m, 0.0006 + 1e-6 * depth_m);
    } else if (layout_.is_spherical) {
      EXPECT_NEAR(back[i].x_m, points[i].x_mm / 1000.0, tolerance_m);
      EXPECT_NEAR(back[i].y_m, points[i].y_mm / 1000.0, tolerance_m);
      EXPECT_NEAR(back[i].z_m, points[i].z_mm / 1000.0, tolerance_m);
    } else {
      EXPECT_EQ(back[i].x_m, static_cast<float>(points[i].x_mm) / 1000.0F);
      EXPECT_EQ(back[i].y_m, static_cast<float>(points[i].y_mm) / 1000.0F);
      EXPECT_EQ(back[i].z_m, static_cast<float>(points[i].z_mm) / 1000.0F);
      EXPECT_EQ(std::lround(1000.0 * back[i].x_m), points[i].x_mm) << "the millimetre survives";
    }
    EXPECT_EQ(back[i].reflectivity, points[i].reflectivity);
    EXPECT_EQ(back[i].tag, layout_.has_tag ? points[i].tag : 0);
    EXPECT_EQ(back[i].is_return(),
              points[i].x_mm != 0 || points[i].y_mm != 0 || points[i].z_mm != 0);
  }
}

TEST_P(DataPacketTypeTest, IsRefusedUnlessItHoldsWholeShots) {
  std::mt19937 random(7);
  const auto points = test::RandomPoints(random, layout_.shots_in_packet * layout_.echoes);
  Bytes bytes = PackPacket({.data_type = type_}, points);
  bytes.resize(bytes.size() + 2 * layout_.shot_bytes);
  for (std::size_t size = 0; size <= bytes.size(); ++size) {
    const ParsedPacket parsed = ParsePacket(ByteView(bytes).first(size));

    if (size < kDataHeaderBytes) {
      EXPECT_EQ(parsed.defect, PacketDefect::kTooShort) << size;
      continue;
    }
    const std::size_t payload = size - kDataHeaderBytes;
    const bool is_good = payload > 0 && payload % layout_.shot_bytes == 0 &&
                         payload / layout_.shot_bytes <= layout_.shots_in_packet;
    EXPECT_EQ(parsed.defect, is_good ? PacketDefect::kNone : PacketDefect::kSize) << size;
    EXPECT_EQ(parsed.packet.has_value(), is_good) << size;
  }
}

INSTANTIATE_TEST_SUITE_P(AllTypes, DataPacketTypeTest, testing::Values(0, 1, 2, 3, 4, 5));

TEST(DataPacket, FullPacketsHaveTheSizesOfTheWire) {
  constexpr std::array<std::size_t, 6> kBytes{1318, 918, 1362, 978, 1362, 786};
  for (std::uint8_t type = 0; type < kBytes.size(); ++type) {
    const auto layout = LayoutOf(type);
    ASSERT_TRUE(layout);
    EXPECT_EQ(kDataHeaderBytes + layout->shots_in_packet * layout->shot_bytes, kBytes[type]);
    EXPECT_LE(kBytes[type], kMaxDataPacketBytes);
  }
}

TEST(DataPacket, TheExampleOfThreePointsIsPackedByteForByte) {
  std::vector<WirePoint> points(96);
  points[0] = {.x_mm = 1000, .y_mm = -500, .z_mm = 250, .reflectivity = 60, .tag = 0x10};
  points[2] = {.x_mm = 25000, .y_mm = 10000, .z_mm = 2000, .reflectivity = 255, .tag = 0x15};

  const Bytes bytes = PackPacket({.timestamp = 1'234'567'890'123}, points);

  ASSERT_EQ(bytes.size(), 1362U);
  EXPECT_EQ(PlainCrc32(bytes), 0x3B004923U);
  EXPECT_EQ(Bytes(bytes.begin(), bytes.begin() + 32),
            test::FromHex("05 01 01 00 00 00 00 00 00 02 cb 04 fb 71 1f 01 00 00 "
                          "e8 03 00 00 0c fe ff ff fa 00 00 00 3c 10"));
  const std::vector<Point> back = Decode(bytes);
  EXPECT_EQ(back[0], (Point{1.0F, -0.5F, 0.25F, 60, 0x10}));
  EXPECT_FALSE(back[1].is_return());
  EXPECT_EQ(back[2], (Point{25.0F, 10.0F, 2.0F, 255, 0x15}));
}

// x = r sin(theta) cos(phi), y = r sin(theta) sin(phi), z = r cos(theta), straight from bytes.
TEST(DataPacket, SphericalCoordinatesFollowTheFormula) {
  for (const unsigned theta : {0U, 1U, 4500U, 9000U, 12345U, 18000U}) {
    for (const unsigned phi : {0U, 1U, 9000U, 17999U, 27000U, 35999U, 36000U}) {
      Bytes bytes = test::FromHex("05 01 01 00 00 00 00 00 00 03 00 00 00 00 00 00 00 00");
      Append(bytes, std::uint32_t{87'654});
      Append(bytes, static_cast<std::uint16_t>(theta));
      Append(bytes, static_cast<std::uint16_t>(phi));
      Append(bytes, std::uint8_t{12});
      Append(bytes, std::uint8_t{34});

      const Point point = Decode(bytes).front();

      const double t = theta * std::numbers::pi / 18000.0;
      const double p = phi * std::numbers::pi / 18000.0;
      constexpr double kFloat_m = 5e-6;  // Half a unit in the last place at 87 m.
      EXPECT_NEAR(point.x_m, 87.654 * std::sin(t) * std::cos(p), kFloat_m);
      EXPECT_NEAR(point.y_m, 87.654 * std::sin(t) * std::sin(p), kFloat_m);
      EXPECT_NEAR(point.z_m, 87.654 * std::cos(t), kFloat_m);
      EXPECT_EQ(point.reflectivity, 12);
      EXPECT_EQ(point.tag, 34);
    }
  }
}

TEST(DataPacket, DualPacketsAlternateBetweenTheEchoes) {
  std::vector<WirePoint> points;
  for (std::int32_t shot = 0; shot < 48; ++shot) {
    points.push_back({.x_mm = 1000 + shot, .reflectivity = 1, .tag = 1});
    points.push_back({.x_mm = 2000 + shot, .reflectivity = 2, .tag = 2});
  }
  for (const DataType type : {DataType::kDualCartesian, DataType::kDualSpherical}) {
    const std::vector<Point> back = Decode(PackPacket({.data_type = type}, points));

    ASSERT_EQ(back.size(), 96U);
    for (std::size_t i = 0; i < back.size(); ++i) {
      EXPECT_NEAR(back[i].x_m, points[i].x_mm / 1000.0, 1e-6) << i;
      EXPECT_EQ(back[i].tag, points[i].tag) << i;
    }
  }
}

TEST(DataPacket, ASecondEchoAloneKeepsItsDirection) {
  const std::vector<WirePoint> points{{}, {.x_mm = 3000, .y_mm = 4000, .z_mm = 0}};

  const auto back = Decode(PackPacket({.data_type = DataType::kDualSpherical}, points));

  EXPECT_FALSE(back[0].is_return());
  EXPECT_NEAR(back[1].x_m, 3.0, 0.001);
  EXPECT_NEAR(back[1].y_m, 4.0, 0.001);
}

TEST(DataPacket, TheFarthestNumbersOfTheWireAreDecoded) {
  constexpr std::int32_t kLeast = std::numeric_limits<std::int32_t>::min();
  constexpr std::int32_t kMost = std::numeric_limits<std::int32_t>::max();
  const std::vector<WirePoint> points{{.x_mm = kLeast, .y_mm = kMost, .z_mm = kLeast}};

  const Point back = Decode(PackPacket({}, points)).front();

  EXPECT_FLOAT_EQ(back.x_m, -2147483.648F);
  EXPECT_FLOAT_EQ(back.y_m, 2147483.647F);
  // Spherical: the depth of such a point is still a 32-bit number.
  EXPECT_TRUE(
      Decode(PackPacket({.data_type = DataType::kExtendedSpherical}, points)).front().is_return());
}

TEST(DataPacket, OfAnotherKindIsRefusedWithTheReason) {
  const Bytes good = PackPacket({}, std::vector<WirePoint>(96));
  const auto with = [&good](std::size_t at, unsigned value) {
    Bytes bytes = good;
    bytes[at] = static_cast<std::byte>(value);
    return ParsePacket(bytes).defect;
  };

  for (const unsigned version : {0U, 4U, 6U, 255U}) {
    EXPECT_EQ(with(0, version), PacketDefect::kVersion);
  }
  for (unsigned type = 6; type < 256; ++type) {
    EXPECT_EQ(with(9, type), PacketDefect::kForeignType) << type;
  }
  for (unsigned type = 6; type < 256; ++type) {
    EXPECT_EQ(with(8, type), PacketDefect::kTimestampType) << type;
  }
  EXPECT_EQ(with(9, 0), PacketDefect::kSize);
  EXPECT_EQ(with(3, 77), PacketDefect::kNone) << "the reserved byte means nothing";
}

}  // namespace
}  // namespace clearway::core::livox
