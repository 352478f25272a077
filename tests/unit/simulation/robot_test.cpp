// SPDX-License-Identifier: BSD-3-Clause
#include "common/core/simulation/robot.hpp"

#include <cmath>
#include <cstdint>
#include <numbers>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/unit/scan/visit_check.hpp"

namespace clearway::core {
namespace {

constexpr std::int64_t kSecond = 1'000'000;
constexpr std::int64_t kEpoch_us = 1'600'000'000'000'000;

RobotConfig Driving(DriveMode drive) {
  RobotConfig config;
  config.drive = drive;
  config.obey_permit = false;
  return config;
}

// A vehicle that turns about its middle, 0.5 x 0.4 m.
VehicleConfig Vehicle() {
  VehicleConfig vehicle;
  vehicle.footprint = {{-0.25, -0.2}, {0.25, -0.2}, {0.25, 0.2}, {-0.25, 0.2}};
  return vehicle;
}

SceneConfig BoxAhead(double x_m) {
  SceneConfig scene;
  SceneBox box;
  box.object.name = "box";
  box.object.x_m = x_m;
  scene.boxes.push_back(box);
  return scene;
}

BasePermit PermitOf(std::int64_t sequence, std::int64_t time_us, double forward_mps) {
  return {1, sequence, kEpoch_us + time_us, 100'000, forward_mps, 0.5, 1.5, 1.5};
}

// Permits at 50 Hz from `from_us` until before `to_us`.
void Permit(Robot& robot, std::int64_t from_us, std::int64_t to_us, double forward_mps) {
  for (std::int64_t time_us = from_us; time_us < to_us; time_us += 20'000) {
    robot.OnPermit(PermitOf(time_us / 20'000, time_us, forward_mps), time_us);
  }
}

// When the robot stands, looked at each millisecond from `from_us` on.
std::int64_t StandsAt(Robot& robot, std::int64_t from_us) {
  for (std::int64_t time_us = from_us; time_us < from_us + 20 * kSecond; time_us += 1000) {
    if (!robot.StateAt(time_us).IsMoving()) return time_us;
  }
  return -1;
}

TEST(Robot, HasDefaultsWithinItsBounds) {
  EXPECT_THAT(test::FaultsOfDefaults<RobotConfig>(), testing::IsEmpty());
  EXPECT_THAT(test::FaultsOfDefaults<PoseErrorConfig>(), testing::IsEmpty());
  EXPECT_THAT(test::FaultsOfDefaults<OdometryErrorConfig>(), testing::IsEmpty());
  EXPECT_THAT(test::FaultsOfDefaults<WheelSlipConfig>(), testing::IsEmpty());
}

TEST(Robot, StandsWhereTheSceneStarts) {
  SceneConfig scene;
  scene.start = {1.0, 2.0, 0.5};
  Robot robot(RobotConfig{}, Vehicle(), scene);

  const RobotState state = robot.StateAt(10 * kSecond);

  EXPECT_EQ(state.in_map, (PlanarPose{1.0, 2.0, 0.5}));
  EXPECT_EQ(state.in_odom, PlanarPose{});
  EXPECT_FALSE(state.IsMoving());
}

TEST(Robot, SpeedsUpAfterTheDelayAsItsDrivesAllow) {
  RobotConfig config = Driving(DriveMode::kStraight);
  config.speed_mps = 0.8;
  config.acceleration_mps2 = 0.4;
  Robot robot(config, Vehicle(), SceneConfig{});

  EXPECT_EQ(robot.StateAt(100'000).v_mps, 0.0) << "the delay is 0.1 s";
  EXPECT_NEAR(robot.StateAt(1'100'000).v_mps, 0.4, 1e-9);
  EXPECT_NEAR(robot.StateAt(1'100'000).in_map.x_m, 0.5 * 0.4, 1e-9);
  EXPECT_NEAR(robot.StateAt(10'100'000).in_map.x_m, 0.8 * 0.8 / 0.8 + 8.0 * 0.8, 1e-9);
}

TEST(Robot, IsNoFasterThanItsVehicle) {
  RobotConfig config = Driving(DriveMode::kStraight);
  config.speed_mps = 5.0;
  Robot robot(config, Vehicle(), SceneConfig{});

  EXPECT_EQ(robot.StateAt(10 * kSecond).v_mps, Vehicle().max_forward_mps);
}

// The same course, by an integration in steps of 10 us.
TEST(Robot, DrivesArcsAsAFineIntegrationDoes) {
  RobotConfig config = Driving(DriveMode::kCommand);
  config.gate.command_validity_us = 5 * kSecond;
  VehicleConfig vehicle = Vehicle();
  vehicle.actuation_us = 0;
  Robot robot(config, vehicle, SceneConfig{});
  double x = 0.0;
  double y = 0.0;
  double yaw = 0.0;
  double v = 0.0;
  double w = 0.0;
  constexpr double kDt_s = 1e-5;
  const auto approach = [](double now, double goal, double up, double down) {
    const double most = (std::abs(goal) < std::abs(now) ? down : up) * kDt_s;
    return now + std::clamp(goal - now, -most, most);
  };

  robot.OnOrder({1, 0, kEpoch_us, {0.7, 0.9}}, 0);
  for (int i = 0; i < 500'000; ++i) {
    if (i == 300'000) robot.OnOrder({1, 1, kEpoch_us + 3 * kSecond, {0.2, 0.1}}, 3 * kSecond);
    const double v_before = v;
    const double w_before = w;
    v = approach(v, i < 300'000 ? 0.7 : 0.2, 0.8, vehicle.deceleration_mps2);
    w = approach(w, i < 300'000 ? 0.9 : 0.1, 3.0, vehicle.turn_deceleration_radps2);
    const double middle = yaw + 0.25 * (w + w_before) * kDt_s;
    x += 0.5 * (v + v_before) * kDt_s * std::cos(middle);
    y += 0.5 * (v + v_before) * kDt_s * std::sin(middle);
    yaw += 0.5 * (w + w_before) * kDt_s;
  }

  const RobotState state = robot.StateAt(5 * kSecond);
  EXPECT_NEAR(state.in_map.x_m, x, 1e-6);
  EXPECT_NEAR(state.in_map.y_m, y, 1e-6);
  EXPECT_NEAR(state.in_map.yaw_rad, yaw, 1e-9);
  EXPECT_NEAR(state.v_mps, v, 1e-9);
}

struct Braking {
  double speed_mps;
  double deceleration_mps2;
  double share;
  std::int64_t delay_us;
};

class RobotBrakingTest : public testing::TestWithParam<Braking> {};

// v^2 / 2 a of way and v / a of time, after the delay.
TEST_P(RobotBrakingTest, StandsAfterDelayAndBrakingWhenPermittedNothing) {
  const Braking& p = GetParam();
  VehicleConfig vehicle = Vehicle();
  vehicle.max_forward_mps = 5.0;
  vehicle.deceleration_mps2 = p.deceleration_mps2;
  vehicle.actuation_us = p.delay_us;
  RobotConfig config = Driving(DriveMode::kStraight);
  config.obey_permit = true;
  config.speed_mps = p.speed_mps;
  config.braking_share = p.share;
  config.acceleration_mps2 = 10.0;
  Robot robot(config, vehicle, SceneConfig{});
  const std::int64_t stop_us = 5 * kSecond;
  Permit(robot, 0, stop_us, 10.0);
  const double from_m = robot.StateAt(stop_us).in_map.x_m;

  robot.OnPermit(PermitOf(1000, stop_us, 0.0), stop_us);
  std::int64_t stands_us = -1;
  for (std::int64_t t = stop_us; stands_us < 0; t += 1000) {
    if (t % 20'000 == 0 && t > stop_us) robot.OnPermit(PermitOf(1000 + t / 20'000, t, 0.0), t);
    if (!robot.StateAt(t).IsMoving()) stands_us = t;
  }

  const double a = p.deceleration_mps2 * p.share;
  const double delay_s = 1e-6 * static_cast<double>(p.delay_us);
  EXPECT_NEAR(1e-6 * static_cast<double>(stands_us - stop_us), delay_s + p.speed_mps / a, 0.0021);
  EXPECT_NEAR(robot.StateAt(stands_us).in_map.x_m - from_m,
              p.speed_mps * delay_s + p.speed_mps * p.speed_mps / (2.0 * a),
              0.0021 * p.speed_mps);
}

INSTANTIATE_TEST_SUITE_P(Vehicles,
                         RobotBrakingTest,
                         testing::Values(Braking{0.5, 1.0, 1.0, 100'000},
                                         Braking{1.0, 1.0, 1.0, 100'000},
                                         Braking{2.0, 0.7, 1.0, 0},
                                         Braking{1.0, 2.0, 0.5, 350'000},
                                         Braking{0.3, 0.5, 3.0, 20'000}));

TEST(Robot, StandsWhenPermitsStopComing) {
  RobotConfig config = Driving(DriveMode::kStraight);
  config.obey_permit = true;
  Robot robot(config, Vehicle(), SceneConfig{});
  Permit(robot, 0, 5 * kSecond, 1.0);
  const std::int64_t last_us = 5 * kSecond - 20'000;

  const std::int64_t stands_us = StandsAt(robot, last_us);

  // 0.1 s of validity, 0.1 s of actuation, 0.5 / 1.0 of braking; 1 ms of step at either end.
  EXPECT_NEAR(static_cast<double>(stands_us - last_us), 700'000.0, 2'100.0);
}

TEST(Robot, DoesNotMoveBeforeItsFirstPermit) {
  RobotConfig config = Driving(DriveMode::kStraight);
  config.obey_permit = true;
  Robot robot(config, Vehicle(), SceneConfig{});

  EXPECT_EQ(robot.StateAt(10 * kSecond).driven_m, 0.0);
}

TEST(Robot, ObeysTheFirstOfTwoPublishersOfPermits) {
  RobotConfig config = Driving(DriveMode::kStraight);
  config.obey_permit = true;
  Robot robot(config, Vehicle(), SceneConfig{});

  for (std::int64_t t = 0; t < 5 * kSecond; t += 20'000) {
    robot.OnPermit(PermitOf(t / 20'000, t, 0.0), t);
    BasePermit other = PermitOf(t / 20'000, t, 1.0);
    other.session = 2;
    robot.OnPermit(other, t + 1000);
  }

  EXPECT_EQ(robot.StateAt(5 * kSecond).driven_m, 0.0);
  EXPECT_EQ(robot.gate().num_foreign_permits(), 250);
}

TEST(Robot, IsTheSameHoweverOftenItIsAsked) {
  RobotConfig config = Driving(DriveMode::kPath);
  config.waypoints = {{2.0, 0.0}, {2.0, 2.0}, {0.0, 0.3}};
  Robot often(config, Vehicle(), SceneConfig{});
  Robot once(config, Vehicle(), SceneConfig{});

  for (std::int64_t t = 0; t <= 20 * kSecond; t += 337) (void)often.StateAt(t);

  EXPECT_EQ(often.StateAt(20 * kSecond), once.StateAt(20 * kSecond));
}

TEST(Robot, RemembersWhereItWas) {
  Robot robot(Driving(DriveMode::kStraight), Vehicle(), SceneConfig{});
  const RobotState then = robot.StateAt(1'500'300);

  robot.AdvanceTo(3 * kSecond);

  EXPECT_EQ(robot.StateAt(1'500'300), then);
  EXPECT_GT(robot.StateAt(0).in_map.x_m, 0.0) << "longer ago than it remembers";
}

TEST(Robot, DrivesItsPathAndStandsAtTheEnd) {
  RobotConfig config = Driving(DriveMode::kPath);
  config.waypoints = {{2.0, 0.0}, {2.0, 2.0}, {-1.0, 2.0}};
  Robot robot(config, Vehicle(), SceneConfig{});
  double furthest_m = 0.0;

  for (std::int64_t t = 0; t < 40 * kSecond; t += 10'000) {
    const PlanarPose pose = robot.StateAt(t).in_map;
    const double off_m =
        std::min({std::hypot(pose.x_m - std::clamp(pose.x_m, 0.0, 2.0), pose.y_m),
                  std::hypot(pose.x_m - 2.0, pose.y_m - std::clamp(pose.y_m, 0.0, 2.0)),
                  std::hypot(pose.x_m - std::clamp(pose.x_m, -1.0, 2.0), pose.y_m - 2.0)});
    furthest_m = std::max(furthest_m, off_m);
  }

  const RobotState end = robot.StateAt(40 * kSecond);
  EXPECT_TRUE(robot.has_arrived());
  EXPECT_FALSE(end.IsMoving());
  EXPECT_NEAR(end.in_map.x_m, -1.0, 0.03);
  EXPECT_NEAR(end.in_map.y_m, 2.0, 0.05);
  EXPECT_LT(furthest_m, 0.25) << "of the corners it cuts half a lookahead";
}

TEST(Robot, TurnsOnTheSpotForAWaypointBehindIt) {
  RobotConfig config = Driving(DriveMode::kPath);
  config.waypoints = {{-2.0, 0.0}};
  Robot robot(config, Vehicle(), SceneConfig{});

  double most_forward_m = 0.0;
  for (std::int64_t t = 0; t < 20 * kSecond; t += 10'000) {
    most_forward_m = std::max(most_forward_m, robot.StateAt(t).in_map.x_m);
  }

  EXPECT_LT(most_forward_m, 0.02);
  EXPECT_NEAR(robot.StateAt(20 * kSecond).in_map.x_m, -2.0, 0.03);
}

TEST(Robot, GoesRoundALoopForEver) {
  RobotConfig config = Driving(DriveMode::kPath);
  config.waypoints = {{2.0, 0.0}, {2.0, 2.0}, {0.0, 2.0}, {0.0, 0.0}};
  config.loop = true;
  Robot robot(config, Vehicle(), SceneConfig{});

  const RobotState end = robot.StateAt(120 * kSecond);

  EXPECT_FALSE(robot.has_arrived());
  EXPECT_GT(end.driven_m, 45.0);
  EXPECT_GT(end.in_map.yaw_rad, 4.0 * std::numbers::pi) << "turns are counted";
}

TEST(Robot, EndsAnOrderThatStopsComing) {
  Robot robot(Driving(DriveMode::kRequest), Vehicle(), SceneConfig{});
  for (std::int64_t t = 0; t < 2 * kSecond; t += 50'000) {
    robot.OnOrder({1, t / 50'000, kEpoch_us + t, {0.5, 0.0}}, t);
  }
  const std::int64_t last_us = 2 * kSecond - 50'000;
  EXPECT_EQ(robot.StateAt(last_us).v_mps, 0.5);

  const std::int64_t stands_us = StandsAt(robot, last_us);

  EXPECT_NEAR(static_cast<double>(stands_us - last_us), 200'000 + 100'000 + 500'000, 2'100.0);
}

// Slip of one wheel only turns; odometry, which the wheels tell, knows nothing of it.
TEST(Robot, SlipsByTheShareOfEachWheelWithinItsTimes) {
  RobotConfig config = Driving(DriveMode::kStraight);
  config.wheel_slips = {{{.from_s = 2.0, .to_s = 3.0}, 0.1, 0.0}};
  Robot robot(config, Vehicle(), SceneConfig{});

  const RobotState before = robot.StateAt(2 * kSecond);
  const RobotState during = robot.StateAt(2 * kSecond + kSecond / 2);
  const RobotState end = robot.StateAt(4 * kSecond);

  EXPECT_EQ(before.in_map, before.in_odom);
  // Left 0.45, right 0.5 m/s on a track of 0.4 m.
  EXPECT_NEAR(during.w_radps, 0.05 / 0.4, 1e-9);
  EXPECT_NEAR(during.v_mps, 0.475, 1e-9);
  EXPECT_NEAR(end.in_map.yaw_rad, 0.05 / 0.4, 1e-9);
  EXPECT_EQ(end.in_odom.yaw_rad, 0.0);
  EXPECT_NEAR(end.in_odom.x_m - before.in_odom.x_m, 1.0, 1e-9);
  EXPECT_EQ(end.w_radps, 0.0);
}

TEST(Robot, SpinsOnTheSpotWithoutAnyGrip) {
  RobotConfig config = Driving(DriveMode::kStraight);
  config.wheel_slips = {{{}, 1.0, 1.0}};
  Robot robot(config, Vehicle(), SceneConfig{});

  const RobotState state = robot.StateAt(5 * kSecond);

  EXPECT_EQ(state.in_map, PlanarPose{});
  EXPECT_GT(state.in_odom.x_m, 2.0);
}

// First order: 63 % after the lag, then steady at dive * deceleration, then back.
TEST(Robot, DivesWhenBraking) {
  constexpr double kDegree = std::numbers::pi / 180.0;
  VehicleConfig vehicle = Vehicle();
  RobotConfig config = Driving(DriveMode::kStraight);
  config.obey_permit = true;
  config.speed_mps = 1.0;
  config.dive_rad_per_mps2 = 2.0 * kDegree;
  Robot robot(config, vehicle, SceneConfig{});
  Permit(robot, 0, 5 * kSecond, 1.0);
  EXPECT_NEAR(robot.StateAt(5 * kSecond - 20'000).pitch_rad, 0.0, 1e-6);

  robot.OnPermit(PermitOf(1000, 5 * kSecond, 0.0), 5 * kSecond);

  const std::int64_t brakes_us = 5 * kSecond + vehicle.actuation_us;
  EXPECT_NEAR(robot.StateAt(brakes_us + config.dive_lag_us).pitch_rad,
              (1.0 - std::exp(-1.0)) * 2.0 * kDegree,
              0.03 * kDegree);
  EXPECT_NEAR(robot.StateAt(brakes_us + 900'000).pitch_rad, 2.0 * kDegree, 0.01 * kDegree);
  EXPECT_LT(
      (robot.StateAt(brakes_us + 900'000).T_map_body().linear() * Eigen::Vector3d::UnitX()).z(),
      0.0)
      << "it looks down";
  EXPECT_NEAR(robot.StateAt(brakes_us + 3 * kSecond).pitch_rad, 0.0, 1e-6);
}

TEST(Robot, StandsAtAContactAndCountsItOnce) {
  Robot robot(Driving(DriveMode::kStraight), Vehicle(), BoxAhead(2.0));

  const RobotState end = robot.StateAt(20 * kSecond);

  // The box begins at 1.85 m, the robot ends 0.25 m ahead of its origin.
  EXPECT_NEAR(end.in_map.x_m, 1.6, 0.001);
  EXPECT_LE(end.in_map.x_m, 1.6);
  EXPECT_EQ(end.v_mps, 0.0);
  ASSERT_EQ(robot.contacts().size(), 1U);
  EXPECT_EQ(robot.NameOf(robot.contacts()[0].object), "box");
  EXPECT_NEAR(robot.contacts()[0].speed_mps, 0.5, 1e-9);
  EXPECT_NEAR(static_cast<double>(robot.contacts()[0].time_us),
              1e6 * (0.1 + 0.5 / 0.8 + (1.6 - 0.25 / 1.6) / 0.5),
              2000.0);
  EXPECT_EQ(robot.nearest().distance_m, 0.0);
}

TEST(Robot, CountsAContactAnewAfterItWasAway) {
  Robot robot(Driving(DriveMode::kCommand), Vehicle(), BoxAhead(2.0));
  const auto drive = [&robot](std::int64_t from_s, std::int64_t to_s, double v_mps) {
    for (std::int64_t t = from_s * kSecond; t < to_s * kSecond; t += 50'000) {
      robot.OnOrder({1, t / 50'000, kEpoch_us + t, {v_mps, 0.0}}, t);
    }
  };

  drive(0, 10, 0.5);
  EXPECT_TRUE(robot.touched());
  drive(10, 12, -0.4);
  EXPECT_FALSE(robot.touched());
  EXPECT_EQ(robot.contacts().size(), 1U);
  drive(12, 20, 0.5);

  EXPECT_EQ(robot.contacts().size(), 2U);
}

TEST(Robot, IsTouchedByWhatComesToIt) {
  SceneConfig scene;
  ScenePerson person;
  person.object.name = "walker";
  person.object.x_m = 3.0;
  person.object.speed_mps = 1.0;
  person.object.waypoints = {{0.0, 0.0, 0.0}};
  scene.persons.push_back(person);
  Robot robot(RobotConfig{}, Vehicle(), scene);

  robot.AdvanceTo(10 * kSecond);

  ASSERT_EQ(robot.contacts().size(), 1U);
  EXPECT_EQ(robot.NameOf(robot.contacts()[0].object), "walker");
  EXPECT_EQ(robot.contacts()[0].speed_mps, 0.0);
  // Its legs come; its trunk would pass above the robot. They lie within 0.25 m of its middle.
  EXPECT_GE(robot.contacts()[0].time_us, 2'500'000);
  EXPECT_LE(robot.contacts()[0].time_us, 2'700'000);
}

TEST(Robot, TellsTheLeastDistance) {
  SceneConfig scene;
  SceneCylinder post;
  post.object.name = "post";
  post.object.x_m = 2.0;
  post.object.y_m = 0.6;
  post.radius_m = 0.1;
  scene.cylinders.push_back(post);
  Robot robot(Driving(DriveMode::kStraight), Vehicle(), scene);

  robot.AdvanceTo(10 * kSecond);

  EXPECT_NEAR(robot.nearest().distance_m, 0.3, 1e-9);
  EXPECT_EQ(robot.NameOf(robot.nearest().object), "post");
  EXPECT_TRUE(robot.contacts().empty());
}

TEST(Robot, DrivesOverWhatIsLowAndUnderWhatIsHigh) {
  SceneConfig scene = BoxAhead(2.0);
  scene.boxes[0].height_m = 0.02;
  scene.boxes.push_back(scene.boxes[0]);
  scene.boxes[1].object.name = "lamp";
  scene.boxes[1].object.z_m = 0.7;
  Robot robot(Driving(DriveMode::kStraight), Vehicle(), scene);

  robot.AdvanceTo(8 * kSecond);

  EXPECT_TRUE(robot.contacts().empty());
  EXPECT_GT(robot.StateAt(8 * kSecond).in_map.x_m, 3.0);
}

TEST(Robot, StopsAtAHole) {
  SceneConfig scene;
  SceneHole hole;
  hole.object.name = "hole";
  hole.object.x_m = 2.0;
  scene.holes.push_back(hole);
  Robot robot(Driving(DriveMode::kStraight), Vehicle(), scene);

  robot.AdvanceTo(10 * kSecond);

  ASSERT_EQ(robot.contacts().size(), 1U);
  EXPECT_EQ(robot.NameOf(robot.contacts()[0].object), "hole");
}

TEST(Robot, StopsAtAWallOfTheMap) {
  MapWalls walls;
  walls.grid.geometry = {.width = 100, .height = 100, .origin_x_m = -1.0, .origin_y_m = -2.5};
  walls.grid.cells.assign(10'000, OccupancyGrid::kFree);
  for (int row = 0; row < 100; ++row) {
    walls.grid.cells[walls.grid.geometry.IndexOf({60, row})] = OccupancyGrid::kOccupied;
  }
  Robot robot(Driving(DriveMode::kStraight), Vehicle(), SceneConfig{}, walls);

  const RobotState end = robot.StateAt(20 * kSecond);

  EXPECT_NEAR(end.in_map.x_m, 2.0 - 0.25, 0.001);
  ASSERT_EQ(robot.contacts().size(), 1U);
  EXPECT_EQ(robot.contacts()[0].object, kMapObject);
}

TEST(Robot, TellsTheLeastDistanceToTheWallsOfTheMapAlone) {
  MapWalls walls;
  walls.grid.geometry = {.width = 400, .height = 100, .origin_x_m = -1.0, .origin_y_m = -2.5};
  walls.grid.cells.assign(40'000, OccupancyGrid::kFree);
  for (int column = 200; column < 400; ++column) {
    walls.grid.cells[walls.grid.geometry.IndexOf({column, 70})] = OccupancyGrid::kOccupied;
  }
  Robot robot(Driving(DriveMode::kStraight), Vehicle(), SceneConfig{}, walls);
  EXPECT_EQ(robot.nearest().object, kNoObject) << "it is more than 5 m away";

  robot.AdvanceTo(30 * kSecond);

  // The wall's face is at y = 1.0 m, the robot's left side at 0.2 m.
  EXPECT_EQ(robot.nearest().object, kMapObject);
  EXPECT_NEAR(robot.nearest().distance_m, 0.8, 1e-6);
  EXPECT_TRUE(robot.contacts().empty());
}

TEST(Robot, RefusesAPathWithoutWaypoints) {
  RobotConfig config;
  config.drive = DriveMode::kPath;
  EXPECT_EQ(config.Validate().size(), 1U);
  config.waypoints = {{1.0, 0.0}};
  EXPECT_TRUE(config.Validate().empty());
  config.loop = true;
  EXPECT_EQ(config.Validate().size(), 1U);
  config.waypoints = {{1.0, 0.0}, {1.0, 0.0}};
  EXPECT_EQ(config.Validate().size(), 1U);
}

}  // namespace
}  // namespace clearway::core
