// SPDX-License-Identifier: BSD-3-Clause
// The preprocessor with map server and POSE on one bus in virtual time: a wall that the map knows,
// a post in front of it that the map does not.
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "common/core/scan/slice_cutter.hpp"
#include "common/messages/encoding.hpp"
#include "common/messages/lidar_points.hpp"
#include "common/messages/map_tiles.hpp"
#include "common/messages/pose.hpp"
#include "common/process/log.hpp"
#include "common/process/simulated_runtime.hpp"
#include "processes/map_server/map_server_process.hpp"
#include "processes/pose_source/pose_source_process.hpp"
#include "processes/preprocessor/preprocessor_process.hpp"
#include "tests/support/relay_runtime.hpp"

namespace clearway {
namespace {

using core::OccupancyGrid;
using messages::channels::kLidarPoints;
using messages::channels::kLocalMap;
using messages::channels::kMapServerStatus;
using messages::channels::kObstaclePoints;
using messages::channels::kPlayStatus;
using messages::channels::kPose;
using messages::channels::kPoseSourceStatus;
using messages::channels::kPoseStatus;
using messages::channels::kPreprocessorStatus;
using messages::channels::kRemovedPoints;
using testing::AllOf;
using testing::HasSubstr;

constexpr std::int64_t kStart = 1'700'000'000'000'000;
constexpr std::int64_t kSecond = 1'000'000;
constexpr double kWallX_m = 3.0;
constexpr double kPostX_m = 1.5;

// In map: all free from (-1, -4) to (7, 4), with a wall along x = 3.
OccupancyGrid WallMap() {
  OccupancyGrid map{{160, 160, 0.05, -1.0, -4.0, 0.0}, {}};
  map.cells.assign(map.geometry.num_cells(), OccupancyGrid::kFree);
  for (int row = 0; row < 160; ++row) {
    map.cells[map.geometry.IndexOf({80, row})] = OccupancyGrid::kOccupied;
  }
  return map;
}

// Floor, wall and post in the vehicle frame, seen from 0.5 m above the floor.
core::PointCloud WallAndPost() {
  core::PointCloud cloud;
  for (double y = -1.5; y <= 1.5; y += 0.05) {
    for (double x = 0.5; x < 3.0; x += 0.05) {
      cloud.Add({static_cast<float>(x), static_cast<float>(y), -0.5F});
    }
    for (double z = -0.2; z < 1.0; z += 0.05) {
      cloud.Add({static_cast<float>(kWallX_m), static_cast<float>(y), static_cast<float>(z)});
    }
  }
  for (double z = -0.2; z < 0.5; z += 0.05) {
    for (const float y : {-0.05F, 0.0F, 0.05F}) {
      cloud.Add({static_cast<float>(kPostX_m), y, static_cast<float>(z)});
    }
  }
  return cloud;
}

core::VehicleConfig Vehicle() {
  core::VehicleConfig vehicle;
  vehicle.stationary = true;
  vehicle.sensors.front().x_m = 0.0;
  vehicle.sensors.front().z_m = 0.5;
  return vehicle;
}

core::PreprocessorConfig WithFilter() {
  core::PreprocessorConfig config;
  config.map_filter.enabled = true;
  config.removed_points = true;
  return config;
}

class SimulatedMapFilterTest : public testing::Test {
 protected:
  explicit SimulatedMapFilterTest(const core::PreprocessorConfig& config = WithFilter())
      : preprocessor_(config, Vehicle(), preprocessor_node_) {
    process::SetUpLog("test", "off");
    runtime_.SetTap([this](auto, const std::string& channel, std::span<const std::byte> bytes) {
      if (channel == kObstaclePoints.name) {
        const auto slice = messages::Decode<obstacle_points_t>(bytes).value();
        if (slice.slice_index == 0) scan_ = slice;
      } else if (channel == kRemovedPoints.name) {
        const auto slice = messages::Decode<removed_points_t>(bytes).value();
        reasons_.insert(reasons_.end(), slice.reason.begin(), slice.reason.end());
      } else if (channel == kPreprocessorStatus.name) {
        status_ = messages::Decode<status_t>(bytes).value();
      } else if (channel == kLocalMap.name) {
        local_map_ = messages::Decode<local_map_t>(bytes).value();
      }
    });
  }

  void RunFor(std::int64_t duration_us) { runtime_.RunUntil(runtime_.MonotonicUs() + duration_us); }

  void ServeMap(process::Runtime& runtime, OccupancyGrid map = WallMap()) {
    server_node_.emplace(
        runtime, process::Identity{"map_server", "test", "digest"}, kMapServerStatus);
    server_.emplace(std::move(map), *server_node_);
    RunFor(2 * kSecond);
  }

  void FixPose(double x_m, double y_m, double yaw_rad) {
    core::PoseSourceConfig config;
    config.mode = core::PoseSourceMode::kFixed;
    config.x_m = x_m;
    config.y_m = y_m;
    config.yaw_rad = yaw_rad;
    pose_node_.emplace(
        runtime_, process::Identity{"pose_source", "test", "digest"}, kPoseSourceStatus);
    pose_source_.emplace(config, *pose_node_);
  }

  void PublishPose(std::int64_t utime) {
    player_.Publish(kPose, messages::ToPose(utime, Eigen::Isometry3d::Identity()));
  }

  // One scan in ten slices, as from a sensor; what came of it is in scan_ and status_.
  void PlayScan() {
    const std::int64_t begin = runtime_.UtimeNow();
    for (const core::Slice& slice : core::CutIntoSlices({.scan_id = scan_id_++,
                                    .utime_start = begin,
                                    .utime_end = begin + 100'000,
                                    .cloud_sensor = WallAndPost()},
                                                        {})) {
      RunFor(10'000);
      player_.Publish(kLidarPoints, messages::ToLcm(slice, "front"));
    }
    RunFor(20'000);
    preprocessor_node_.RefreshAndPublishStatus();
    RunFor(30'000);
  }

  process::SimulatedRuntime runtime_{kStart, {}};
  process::Node preprocessor_node_{runtime_,
                                   {"preprocessor", "test", "digest"},
                                   kPreprocessorStatus};
  PreprocessorProcess preprocessor_;
  process::Node player_{runtime_, {"play", "test", "digest"}, kPlayStatus};
  std::optional<process::Node> server_node_;
  std::optional<MapServerProcess> server_;
  std::optional<process::Node> pose_node_;
  std::optional<PoseSourceProcess> pose_source_;
  std::int64_t scan_id_ = 0;
  obstacle_points_t scan_{};
  std::vector<std::int8_t> reasons_;  // Of all slices of REMOVED_POINTS.
  status_t status_{};
  std::optional<local_map_t> local_map_;
};

MATCHER(RemovedNothing, "removed nothing") {
  return arg.points_map == arg.points_floor && arg.map_epoch == 0 && arg.points_map > 0;
}

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

TEST_F(SimulatedMapFilterTest, WithAPoseThatIsSaidToBeLostNothingIsRemovedAndTheStatusSaysWhy) {
  ServeMap(runtime_);
  FixPose(0.0, 0.0, 0.0);
  player_.Subscribe<pose_t>(kPose, [this](const auto&) {
    pose_status_t lost{};
    lost.state = pose_status_t::STATE_LOST;
    player_.Publish(kPoseStatus, lost);
  });

  PlayScan();

  EXPECT_EQ(scan_.map_state, obstacle_points_t::POSE_LOST);
  EXPECT_THAT(scan_, RemovedNothing());
  EXPECT_THAT(status_.text, HasSubstr("lost"));
}

TEST_F(SimulatedMapFilterTest, TwoPublishersOfPoseAreBelievedNeither) {
  ServeMap(runtime_);
  FixPose(0.0, 0.0, 0.0);
  player_.Subscribe<lidar_points_t>(kLidarPoints,
                                    [this](const auto& slice) { PublishPose(slice.utime - 5000); });

  PlayScan();

  EXPECT_EQ(scan_.map_state, obstacle_points_t::POSE_LOST);
  EXPECT_THAT(scan_, RemovedNothing());
  EXPECT_THAT(status_.text, HasSubstr("two publishers"));
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
  test::RelayRuntime wire(runtime_, kMapServerStatus.name, [&lives](auto) {
    return lives ? test::RelayRuntime::Deliveries{0} : test::RelayRuntime::Deliveries{};
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

TEST_F(SimulatedMapFilterTest, DeadReckoningCarriesThePoseOnWithOdometry) {
  core::PoseSourceConfig config;
  config.mode = core::PoseSourceMode::kDeadReckoning;
  config.x_m = 1.0;
  config.yaw_rad = M_PI / 2;
  process::Node node(runtime_, {"pose_source", "test", "digest"}, kPoseSourceStatus);
  PoseSourceProcess source(config, node);
  std::vector<pose_t> poses;
  player_.Subscribe<pose_t>(kPose, [&poses](const pose_t& pose) { poses.push_back(pose); });
  odometry_t odometry{};
  odometry.orientation[0] = 1.0;
  odometry.pos[0] = 7.0;

  for (int i = 0; i < 3; ++i) {
    odometry.utime = kStart + i * 20'000;
    odometry.pos[0] = 7.0 + 0.1 * i;
    player_.Publish(messages::channels::kOdometry, odometry);
    RunFor(20'000);
  }

  ASSERT_EQ(poses.size(), 3U);
  EXPECT_NEAR(poses[0].pos[0], 1.0, 1e-12);
  EXPECT_NEAR(poses[2].pos[0], 1.0, 1e-12);
  EXPECT_NEAR(poses[2].pos[1], 0.2, 1e-12);
  EXPECT_EQ(poses[2].utime, kStart + 40'000);
}

}  // namespace
}  // namespace clearway
