// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cstdint>
#include <limits>
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

/// The preprocessor with map server and POSE on one bus in virtual time: a wall that the map knows,
/// a post in front of it that the map does not.
namespace clearway::test {

using core::OccupancyGrid;
using messages::channels::kLidarPoints;
using messages::channels::kLocalMap;
using messages::channels::kMapServerStatus;
using messages::channels::kObstaclePoints;
using messages::channels::kOdometry;
using messages::channels::kPlayStatus;
using messages::channels::kPose;
using messages::channels::kPoseSourceStatus;
using messages::channels::kPoseStatus;
using messages::channels::kPreprocessorStatus;
using messages::channels::kRemovedPoints;
using testing::AllOf;
using testing::HasSubstr;

inline constexpr std::int64_t kStart = 1'700'000'000'000'000;
inline constexpr std::int64_t kSecond = 1'000'000;
inline constexpr double kWallX_m = 3.0;
inline constexpr double kPostX_m = 1.5;

// In map: all free from (-1, -4) to (7, 4), with a wall along x = 3.
inline OccupancyGrid WallMap() {
  OccupancyGrid map{{160, 160, 0.05, -1.0, -4.0, 0.0}, {}};
  map.cells.assign(map.geometry.num_cells(), OccupancyGrid::kFree);
  for (int row = 0; row < 160; ++row) {
    map.cells[map.geometry.IndexOf({80, row})] = OccupancyGrid::kOccupied;
  }
  return map;
}

// Floor, wall and post in the vehicle frame, seen from 0.5 m above the floor.
inline core::PointCloud WallAndPost() {
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

inline core::VehicleConfig Vehicle() {
  core::VehicleConfig vehicle;
  vehicle.stationary = true;
  vehicle.sensors.front().x_m = 0.0;
  vehicle.sensors.front().z_m = 0.5;
  return vehicle;
}

inline core::PreprocessorConfig WithFilter() {
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

  // Whether the pose source's POSE_STATUS arrives from now on.
  void RelayGoodWords(bool arrives) { good_words_arrive_ = arrives; }

  void FixPose(double x_m, double y_m, double yaw_rad) {
    core::PoseSourceConfig config;
    config.mode = core::PoseSourceMode::kFixed;
    config.x_m = x_m;
    config.y_m = y_m;
    config.yaw_rad = yaw_rad;
    pose_node_.emplace(
        pose_wire_, process::Identity{"pose_source", "test", "digest"}, kPoseSourceStatus);
    pose_source_.emplace(config, *pose_node_);
  }

  // `sequence` as of one sender; other senders have other sessions.
  void PublishPoseStatus(std::int8_t state, std::int64_t sequence, std::int64_t session = 500) {
    pose_status_t status{};
    status.state = state;
    status.session = session;
    status.sequence = sequence;
    runtime_.Publish(kPoseStatus.bus, kPoseStatus.name, messages::Encode(status));
  }

  void PublishPose(std::int64_t utime) {
    player_.Publish(kPose, messages::ToPose(utime, Eigen::Isometry3d::Identity()));
  }

  // One scan in ten slices, as from a sensor; what came of it is in scan_ and status_.
  void PlayScan(const core::PointCloud& cloud = WallAndPost()) {
    const std::int64_t begin = runtime_.UtimeNow();
    for (const core::Slice& slice : core::CutIntoSlices({.scan_id = scan_id_++,
                                    .utime_start = begin,
                                    .utime_end = begin + 100'000,
                                    .cloud_sensor = cloud},
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
  bool good_words_arrive_ = true;
  RelayRuntime pose_wire_{runtime_, kPoseStatus.name, [this](auto) {
                            return good_words_arrive_ ? RelayRuntime::Deliveries{0}
                                                      : RelayRuntime::Deliveries{};
                          }};
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

}  // namespace clearway::test
