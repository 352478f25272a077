// SPDX-License-Identifier: BSD-3-Clause
// POSE and ODOMETRY that are wrong, lost or published twice, as the map filter sees them.
#include "tests/support/map_filter_fixture.hpp"

namespace clearway::test {
namespace {

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

// A log that is played beside a living source: nothing but the order of the stamps tells.
TEST_F(SimulatedMapFilterTest, TwoPublishersOfPoseWithClocksFarApartAreBelievedNeither) {
  ServeMap(runtime_);
  FixPose(0.0, 0.0, 0.0);
  int slices = 0;
  player_.Subscribe<lidar_points_t>(kLidarPoints, [&](const auto& slice) {
    if (++slices % 4 == 0) PublishPose(slice.utime - 3600 * kSecond);
  });

  PlayScan();

  EXPECT_EQ(scan_.map_state, obstacle_points_t::POSE_LOST);
  EXPECT_THAT(scan_, RemovedNothing());
  EXPECT_THAT(status_.text, HasSubstr("two publishers"));
}

TEST_F(SimulatedMapFilterTest, ALogThatIsPlayedOnceMoreIsNoSecondPublisherOfPose) {
  ServeMap(runtime_);
  for (int i = 0; i < 100; ++i) PublishPose(runtime_.UtimeNow() + 30 * kSecond + i * 10'000);
  RunFor(10'000);
  FixPose(0.0, 0.0, 0.0);

  PlayScan();

  EXPECT_EQ(scan_.map_state, obstacle_points_t::MAP_FILTERED) << status_.text;
}

TEST_F(SimulatedMapFilterTest, TwoPosesForOneStampHaveTwoPublishers) {
  ServeMap(runtime_);
  FixPose(0.0, 0.0, 0.0);
  player_.Subscribe<pose_t>(kPose, [this](const pose_t& pose) {
    if (pose.pos[0] == 0.0) {
      player_.Publish(
          kPose, messages::ToPose(pose.utime, core::FromRpy({1.0, 0.0, 0.0}, {0.0, 0.0, 0.0})));
    }
  });

  PlayScan();

  EXPECT_EQ(scan_.map_state, obstacle_points_t::POSE_LOST);
  EXPECT_THAT(status_.text, HasSubstr("two publishers"));
}

TEST_F(SimulatedMapFilterTest, LostHoldsUntilItIsTakenBack) {
  ServeMap(runtime_);
  PublishPoseStatus(pose_status_t::STATE_LOST, 1);
  RunFor(1000);
  FixPose(0.0, 0.0, 0.0);
  RelayGoodWords(false);
  PlayScan();
  EXPECT_EQ(scan_.map_state, obstacle_points_t::POSE_LOST);

  PublishPoseStatus(pose_status_t::STATE_GOOD, 0);  // Overtaken by the word "lost".
  PlayScan();
  EXPECT_EQ(scan_.map_state, obstacle_points_t::POSE_LOST);

  PublishPoseStatus(pose_status_t::STATE_GOOD, 2);
  PlayScan();
  EXPECT_EQ(scan_.map_state, obstacle_points_t::MAP_FILTERED);
}

TEST_F(SimulatedMapFilterTest, LostIsForgottenWhenItsSourceDiedAndAnotherGivesPoses) {
  ServeMap(runtime_);
  PublishPoseStatus(pose_status_t::STATE_LOST, 1);
  RunFor(10 * kSecond);
  FixPose(0.0, 0.0, 0.0);
  RelayGoodWords(false);

  PlayScan();

  EXPECT_EQ(scan_.map_state, obstacle_points_t::MAP_FILTERED) << status_.text;
}

TEST_F(SimulatedMapFilterTest, AStateThatTheTypeDoesNotKnowIsNoWordOfTrust) {
  ServeMap(runtime_);
  FixPose(0.0, 0.0, 0.0);
  RelayGoodWords(false);
  PublishPoseStatus(std::int8_t{77}, 0);

  PlayScan();

  EXPECT_EQ(scan_.map_state, obstacle_points_t::POSE_LOST);
  EXPECT_EQ(status_.invalid, 1);
}

TEST_F(SimulatedMapFilterTest, PosesThatAreNoneAreCountedAndLeaveTheFilterWithoutAPose) {
  ServeMap(runtime_);
  const double nan = std::numeric_limits<double>::quiet_NaN();
  std::vector<pose_t> poses(6,
                            messages::ToPose(runtime_.UtimeNow(), Eigen::Isometry3d::Identity()));
  poses[0].pos[1] = nan;
  poses[1].orientation[2] = nan;
  poses[2].orientation[0] = 0.0;
  poses[3].orientation[3] = 1e200;  // Its length is beyond a double.
  poses[4].orientation[1] = std::numeric_limits<double>::infinity();
  poses[5].utime = std::numeric_limits<std::int64_t>::min();

  for (const pose_t& pose : poses) player_.Publish(kPose, pose);
  PlayScan();

  EXPECT_EQ(status_.invalid, std::ssize(poses));
  EXPECT_EQ(scan_.map_state, obstacle_points_t::POSE_MISSING);
}

TEST_F(SimulatedMapFilterTest, APoseFromTheEndOfTimeIsForgottenWithTheNextOnes) {
  ServeMap(runtime_);
  PublishPose(std::numeric_limits<std::int64_t>::max());
  RunFor(1000);
  FixPose(0.0, 0.0, 0.0);

  PlayScan();

  EXPECT_EQ(scan_.map_state, obstacle_points_t::MAP_FILTERED) << status_.text;
}

TEST_F(SimulatedMapFilterTest, APoseAtTheEndOfTheWorldRemovesNothing) {
  ServeMap(runtime_);
  for (const double x_m : {1e6, 1e12, 1e300}) {
    for (int i = 0; i < 30; ++i) {
      pose_t pose =
          messages::ToPose(runtime_.UtimeNow() + i * 10'000, Eigen::Isometry3d::Identity());
      pose.pos[0] = pose.pos[1] = x_m;
      player_.Publish(kPose, pose);
    }

    PlayScan();

    EXPECT_EQ(scan_.map_state, obstacle_points_t::OUTSIDE_MAP) << x_m;
    EXPECT_EQ(scan_.points_map, scan_.points_floor) << x_m;
    ASSERT_TRUE(local_map_);
    EXPECT_TRUE(messages::FromLcm(*local_map_)) << x_m;
    RunFor(2 * kSecond);
  }
}

TEST_F(SimulatedMapFilterTest, SlicesWithStampsThatAreNoneGiveNoPose) {
  FixPose(0.0, 0.0, 0.0);
  int poses = 0;
  player_.Subscribe<pose_t>(kPose, [&poses](const auto&) { ++poses; });
  constexpr std::int64_t kLeast = std::numeric_limits<std::int64_t>::min();
  constexpr std::int64_t kMost = std::numeric_limits<std::int64_t>::max();
  const auto play = [this](std::int64_t begin, std::int64_t end, int index, int count) {
    lidar_points_t slice{};
    slice.sensor = "front";
    slice.scan_utime = begin;
    slice.scan_end_utime = end;
    slice.slice_index = index;
    slice.slice_count = count;
    player_.Publish(kLidarPoints, slice);
    RunFor(1000);
  };

  play(kLeast, kMost, 0, 10);
  play(kMost, kLeast, 0, 10);
  play(kLeast, kLeast, 0, 1);
  play(0, kMost, 0, std::numeric_limits<int>::max());
  play(kStart, kStart + 100'000, 0, 0);
  play(kStart, kStart + 100'000, -1, 10);
  play(kStart, kStart + 100'000, 3, std::numeric_limits<int>::min());
  EXPECT_EQ(poses, 0);

  play(kStart, kStart + 100'000, 0, 10);
  EXPECT_EQ(poses, 1);
}

TEST_F(SimulatedMapFilterTest, TwoSensorsWhoseSlicesInterleaveGivePosesInOrder) {
  FixPose(0.0, 0.0, 0.0);
  std::vector<std::int64_t> utimes;
  player_.Subscribe<pose_t>(kPose, [&](const pose_t& pose) { utimes.push_back(pose.utime); });
  for (int k = 0; k < 20; ++k) {
    lidar_points_t slice{};
    slice.sensor = k % 2 == 0 ? "front" : "rear";
    slice.scan_utime = kStart - (k % 2) * 3000;
    slice.scan_end_utime = slice.scan_utime + 100'000;
    slice.slice_index = k / 2;
    slice.slice_count = 10;
    player_.Publish(kLidarPoints, slice);
    RunFor(5000);
  }

  EXPECT_EQ(utimes.size(), 10U);
  EXPECT_TRUE(std::is_sorted(utimes.begin(), utimes.end()));
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

// The base's clock is the host's: it goes on while the base starts anew at its odom's origin.
TEST_F(SimulatedMapFilterTest, DeadReckoningStaysWhereItIsWhenTheBaseStartsAnew) {
  core::PoseSourceConfig config;
  config.mode = core::PoseSourceMode::kDeadReckoning;
  process::Node node(runtime_, {"pose_source", "test", "digest"}, kPoseSourceStatus);
  PoseSourceProcess source(config, node);
  std::vector<double> x_m;
  player_.Subscribe<pose_t>(kPose, [&x_m](const pose_t& pose) { x_m.push_back(pose.pos[0]); });

  for (int i = 0; i < 6; ++i) {
    odometry_t odometry{};
    odometry.utime = kStart + i * 20'000;
    odometry.session = i < 3 ? 100 : 200;
    odometry.sequence = i % 3;
    odometry.orientation[0] = 1.0;
    odometry.pos[0] = (i < 3 ? 50.0 : 0.0) + 0.25 * (i % 3);
    runtime_.Publish(kOdometry.bus, kOdometry.name, messages::Encode(odometry));
    RunFor(20'000);
  }

  EXPECT_THAT(x_m, testing::ElementsAre(0.0, 0.25, 0.5, 0.5, 0.75, 1.0));
}

// The base starts anew in the middle of a scan, 1 km away by its own account.
TEST(SimulatedMapBusTest, PointsAreNotDeskewedAcrossAnOdometryThatStartsAnew) {
  process::SetUpLog("test", "off");
  core::VehicleConfig vehicle = Vehicle();
  vehicle.stationary = false;
  process::SimulatedRuntime runtime(kStart, {});
  process::Node node(runtime, {"preprocessor", "test", "digest"}, kPreprocessorStatus);
  PreprocessorProcess preprocessor({}, vehicle, node);
  process::Node player(runtime, {"play", "test", "digest"}, kPlayStatus);
  std::optional<obstacle_points_t> obstacles;
  player.Subscribe<obstacle_points_t>(
      kObstaclePoints, [&obstacles](const obstacle_points_t& slice) { obstacles = slice; });
  const std::vector<core::Slice> slices = core::CutIntoSlices({.scan_id = 0,
                                                               .utime_start = kStart,
                                                               .utime_end = kStart + 100'000,
                                                               .cloud_sensor = WallAndPost()},
                                                              {});

  for (std::size_t i = 0; i < slices.size(); ++i) {
    for (std::int64_t k = 0; k < 2; ++k) {
      odometry_t odometry{};
      odometry.session = i < 5 ? 100 : 200;
      odometry.sequence = 2 * static_cast<std::int64_t>(i % 5) + k;
      odometry.utime = runtime.UtimeNow() + k * 5000;
      odometry.orientation[0] = 1.0;
      odometry.pos[0] = i < 5 ? 1000.0 : 0.0;
      runtime.Publish(kOdometry.bus, kOdometry.name, messages::Encode(odometry));
    }
    runtime.RunUntil(runtime.MonotonicUs() + 10'000);
    player.Publish(kLidarPoints, messages::ToLcm(slices[i], "front"));
  }
  runtime.RunUntil(kStart + kSecond);

  ASSERT_TRUE(obstacles);
  EXPECT_EQ(obstacles->motion_state, obstacle_points_t::MOTION_DESKEWED);
  EXPECT_GT(obstacles->n, 500);
  for (const float x : obstacles->x) ASSERT_LT(x, 3.5F);
}

TEST(SimulatedMapBusTest, ALargeLocalMapNeverDelaysObstaclePoints) {
  process::SetUpLog("test", "off");
  core::PreprocessorConfig config;
  config.local_map.resolution_m = 0.01;
  config.local_map.radius_m = 8.0;
  constexpr std::int64_t kPause_us = 5000;
  process::SimulatedRuntime runtime(kStart,
                                    {.max_message_bytes = 1400, .burst_interval_us = kPause_us});
  process::Node node(runtime, {"preprocessor", "test", "digest"}, kPreprocessorStatus);
  PreprocessorProcess preprocessor(config, Vehicle(), node);
  process::Node player(runtime, {"play", "test", "digest"}, kPlayStatus);
  std::int64_t scan_done_us = 0;
  std::int64_t latest_us = 0;
  int obstacle_slices = 0;
  int local_maps = 0;
  int local_slices = 0;
  player.Subscribe<obstacle_points_t>(kObstaclePoints, [&](const obstacle_points_t& slice) {
    ++obstacle_slices;
    if (slice.slice_index + 1 == slice.slice_count) {
      latest_us = std::max(latest_us, runtime.MonotonicUs() - scan_done_us);
    }
    EXPECT_LE(slice.getEncodedSize(), 1400);
  });
  player.Subscribe<local_map_t>(kLocalMap, [&](const local_map_t& slice) {
    local_slices = slice.slice_count;
    if (slice.slice_index + 1 == slice.slice_count) ++local_maps;
    EXPECT_LE(slice.getEncodedSize(), 1400);
  });

  for (int scan = 0; scan < 8; ++scan) {
    const std::int64_t begin = kStart + scan * 100'000;
    for (const core::Slice& slice : core::CutIntoSlices({.scan_id = scan,
                                    .utime_start = begin,
                                    .utime_end = begin + 100'000,
                                    .cloud_sensor = WallAndPost()},
                                                        {})) {
      runtime.RunUntil(begin + 100'000 * (slice.slice_index + 1) / slice.slice_count);
      scan_done_us = runtime.MonotonicUs();
      player.Publish(kPose, messages::ToPose(runtime.MonotonicUs(), Eigen::Isometry3d::Identity()));
      player.Publish(kLidarPoints, messages::ToLcm(slice, "front"));
    }
  }
  runtime.RunUntil(kStart + 4 * kSecond);

  ASSERT_GT(local_slices * kPause_us, 100'000) << "more than goes out between two scans";
  EXPECT_LE(latest_us, kPause_us * (obstacle_slices / 8));
  EXPECT_GT(local_maps, 0);
}

}  // namespace
}  // namespace clearway::test
