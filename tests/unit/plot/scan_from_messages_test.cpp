// SPDX-License-Identifier: BSD-3-Clause
#include "tools/plot/scan_from_messages.hpp"

#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace clearway::plot {
namespace {

using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::Not;
using testing::StartsWith;

constexpr std::int64_t kStart = 1'000'000;
constexpr std::int64_t kEnd = 1'100'000;

// One sensor, half a metre above the origin.
ScanContext Context() {
  ScanContext context;
  context.title = "test";
  context.vehicle.sensors.front() = {.name = "front", .x_m = 0.0, .z_m = 0.5};
  return context;
}

template <typename Message>
void SetPoints(const std::vector<Eigen::Vector3f>& points, Message& message) {
  message.n = static_cast<std::int32_t>(points.size());
  for (const Eigen::Vector3f& p : points) {
    message.x.push_back(p.x());
    message.y.push_back(p.y());
    message.z.push_back(p.z());
  }
}

lidar_points_t Raw(const std::vector<Eigen::Vector3f>& points) {
  lidar_points_t message{};
  message.sensor = "front";
  message.scan_id = 7;
  message.scan_utime = kStart;
  message.scan_end_utime = kEnd;
  message.slice_count = 1;
  SetPoints(points, message);
  return message;
}

obstacle_points_t Obstacles(std::int8_t map_state) {
  obstacle_points_t message{};
  message.utime = kEnd;
  message.scan_utime = kStart;
  message.scan_id = 7;
  message.slice_count = 1;
  message.map_state = map_state;
  SetPoints({{3.0F, 0.0F, 0.5F}, {2.0F, 0.0F, -0.2F}}, message);
  message.flags = {0, obstacle_points_t::POINT_BELOW_FLOOR};
  return message;
}

removed_points_t Removed() {
  removed_points_t message{};
  message.utime = kEnd;
  message.scan_id = 7;
  message.slice_count = 1;
  SetPoints({{1.0F, 0.0F, 0.0F}, {2.0F, 0.0F, 1.0F}, {3.0F, 0.0F, 2.0F}, {4.0F, 0.0F, 0.0F}},
            message);
  message.reason = {removed_points_t::REASON_FLOOR,
                    removed_points_t::REASON_MAP,
                    removed_points_t::REASON_OUTLIER,
                    removed_points_t::REASON_FLOOR};
  return message;
}

floor_t Floor() {
  floor_t message{};
  message.utime = kEnd;
  message.scan_id = 7;
  message.normal[2] = 1.0;
  return message;
}

TEST(MakePicture, PutsRemovedPointsIntoTheLayersOfTheirReasons) {
  ScanMessages scan;
  scan.Add(Raw({{0.0F, 0.0F, -0.5F}}));
  scan.Add(Removed());

  const ScanPicture picture = MakePicture(scan, Context());

  EXPECT_THAT(picture.floor_points,
              ElementsAre(Eigen::Vector3f(1.0F, 0.0F, 0.0F), Eigen::Vector3f(4.0F, 0.0F, 0.0F)));
  EXPECT_THAT(picture.map_points, ElementsAre(Eigen::Vector3f(2.0F, 0.0F, 1.0F)));
  EXPECT_THAT(picture.outlier_points, ElementsAre(Eigen::Vector3f(3.0F, 0.0F, 2.0F)));
}

TEST(MakePicture, BringsRawPointsToTheVehicleAndFindsTheFloorAmongThem) {
  ScanMessages scan;
  scan.Add(Raw({{1.0F, 2.0F, -0.5F}, {1.0F, 2.0F, 1.0F}}));
  scan.Add(Floor());

  const ScanPicture picture = MakePicture(scan, Context());

  EXPECT_THAT(picture.raw_points,
              ElementsAre(Eigen::Vector3f(1.0F, 2.0F, 0.0F), Eigen::Vector3f(1.0F, 2.0F, 1.5F)));
  EXPECT_THAT(picture.floor_points, ElementsAre(Eigen::Vector3f(1.0F, 2.0F, 0.0F)));
}

TEST(MakePicture, TellsHolesFromOtherObstacles) {
  ScanMessages scan;
  scan.Add(Obstacles(obstacle_points_t::MAP_OFF));

  const ScanPicture picture = MakePicture(scan, Context());

  EXPECT_THAT(picture.obstacle_points, ElementsAre(Eigen::Vector3f(3.0F, 0.0F, 0.5F)));
  EXPECT_THAT(picture.below_floor_points, ElementsAre(Eigen::Vector3f(2.0F, 0.0F, -0.2F)));
}

TEST(MakePicture, NamesAllThatIsMissingAndGuessesNothing) {
  ScanMessages scan;
  scan.Add(Raw({{1.0F, 2.0F, -0.5F}}));

  const ScanPicture picture = MakePicture(scan, Context());

  EXPECT_TRUE(picture.floor_points.empty());  // Without FLOOR no plane is known.
  EXPECT_TRUE(picture.corridors.empty());
  EXPECT_FALSE(picture.map.has_value());
  EXPECT_EQ(picture.missing,
            LayerSet({Layer::kFloor,
                      Layer::kRemovedByMap,
                      Layer::kOutliers,
                      Layer::kObstacles,
                      Layer::kDetections,
                      Layer::kMap,
                      Layer::kCorridor}));
  EXPECT_THAT(picture.text_lines,
              Contains("not heard of this scan: OBSTACLE_POINTS, REMOVED_POINTS, FLOOR, "
                       "DETECTIONS, MAP, POSE, DRIVE_PERMIT"));
}

TEST(MakePicture, KnowsThatAFilterThatDidNotRunTookNothingOut) {
  ScanMessages scan;
  scan.Add(Obstacles(obstacle_points_t::POSE_MISSING));

  const ScanPicture picture = MakePicture(scan, Context());

  EXPECT_FALSE(picture.missing.Contains(Layer::kRemovedByMap));
  EXPECT_THAT(picture.text_lines, Contains(HasSubstr("no pose: nothing was removed")));
}

TEST(MakePicture, DrawsTheMapOnlyWithAPose) {
  ScanContext context = Context();
  auto grid = std::make_shared<core::OccupancyGrid>();
  grid->geometry = {.width = 2, .height = 2};
  grid->cells.assign(4, core::OccupancyGrid::kFree);
  context.map = {.grid = grid, .epoch = 3, .tiles = 1, .tiles_expected = 2};
  ScanMessages scan;
  obstacle_points_t obstacles = Obstacles(obstacle_points_t::MAP_FILTERED);
  obstacles.map_epoch = 2;
  scan.Add(obstacles);

  const ScanPicture without = MakePicture(scan, context);
  scan.T_map_vehicle = Eigen::Isometry3d(Eigen::Translation3d(1.0, 2.0, 0.0));
  const ScanPicture with = MakePicture(scan, context);

  EXPECT_FALSE(without.map.has_value());
  EXPECT_TRUE(without.missing.Contains(Layer::kMap));
  ASSERT_TRUE(with.map.has_value());
  EXPECT_EQ(with.map->T_map_vehicle.translation().y(), 2.0);
  EXPECT_THAT(with.text_lines,
              Contains("map: epoch 3, 2 x 2 cells of 0.05 m (1 of 2 tiles); filtered "
                       "(FILTERED WITH EPOCH 2)"));
  EXPECT_THAT(with.text_lines, Contains("pose: x 1.00 m, y 2.00 m, yaw 0.0 deg in map"));
}

TEST(MakePicture, SaysWhichSlicesWereLeftOutOrDidNotCome) {
  ScanMessages scan;
  lidar_points_t slice = Raw({{1.0F, 0.0F, 0.0F}});
  slice.slice_count = 3;
  scan.Add(slice);
  scan.Add(slice);  // Twice.
  slice.slice_index = 1;
  slice.session = 5;  // By somebody else.
  scan.Add(slice);
  slice.sensor = "rear";
  scan.Add(slice);

  const ScanPicture picture = MakePicture(scan, Context());

  EXPECT_EQ(picture.raw_points.size(), 1U);
  EXPECT_THAT(picture.text_lines, Contains(HasSubstr("LIDAR_POINTS (1 of 3 slices)")));
  EXPECT_THAT(picture.text_lines,
              Contains("left out: sensor 'rear' is not in the configuration, 2 slices that came "
                       "twice or from a second publisher"));
}

TEST(MakePicture, ShowsTheCorridorAndTheReasonOfThePermit) {
  ScanMessages scan;
  scan.Add(Raw({{1.0F, 0.0F, 0.0F}}));
  drive_permit_t permit{};
  permit.slice_sensor = "front";
  permit.text = "obstacle in the way";
  permit.free_distance_m = 0.5;
  scan.Add(permit);
  permit.text = "a sensor has fallen silent";  // Later, about the same slice.
  scan.Add(permit);

  const ScanPicture picture = MakePicture(scan, Context());

  ASSERT_EQ(picture.corridors.size(), 1U);
  EXPECT_EQ(picture.corridors[0].state, CorridorState::kStop);
  EXPECT_THAT(picture.text_lines, Contains(HasSubstr("obstacle in the way")));
  EXPECT_THAT(picture.text_lines, Not(Contains(HasSubstr("silent"))));
}

TEST(MakePicture, CountsDetectionsOfAllSlices) {
  ScanMessages scan;
  detections_t slice{};
  slice.utime = kEnd;
  slice.slice_count = 2;
  slice.n = 1;
  slice.detections.resize(1);
  slice.detections[0].nearest[0] = 3.0F;
  scan.Add(slice);
  slice.slice_index = 1;
  slice.detections[0].nearest[0] = 1.5F;
  scan.Add(slice);

  const ScanPicture picture = MakePicture(scan, Context());

  EXPECT_EQ(picture.detections.size(), 2U);
  EXPECT_THAT(picture.text_lines, Contains("detections: 2, the nearest at 1.50 m"));
  EXPECT_THAT(picture.text_lines.front(), StartsWith("scan 0, ends 1970-01-01 00:00:01.100 UTC"));
}

}  // namespace
}  // namespace clearway::plot
