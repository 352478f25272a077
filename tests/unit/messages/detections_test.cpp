// SPDX-License-Identifier: BSD-3-Clause
#include "common/messages/detections.hpp"

#include <random>
#include <tuple>

#include <gtest/gtest.h>

#include "common/messages/encoding.hpp"
#include "tests/unit/messages/message_makers.hpp"

namespace clearway::messages {
namespace {

obstacle_points_t SomeSource() {
  obstacle_points_t source{};
  source.utime = 1'700'000'000'100'000;
  source.scan_id = 42;
  source.scan_utime = 1'700'000'000'000'000;
  source.scan_state = obstacle_points_t::SCAN_INCOMPLETE;
  source.floor_state = obstacle_points_t::FLOOR_HELD;
  source.map_state = obstacle_points_t::MAP_MISSING;
  source.map_epoch = 3;
  source.n = 1000;
  return source;
}

core::Detection DetectionWithHull(std::size_t vertices) {
  core::Detection detection;
  detection.num_points = 9;
  for (std::size_t i = 0; i < vertices; ++i) {
    const auto value = static_cast<float>(i);
    detection.hull.emplace_back(value, -value);
  }
  return detection;
}

std::vector<detection_t> Detections(std::size_t count, std::size_t max_vertices) {
  std::mt19937 random(11);
  std::vector<detection_t> detections;
  for (std::size_t i = 0; i < count; ++i) {
    const core::Detection detection = DetectionWithHull(random() % (max_vertices + 1));
    detections.push_back(ToLcm(detection, static_cast<std::int32_t>(i), 0));
  }
  return detections;
}

class DetectionSlicesTest
    : public testing::TestWithParam<std::tuple<std::size_t, std::size_t, std::size_t>> {};

TEST_P(DetectionSlicesTest, HoldEveryDetectionOnceInOrderWithinTheLimit) {
  const auto [count, max_vertices, limit] = GetParam();
  const auto detections = Detections(count, max_vertices);

  const auto slices = ToDetections(SomeSource(), detections, limit);

  std::size_t next = 0;
  for (std::size_t k = 0; k < slices.size(); ++k) {
    const auto bytes = Encode(slices[k]);
    ASSERT_TRUE(Decode<detections_t>(bytes).has_value());
    EXPECT_EQ(slices[k].slice_index, static_cast<std::int32_t>(k));
    EXPECT_EQ(slices[k].slice_count, static_cast<std::int32_t>(slices.size()));
    EXPECT_EQ(slices[k].n, static_cast<std::int32_t>(slices[k].detections.size()));
    EXPECT_TRUE(bytes.size() <= limit || slices[k].n == 1) << bytes.size();
    for (const detection_t& detection : slices[k].detections) {
      ASSERT_LT(next, detections.size());
      EXPECT_EQ(Encode(detection), Encode(detections[next++]));
    }
  }
  EXPECT_EQ(next, detections.size());
}

INSTANTIATE_TEST_SUITE_P(FewAndManySmallAndLargeHulls,
                         DetectionSlicesTest,
                         testing::Combine(testing::Values(0, 1, 7, 100, 1000),
                                          testing::Values(0, 12, 200),
                                          testing::Values(test::kLocalLimit, test::kRemoteLimit)));

TEST(DetectionsTest, AnEmptyScanIsOneEmptySlice) {
  const auto slices = ToDetections(SomeSource(), {}, test::kRemoteLimit);

  ASSERT_EQ(slices.size(), 1U);
  EXPECT_EQ(slices[0].n, 0);
  EXPECT_EQ(slices[0].slice_count, 1);
  EXPECT_EQ(slices[0].utime, SomeSource().utime);
}

TEST(DetectionsTest, ADetectionBeyondTheLimitGoesOutAlone) {
  const std::vector<detection_t> detections = {ToLcm(DetectionWithHull(4), 0, 0),
                                               ToLcm(DetectionWithHull(1000), 1, 0),
                                               ToLcm(DetectionWithHull(4), 2, 0)};

  const auto slices = ToDetections(SomeSource(), detections, test::kRemoteLimit);

  ASSERT_EQ(slices.size(), 3U);
  for (std::size_t k = 0; k < 3; ++k) {
    ASSERT_EQ(slices[k].n, 1);
    EXPECT_EQ(slices[k].detections[0].id, static_cast<std::int32_t>(k));
  }
  EXPECT_EQ(slices[1].detections[0].hull_n, 1000);
}

TEST(DetectionsTest, EverySliceCarriesTheHeaderOfItsPoints) {
  const auto slices = ToDetections(SomeSource(), Detections(50, 12), test::kRemoteLimit);

  ASSERT_GT(slices.size(), 1U);
  for (const detections_t& slice : slices) {
    EXPECT_EQ(slice.utime, SomeSource().utime);
    EXPECT_EQ(slice.scan_id, 42);
    EXPECT_EQ(slice.scan_utime, SomeSource().scan_utime);
    EXPECT_EQ(slice.scan_state, detections_t::SCAN_INCOMPLETE);
    EXPECT_EQ(slice.floor_state, obstacle_points_t::FLOOR_HELD);
    EXPECT_EQ(slice.map_state, obstacle_points_t::MAP_MISSING);
    EXPECT_EQ(slice.map_epoch, 3);
  }
}

TEST(DetectionsTest, ADetectionKeepsItsGeometry) {
  core::Detection detection = DetectionWithHull(3);
  detection.centroid = {1.0F, 2.0F, 3.0F};
  detection.rectangle = {
      .center = {4.0F, 5.0F}, .length_m = 6.0F, .width_m = 0.5F, .yaw_rad = 0.7F};
  detection.z_min_m = -0.1F;
  detection.z_max_m = 1.8F;
  detection.nearest = {0.25F, 0.75F};

  const detection_t message = ToLcm(detection, 5, 2);

  EXPECT_EQ(message.id, 5);
  EXPECT_EQ(message.points, 9);
  EXPECT_EQ(message.points_below_floor, 2);
  EXPECT_EQ(message.centroid[0], 1.0F);
  EXPECT_EQ(message.centroid[1], 2.0F);
  EXPECT_EQ(message.centroid[2], 3.0F);
  EXPECT_EQ(message.nearest[0], 0.25F);
  EXPECT_EQ(message.nearest[1], 0.75F);
  EXPECT_EQ(message.z_min, -0.1F);
  EXPECT_EQ(message.z_max, 1.8F);
  EXPECT_EQ(message.center[0], 4.0F);
  EXPECT_EQ(message.center[1], 5.0F);
  EXPECT_EQ(message.length_m, 6.0F);
  EXPECT_EQ(message.width_m, 0.5F);
  EXPECT_EQ(message.yaw_rad, 0.7F);
  EXPECT_EQ(message.hull_n, 3);
  EXPECT_EQ(message.hull_x, (std::vector<float>{0.0F, 1.0F, 2.0F}));
  EXPECT_EQ(message.hull_y, (std::vector<float>{0.0F, -1.0F, -2.0F}));
}

TEST(DetectionsTest, ADetectionComesBackAsItWentOut) {
  for (const std::size_t vertices : {0U, 1U, 3U, 200U}) {
    core::Detection detection = DetectionWithHull(vertices);
    detection.num_points = 1234;
    detection.centroid = {1.0F, -2.0F, 3.0F};
    detection.nearest = {0.25F, -0.75F};
    detection.z_min_m = -0.1F;
    detection.z_max_m = 1.8F;
    detection.rectangle = {
        .center = {4.0F, -5.0F}, .length_m = 6.0F, .width_m = 0.5F, .yaw_rad = -0.7F};
    const auto bytes = Encode(ToLcm(detection, 5, 2));

    const core::Detection back = FromLcm(Decode<detection_t>(bytes).value());

    EXPECT_EQ(back.num_points, detection.num_points);
    EXPECT_EQ(back.centroid, detection.centroid);
    EXPECT_EQ(back.nearest, detection.nearest);
    EXPECT_EQ(back.z_min_m, detection.z_min_m);
    EXPECT_EQ(back.z_max_m, detection.z_max_m);
    EXPECT_EQ(back.rectangle.center, detection.rectangle.center);
    EXPECT_EQ(back.rectangle.length_m, detection.rectangle.length_m);
    EXPECT_EQ(back.rectangle.width_m, detection.rectangle.width_m);
    EXPECT_EQ(back.rectangle.yaw_rad, detection.rectangle.yaw_rad);
    EXPECT_EQ(back.hull, detection.hull);
  }
}

TEST(DetectionsTest, ANegativeNumberOfPointsIsReadAsNone) {
  detection_t message = ToLcm(DetectionWithHull(1), 0, 0);
  message.points = -1;

  EXPECT_EQ(FromLcm(message).num_points, 0U);
}

TEST(DetectionsTest, WhatIsNotKnownIsMarkedSo) {
  const detection_t message = ToLcm(DetectionWithHull(1), 0, 0);

  EXPECT_EQ(message.track_id, 0);
  EXPECT_EQ(message.yaw_confidence, -1.0F);
  EXPECT_EQ(message.velocity_variance, -1.0F);
  EXPECT_EQ(message.kind, detection_t::KIND_UNKNOWN);
}

}  // namespace
}  // namespace clearway::messages
