// SPDX-License-Identifier: BSD-3-Clause
#include "common/messages/lidar_points.hpp"

#include <string>

#include <gtest/gtest.h>

#include "common/messages/encoding.hpp"
#include "tests/unit/messages/message_makers.hpp"

namespace clearway::messages {
namespace {

core::Slice SomeSlice(std::size_t points) {
  core::Slice slice;
  slice.scan_id = 17;
  slice.scan_utime = 1'700'000'000'000'000;
  slice.scan_end_utime = slice.scan_utime + 100'000;
  slice.slice_index = 3;
  slice.slice_count = 10;
  slice.shots = static_cast<std::int64_t>(points) + 5;
  slice.zero_returns = 5;
  slice.cloud_sensor = test::RandomCloud(points, 1);
  return slice;
}

void ExpectSameCloud(const core::PointCloud& actual, const core::PointCloud& expected) {
  EXPECT_EQ(actual.x, expected.x);
  EXPECT_EQ(actual.y, expected.y);
  EXPECT_EQ(actual.z, expected.z);
  EXPECT_EQ(actual.intensity, expected.intensity);
  EXPECT_EQ(actual.tag, expected.tag);
  EXPECT_EQ(actual.time_offset_us, expected.time_offset_us);
}

TEST(LidarPointsTest, ASliceComesBackAsItWasSent) {
  const core::Slice sent = SomeSlice(100);
  lidar_points_t message = ToLcm(sent, "front");
  message.session = 5;
  message.sequence = 6;

  const auto travelled = Decode<lidar_points_t>(Encode(message));
  ASSERT_TRUE(travelled.has_value());
  const core::Slice received = FromLcm(*travelled, 2);

  EXPECT_EQ(received.sensor, 2);
  EXPECT_EQ(received.session, 5);
  EXPECT_EQ(received.sequence, 6);
  EXPECT_EQ(received.scan_id, sent.scan_id);
  EXPECT_EQ(received.scan_utime, sent.scan_utime);
  EXPECT_EQ(received.scan_end_utime, sent.scan_end_utime);
  EXPECT_EQ(received.slice_index, sent.slice_index);
  EXPECT_EQ(received.slice_count, sent.slice_count);
  EXPECT_EQ(received.shots, sent.shots);
  EXPECT_EQ(received.zero_returns, sent.zero_returns);
  ExpectSameCloud(received.cloud_sensor, sent.cloud_sensor);
  EXPECT_TRUE(core::IsValid(received));
}

TEST(LidarPointsTest, ASliceIsStampedWithTheStartOfItsShareOfTheScan) {
  const core::Slice slice = SomeSlice(1);

  const lidar_points_t message = ToLcm(slice, "front");

  EXPECT_EQ(message.utime, slice.scan_utime + 30'000);
  EXPECT_EQ(message.sensor, "front");
  EXPECT_EQ(message.n, 1);
  EXPECT_EQ(message.time_source, lidar_points_t::TIME_RECORDED);
  EXPECT_EQ(message.return_mode, lidar_points_t::RETURN_UNKNOWN);
  EXPECT_EQ(message.lost_packets, 0);
}

TEST(LidarPointsTest, AnEmptySliceTravels) {
  const auto travelled = Decode<lidar_points_t>(Encode(ToLcm(SomeSlice(0), "front")));

  ASSERT_TRUE(travelled.has_value());
  EXPECT_TRUE(FromLcm(*travelled, 0).cloud_sensor.empty());
  EXPECT_EQ(FromLcm(*travelled, 0).shots, 5);
}

TEST(LidarPointsTest, AMessageWhoseArraysDoNotMatchItsCountsIsRefusedByIsValid) {
  lidar_points_t message = ToLcm(SomeSlice(4), "front");
  message.tag.pop_back();

  EXPECT_FALSE(core::IsValid(FromLcm(message, 0)));
}

class LidarPointsSizeTest : public testing::TestWithParam<std::size_t> {};

// The rule by which a sender cuts its slices.
TEST_P(LidarPointsSizeTest, ASliceOfAsManyPointsAsTheConstantsAllowStaysWithinTheLimit) {
  const std::size_t points = (GetParam() - kLidarHeaderBytes) / kLidarBytesPerPoint;
  const std::string long_name(100, 'n');

  const auto bytes = Encode(ToLcm(SomeSlice(points), long_name));

  EXPECT_LE(bytes.size(), GetParam());
  // And uses the room that it has: no more than the header's reserve stays free.
  EXPECT_GT(bytes.size() + kLidarHeaderBytes, GetParam());
}

INSTANTIATE_TEST_SUITE_P(BothBuses,
                         LidarPointsSizeTest,
                         testing::Values(test::kLocalLimit, test::kRemoteLimit));

}  // namespace
}  // namespace clearway::messages
