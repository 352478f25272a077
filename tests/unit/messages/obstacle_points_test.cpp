// SPDX-License-Identifier: BSD-3-Clause
#include "common/messages/obstacle_points.hpp"

#include <tuple>

#include <gtest/gtest.h>

#include "common/messages/encoding.hpp"
#include "tests/unit/messages/message_makers.hpp"

namespace clearway::messages {
namespace {

using test::SomePreprocessedScan;

class ObstacleSlicesTest : public testing::TestWithParam<std::tuple<std::size_t, std::size_t>> {};

TEST_P(ObstacleSlicesTest, HoldEveryPointOnceInOrderWithinTheLimit) {
  const auto [points, limit] = GetParam();
  const core::PreprocessedScan scan = SomePreprocessedScan(points);

  const auto slices = ToObstaclePoints(scan, 1234, limit);

  core::PointCloud together;
  for (std::size_t k = 0; k < slices.size(); ++k) {
    const auto travelled = Decode<obstacle_points_t>(Encode(slices[k]));
    ASSERT_TRUE(travelled.has_value());
    EXPECT_LE(Encode(slices[k]).size(), limit);
    EXPECT_EQ(travelled->slice_index, static_cast<std::int32_t>(k));
    EXPECT_EQ(travelled->slice_count, static_cast<std::int32_t>(slices.size()));
    const core::Slice slice = FromLcm(*travelled);
    EXPECT_TRUE(core::IsValid(slice));
    together.Append(slice.cloud_sensor);
  }
  EXPECT_EQ(together.x, scan.obstacles_vehicle.x);
  EXPECT_EQ(together.y, scan.obstacles_vehicle.y);
  EXPECT_EQ(together.z, scan.obstacles_vehicle.z);
  EXPECT_EQ(together.intensity, scan.obstacles_vehicle.intensity);
  EXPECT_EQ(together.tag, scan.flags);
}

INSTANTIATE_TEST_SUITE_P(
    ManySizes,
    ObstacleSlicesTest,
    testing::Combine(testing::Values(0, 1, 81, 82, 163, 4124, 4125, 20'000),
                     testing::Values(test::kLocalLimit, test::kRemoteLimit, std::size_t{1000})));

TEST(ObstaclePointsTest, AnEmptyScanIsOneEmptySliceWithItsStamps) {
  const core::PreprocessedScan scan = SomePreprocessedScan(0);

  const auto slices = ToObstaclePoints(scan, 0, test::kRemoteLimit);

  ASSERT_EQ(slices.size(), 1U);
  EXPECT_EQ(slices[0].n, 0);
  EXPECT_EQ(slices[0].slice_count, 1);
  EXPECT_EQ(slices[0].utime, scan.utime);
}

TEST(ObstaclePointsTest, EverySliceCarriesTheHeaderOfTheScan) {
  const auto slices = ToObstaclePoints(SomePreprocessedScan(500), 1234, test::kRemoteLimit);

  ASSERT_GT(slices.size(), 1U);
  for (const obstacle_points_t& slice : slices) {
    EXPECT_EQ(slice.utime, 1'700'000'000'100'000);
    EXPECT_EQ(slice.scan_id, 42);
    EXPECT_EQ(slice.scan_utime, 1'700'000'000'000'000);
    EXPECT_EQ(slice.scan_state, obstacle_points_t::SCAN_INCOMPLETE);
    EXPECT_EQ(slice.missing_slices, 2);
    EXPECT_EQ(slice.motion_state, obstacle_points_t::MOTION_DESKEWED);
    EXPECT_EQ(slice.map_state, obstacle_points_t::MAP_OFF);
    EXPECT_EQ(slice.map_epoch, 0);
    EXPECT_EQ(slice.points_in, 9'700);
    EXPECT_EQ(slice.points_masked, 700);
    EXPECT_EQ(slice.points_voxel, 5'000);
    EXPECT_EQ(slice.points_floor, 2'000);
    EXPECT_EQ(slice.points_map, 2'000);
    EXPECT_EQ(slice.processing_us, 1234);
  }
}

TEST(ObstaclePointsTest, AWholeScanSaysSo) {
  core::PreprocessedScan scan = SomePreprocessedScan(1);
  scan.complete = true;
  scan.missing_slices = 0;

  const auto slices = ToObstaclePoints(scan, 0, test::kRemoteLimit);

  EXPECT_EQ(slices[0].scan_state, obstacle_points_t::SCAN_COMPLETE);
}

TEST(ObstaclePointsTest, StatesOfCoreAreThoseOfTheWire) {
  using core::DeskewState;
  using core::FloorState;
  const std::vector<std::pair<DeskewState, std::int8_t>> motion = {
      {DeskewState::kStationary, obstacle_points_t::MOTION_STATIONARY},
      {DeskewState::kDeskewed, obstacle_points_t::MOTION_DESKEWED},
      {DeskewState::kNoOdometry, obstacle_points_t::MOTION_NO_ODOMETRY}};
  const std::vector<std::tuple<FloorState, std::int8_t, std::int8_t>> floor = {
      {FloorState::kFound, obstacle_points_t::FLOOR_FOUND, floor_t::STATE_FOUND},
      {FloorState::kHeld, obstacle_points_t::FLOOR_HELD, floor_t::STATE_HELD},
      {FloorState::kConfigured, obstacle_points_t::FLOOR_CONFIGURED, floor_t::STATE_CONFIGURED}};

  core::PreprocessedScan scan = SomePreprocessedScan(1);
  for (const auto& [state, wire] : motion) {
    scan.deskew = state;
    EXPECT_EQ(ToObstaclePoints(scan, 0, 1400)[0].motion_state, wire);
  }
  for (const auto& [state, wire, floor_wire] : floor) {
    scan.floor.state = state;
    EXPECT_EQ(ToObstaclePoints(scan, 0, 1400)[0].floor_state, wire);
    EXPECT_EQ(ToFloor(scan).state, floor_wire);
  }
  EXPECT_EQ(core::kFlagBelowFloor, obstacle_points_t::POINT_BELOW_FLOOR);
}

TEST(ObstaclePointsTest, ASliceTakesItsNumberingFromTheMessage) {
  obstacle_points_t message = ToObstaclePoints(SomePreprocessedScan(3), 0, 1400)[0];
  message.session = 8;
  message.sequence = 9;

  const core::Slice slice = FromLcm(message);

  EXPECT_EQ(slice.sensor, 0);
  EXPECT_EQ(slice.session, 8);
  EXPECT_EQ(slice.sequence, 9);
  EXPECT_EQ(slice.scan_id, 42);
  EXPECT_EQ(slice.scan_end_utime, message.utime);
  EXPECT_EQ(slice.cloud_sensor.time_offset_us, std::vector<std::int32_t>(3, 0));
}

core::PreprocessedScan ScanWithFloor(core::FloorState state) {
  core::PreprocessedScan scan = SomePreprocessedScan(1);
  scan.floor.state = state;
  scan.floor.age_us = 77;
  scan.floor.fit.plane_vehicle.normal = {0.0F, 0.6F, 0.8F};
  scan.floor.fit.plane_vehicle.offset_m = 0.25F;
  scan.floor.fit.tilt_rad = 0.125;
  scan.floor.fit.num_inliers = 11;
  scan.floor.fit.num_candidates = 22;
  scan.floor.fit.rms_m = 0.5;
  return scan;
}

TEST(FloorMessageTest, CarriesThePlaneAndHowGoodItIs) {
  const floor_t message = ToFloor(ScanWithFloor(core::FloorState::kHeld));

  EXPECT_EQ(message.utime, 1'700'000'000'100'000);
  EXPECT_EQ(message.scan_id, 42);
  EXPECT_EQ(message.normal[0], 0.0);
  EXPECT_EQ(message.normal[1], static_cast<double>(0.6F));
  EXPECT_EQ(message.normal[2], static_cast<double>(0.8F));
  EXPECT_EQ(message.offset_m, 0.25);
  EXPECT_EQ(message.tilt_rad, 0.125);
  EXPECT_EQ(message.age_us, 77);
  EXPECT_EQ(message.inliers, 11);
  EXPECT_EQ(message.candidates, 22);
  EXPECT_EQ(message.rms_m, 0.5);
  EXPECT_EQ(message.below_points, 100);
}

TEST(FloorMessageTest, AConfiguredFloorHasNoMeasureOfFit) {
  EXPECT_EQ(ToFloor(ScanWithFloor(core::FloorState::kConfigured)).rms_m, -1.0);
}

}  // namespace
}  // namespace clearway::messages
