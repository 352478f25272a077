// SPDX-License-Identifier: BSD-3-Clause
#include "tools/convert/packet_packer.hpp"

#include <limits>

#include <gtest/gtest.h>

namespace clearway::convert {
namespace {

using core::livox::Bytes;
using core::livox::ParsePacket;
using core::livox::Point;

CollectedScan ScanAt(const std::vector<std::int32_t>& times_us) {
  CollectedScan scan;
  scan.utime_start = 1'000'000;
  scan.utime_end = 1'100'000;
  for (const std::int32_t time_us : times_us) scan.cloud_sensor.Add({1, 2, 3}, 4, 5, time_us);
  return scan;
}

std::vector<Bytes> PackAll(PacketPacker& packer, const CollectedScan& scan) {
  std::vector<Bytes> packets = packer.Add(scan);
  for (Bytes& packet : packer.Finish()) packets.push_back(std::move(packet));
  return packets;
}

std::vector<std::size_t> ReturnsIn(const Bytes& packet) {
  const auto parsed = ParsePacket(packet).packet;
  std::vector<Point> points(parsed->num_points());
  core::livox::DecodePoints(*parsed, points);
  std::vector<std::size_t> returns;
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (points[i].is_return()) returns.push_back(i);
  }
  return returns;
}

TEST(PacketPacker, ChoosesTheLeastThatHoldsTheTimes) {
  EXPECT_EQ(PackingFor(ScanAt({})), Packing::kSingle);
  EXPECT_EQ(PackingFor(ScanAt({0, 10, 19, 29, 100})), Packing::kSingle);
  EXPECT_EQ(PackingFor(ScanAt({0, 0, 10, 20, 20})), Packing::kDual);
  EXPECT_EQ(PackingFor(ScanAt({0, 0, 0})), Packing::kDense);
  EXPECT_EQ(PackingFor(ScanAt({0, 5, 10})), Packing::kDense);
}

TEST(PacketPacker, PutsEachPointAtItsShot) {
  PacketPacker packer(Packing::kSingle);

  const auto packets = PackAll(packer, ScanAt({500, 510, 531, 1449, 1460}));

  ASSERT_EQ(packets.size(), 2U);
  EXPECT_EQ(ReturnsIn(packets[0]), (std::vector<std::size_t>{0, 1, 3, 95}));
  EXPECT_EQ(ReturnsIn(packets[1]), (std::vector<std::size_t>{0}));
  EXPECT_EQ(ParsePacket(packets[0]).packet->header.timestamp, 1'000'500'000U);
  EXPECT_EQ(ParsePacket(packets[1]).packet->header.timestamp, 1'001'460'000U);
}

TEST(PacketPacker, TwoPointsOfOneTimeAreTwoEchoesOfAShot) {
  PacketPacker packer(Packing::kDual);

  const auto packets = PackAll(packer, ScanAt({0, 0, 10, 30, 30}));

  ASSERT_EQ(packets.size(), 1U);
  EXPECT_EQ(ReturnsIn(packets[0]), (std::vector<std::size_t>{0, 1, 2, 6, 7}));
}

TEST(PacketPacker, FillsTheTimeWithoutReturnsOnlyWhereNothingWasLost) {
  CollectedScan scan = ScanAt({0, 5000});
  scan.zero_returns = 499;
  PacketPacker whole(Packing::kSingle);
  PacketPacker lossy(Packing::kSingle);

  EXPECT_EQ(PackAll(whole, scan).size(), 6U);
  scan.lost_packets = 1;
  EXPECT_EQ(PackAll(lossy, scan).size(), 2U);
}

TEST(PacketPacker, CountsWhatTheWireCannotSay) {
  CollectedScan scan = ScanAt({0});
  scan.cloud_sensor.Add({std::numeric_limits<float>::quiet_NaN(), 0, 0}, 0, 0, 10);
  scan.cloud_sensor.Add({std::numeric_limits<float>::infinity(), 0, 0}, 0, 0, 20);
  scan.cloud_sensor.Add({3e6F, 0, 0}, 0, 0, 30);
  scan.cloud_sensor.Add({0.0001F, 0, 0}, 0, 0, 40);
  PacketPacker packer(Packing::kSingle);

  const auto packets = PackAll(packer, scan);

  EXPECT_EQ(ReturnsIn(packets.at(0)), (std::vector<std::size_t>{0}));
  EXPECT_EQ(packer.num_unwritable(), 4);
  EXPECT_EQ(packer.num_points(), 1);
}

}  // namespace
}  // namespace clearway::convert
