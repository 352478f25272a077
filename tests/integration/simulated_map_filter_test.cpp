// SPDX-License-Identifier: BSD-3-Clause
// What the map filter takes out of a scan, and what makes it take out nothing.
#include "tests/support/map_filter_fixture.hpp"

namespace clearway::test {
namespace {

TEST_F(SimulatedMapFilterTest, TakesOutTheWallAndKeepsThePost) {
  ServeMap(runtime_);
  FixPose(0.0, 0.0, 0.0);

  PlayScan();

  EXPECT_EQ(scan_.map_state, obstacle_points_t::MAP_FILTERED);
  EXPECT_EQ(scan_.map_epoch, kStart);
  EXPECT_EQ(status_.state, status_t::STATE_OK) << status_.text;
  ASSERT_GT(scan_.n, 10);
  // The lowest points of the wall, below the filter's band, stay.
  for (int i = 0; i < scan_.n; ++i) {
    const auto k = static_cast<std::size_t>(i);
    EXPECT_TRUE(scan_.x[k] < 1.7F || scan_.z[k] < 0.31F) << scan_.x[k] << ' ' << scan_.z[k];
  }
  EXPECT_LT(scan_.points_map, scan_.points_floor / 2);
}

TEST_F(SimulatedMapFilterTest, TellsWhatWasTakenOutAndWhy) {
  ServeMap(runtime_);
  FixPose(0.0, 0.0, 0.0);

  PlayScan();

  const auto by_map = std::count(reasons_.begin(), reasons_.end(), removed_points_t::REASON_MAP);
  const auto by_floor =
      std::count(reasons_.begin(), reasons_.end(), removed_points_t::REASON_FLOOR);
  EXPECT_EQ(by_map, scan_.points_floor - scan_.points_map);
  EXPECT_EQ(by_floor, scan_.points_voxel - scan_.points_floor);
  EXPECT_EQ(by_map + by_floor, std::ssize(reasons_));
}

TEST_F(SimulatedMapFilterTest, APoseThatIsTurnedAndMovedWithItsMapGivesTheSame) {
  OccupancyGrid map = WallMap();
  const Eigen::Isometry3d T = core::FromRpy({5.0, -2.0, 0.0}, {0.0, 0.0, 1.0});
  const Eigen::Vector3d origin = T * Eigen::Vector3d(-1.0, -4.0, 0.0);
  map.geometry.origin_x_m = origin.x();
  map.geometry.origin_y_m = origin.y();
  map.geometry.origin_yaw_rad = 1.0;
  ServeMap(runtime_, map);
  FixPose(5.0, -2.0, 1.0);

  PlayScan();

  EXPECT_EQ(scan_.map_state, obstacle_points_t::MAP_FILTERED);
  EXPECT_LT(scan_.points_map, scan_.points_floor / 2);
}

TEST_F(SimulatedMapFilterTest, WithoutAMapNothingIsRemovedAndTheStatusSaysWhy) {
  FixPose(0.0, 0.0, 0.0);

  PlayScan();

  EXPECT_EQ(scan_.map_state, obstacle_points_t::MAP_MISSING);
  EXPECT_THAT(scan_, RemovedNothing());
  EXPECT_EQ(status_.state, status_t::STATE_DEGRADED);
  EXPECT_THAT(status_.text, AllOf(HasSubstr("removes nothing"), HasSubstr("no map server")));
}

TEST_F(SimulatedMapFilterTest, WithoutAPoseNothingIsRemovedAndTheStatusSaysWhy) {
  ServeMap(runtime_);

  PlayScan();

  EXPECT_EQ(scan_.map_state, obstacle_points_t::POSE_MISSING);
  EXPECT_THAT(scan_, RemovedNothing());
  EXPECT_THAT(status_.text, AllOf(HasSubstr("removes nothing"), HasSubstr("no POSE")));
  EXPECT_FALSE(local_map_);
}

TEST_F(SimulatedMapFilterTest, WithAnOldPoseNothingIsRemovedAndTheStatusSaysWhy) {
  ServeMap(runtime_);
  PublishPose(runtime_.UtimeNow() - 20'000);
  PublishPose(runtime_.UtimeNow());

  PlayScan();

  EXPECT_EQ(scan_.map_state, obstacle_points_t::POSE_OLD);
  EXPECT_THAT(scan_, RemovedNothing());
  EXPECT_THAT(status_.text, HasSubstr("older than pose.max_extrapolation_ms"));
}

TEST_F(SimulatedMapFilterTest, AScanWithoutPointsStillGivesObstaclePointsAndALocalMap) {
  ServeMap(runtime_);
  FixPose(0.0, 0.0, 0.0);

  PlayScan({});

  EXPECT_EQ(scan_.n, 0);
  EXPECT_EQ(scan_.slice_count, 1);
  EXPECT_GT(scan_.utime, kStart);
  ASSERT_TRUE(local_map_);
  EXPECT_EQ(local_map_->utime, scan_.utime);
  EXPECT_EQ(local_map_->slice_count, 1);
}

TEST_F(SimulatedMapFilterTest, OffTheMapNothingIsRemovedAndTheStatusSaysWhy) {
  ServeMap(runtime_);
  FixPose(500.0, 0.0, 0.0);

  PlayScan();

  EXPECT_EQ(scan_.map_state, obstacle_points_t::OUTSIDE_MAP);
  EXPECT_EQ(scan_.points_map, scan_.points_floor);
  EXPECT_EQ(status_.state, status_t::STATE_DEGRADED);
  EXPECT_THAT(status_.text, HasSubstr("off the map"));
}

TEST_F(SimulatedMapFilterTest, InUnknownCellsNothingIsRemovedAndTheStatusSaysWhy) {
  OccupancyGrid map = WallMap();
  for (std::uint8_t& cell : map.cells) {
    if (cell == OccupancyGrid::kFree) cell = OccupancyGrid::kUnknown;
  }
  // The points of the wall are in occupied cells; turned by 90 deg they are not.
  ServeMap(runtime_, map);
  FixPose(0.0, 0.0, 0.5);

  PlayScan();

  EXPECT_EQ(scan_.map_state, obstacle_points_t::OUTSIDE_MAP);
  EXPECT_THAT(status_.text, HasSubstr("unknown cells"));
}

TEST_F(SimulatedMapFilterTest, WhenTheMapServerDiesNothingIsRemovedAnyMore) {
  bool lives = true;
  RelayRuntime wire(runtime_, kMapServerStatus.name, [&lives](auto) {
    return lives ? RelayRuntime::Deliveries{0} : RelayRuntime::Deliveries{};
  });
  ServeMap(wire);
  FixPose(0.0, 0.0, 0.0);
  PlayScan();
  ASSERT_EQ(scan_.map_state, obstacle_points_t::MAP_FILTERED);

  lives = false;
  RunFor(3 * kSecond);
  PlayScan();

  EXPECT_EQ(scan_.map_state, obstacle_points_t::MAP_MISSING);
  EXPECT_THAT(scan_, RemovedNothing());
  EXPECT_THAT(status_.text, HasSubstr("silent"));
}

TEST_F(SimulatedMapFilterTest, PublishesWhatItSawBeforeTheFilterAsLocalMap) {
  ServeMap(runtime_);
  FixPose(0.0, 0.0, 0.0);

  PlayScan();

  ASSERT_TRUE(local_map_);
  EXPECT_EQ(local_map_->utime, scan_.utime);
  const auto grid = messages::FromLcm(*local_map_);
  ASSERT_TRUE(grid);
  const auto at = [&grid](double x_m, double y_m) {
    const auto cell = grid->geometry.CellAt({x_m, y_m});
    return cell ? grid->At(*cell) : OccupancyGrid::kUnknown;
  };
  EXPECT_EQ(at(kWallX_m + 0.01, 0.52), OccupancyGrid::kOccupied);
  EXPECT_EQ(at(kPostX_m + 0.01, 0.01), OccupancyGrid::kOccupied);
  EXPECT_EQ(at(1.0, 0.4), OccupancyGrid::kFree);
  EXPECT_EQ(at(3.5, 0.4), OccupancyGrid::kUnknown);
}

}  // namespace
}  // namespace clearway::test
