// SPDX-License-Identifier: BSD-3-Clause
#include "common/core/guard/stop_guard.hpp"

#include <cmath>
#include <cstdint>
#include <functional>
#include <limits>
#include <numbers>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/count_allocations.hpp"
#include "tests/unit/scan/visit_check.hpp"

namespace clearway::core {
namespace {

using testing::IsEmpty;

constexpr std::int64_t kSlice_us = 10'000;
constexpr std::int64_t kEpoch_us = 1'600'000'000'000'000;

VehicleConfig Vehicle() {
  VehicleConfig vehicle;
  vehicle.sensors[0].x_m = 0.0;
  vehicle.sensors[0].z_m = 0.3;
  return vehicle;
}

// One sensor's stream of slices, and the other inputs, on one clock.
class Rig {
 public:
  explicit Rig(const VehicleConfig& vehicle = Vehicle(), const StopGuardConfig& config = {})
      : vehicle_(vehicle), guard(config, vehicle) {}

  // A slice with a wall far ahead and the given points, in the vehicle frame.
  Slice MakeSlice(const std::vector<Eigen::Vector3f>& points_vehicle) const {
    Slice slice;
    slice.sensor = 0;
    slice.session = session;
    slice.sequence = sequence;
    slice.scan_id = sequence / 10;
    slice.scan_utime = kEpoch_us + slice.scan_id * 10 * kSlice_us + stamp_shift_us;
    slice.scan_end_utime = slice.scan_utime + 10 * kSlice_us;
    slice.slice_index = static_cast<int>(sequence % 10);
    slice.slice_count = 10;
    slice.shots = 100;
    const Eigen::Isometry3f T_sensor_vehicle =
        vehicle_.sensors[0].T_vehicle_sensor().inverse().cast<float>();
    for (int i = 0; i < num_wall_points; ++i) {
      slice.cloud_sensor.Add(T_sensor_vehicle *
                             Eigen::Vector3f(20.0F, 0.1F * static_cast<float>(i), 0.5F));
    }
    for (const Eigen::Vector3f& p : points_vehicle) slice.cloud_sensor.Add(T_sensor_vehicle * p);
    return slice;
  }

  void Step(const std::vector<Eigen::Vector3f>& points_vehicle = {}) {
    now += kSlice_us;
    if (sends_odometry) guard.OnOdometry(v_mps, w_radps, now);
    if (sends_detections) guard.OnDetections(now, now);
    if (sends_slices) guard.OnSlice(MakeSlice(points_vehicle), now);
    if (!repeats_sequence) ++sequence;
  }
  Permit Run(int steps, const std::vector<Eigen::Vector3f>& points_vehicle = {}) {
    for (int i = 0; i < steps; ++i) Step(points_vehicle);
    return guard.PermitAt(now);
  }

  VehicleConfig vehicle_;
  StopGuard guard;
  std::int64_t now = 1'000'000;
  std::int64_t session = 1;
  std::int64_t sequence = 0;
  std::int64_t stamp_shift_us = 0;
  int num_wall_points = 20;
  double v_mps = 0.0;
  double w_radps = 0.0;
  bool sends_odometry = true;
  bool sends_detections = true;
  bool sends_slices = true;
  bool repeats_sequence = false;
};

bool AllZero(const Permit& permit) {
  return permit.forward_mps() == 0.0 && permit.backward_mps() == 0.0 &&
         permit.turn_left_radps() == 0.0 && permit.turn_right_radps() == 0.0;
}

std::vector<Eigen::Vector3f> Post(float x, float y, float z = 0.3F) {
  return {{x, y, z}, {x, y + 0.01F, z}, {x, y - 0.01F, z}};
}

TEST(StopGuardConfig, HasDefaultsWithinItsBounds) {
  EXPECT_THAT(test::FaultsOfDefaults<StopGuardConfig>(), IsEmpty());
  EXPECT_THAT(StopGuardConfig{}.Validate(), IsEmpty());
}

TEST(StopGuard, PermitsTopSpeedOnAFreeWayThatIsSeen) {
  Rig rig;

  const Permit permit = rig.Run(100);

  EXPECT_EQ(permit.reason, PermitReason::kFree);
  EXPECT_DOUBLE_EQ(permit.forward_mps(), rig.vehicle_.max_forward_mps);
  EXPECT_FALSE(permit.detections_missing);
}

TEST(StopGuard, PermitsLittleWhereNoSensorLooks) {
  Rig rig;

  const Permit permit = rig.Run(100);

  EXPECT_DOUBLE_EQ(permit.backward_mps(), StopGuardConfig{}.unseen_speed_mps);
  EXPECT_EQ(permit[Direction::kBackward].reason, PermitReason::kUnseen);
  EXPECT_EQ(permit[Direction::kTurnLeft].reason, PermitReason::kUnseen);
  EXPECT_GT(permit.turn_left_radps(), 0.0);
  EXPECT_LT(permit.turn_left_radps(), 0.3);
}

TEST(StopGuard, PermitsTopSpeedAllRoundWithASpinningSensor) {
  VehicleConfig vehicle = Vehicle();
  vehicle.sensors[0].field_of_view_rad = 2.0 * std::numbers::pi;
  Rig rig(vehicle);

  const Permit permit = rig.Run(100);

  EXPECT_DOUBLE_EQ(permit.backward_mps(), vehicle.max_backward_mps);
  EXPECT_DOUBLE_EQ(permit.turn_right_radps(), vehicle.max_turn_radps);
}

TEST(StopGuard, DoesNotTakeSlicesThatArePlayedAgainAndAgainForASensor) {
  Rig rig;
  rig.Run(100);

  for (int round = 0; round < 10; ++round) {
    rig.sequence = 0;
    rig.Run(20);  // The numbering has gone back for long enough to be believed.

    EXPECT_TRUE(AllZero(rig.guard.PermitAt(rig.now))) << round;
    rig.Run(80);
  }
}

TEST(StopGuard, DoesNotTakeSessionsThatChangeAllTheTimeForASensor) {
  Rig rig;
  rig.Run(100);

  for (int i = 0; i < 50; ++i) {
    ++rig.session;
    rig.sequence = 0;
    rig.Step();
    if (i > 0) {
      EXPECT_TRUE(AllZero(rig.guard.PermitAt(rig.now))) << i;
    }
  }
}

TEST(StopGuard, DoesNotBelieveASpeedThatTheVehicleCannotReach) {
  Rig rig;
  const double permitted_mps = rig.Run(50, Post(1.1F, 0.0F)).forward_mps();

  rig.v_mps = 2.5 * rig.vehicle_.max_forward_mps;
  const Permit permit = rig.Run(5);

  EXPECT_LE(permit.forward_mps(), permitted_mps) << "the post must not be carried past";
  EXPECT_EQ(rig.guard.counts().invalid_odometry, 5);
}

TEST(StopGuard, TakesDetectionsThatComeLateAsMissing) {
  Rig rig;
  rig.sends_detections = false;
  for (int i = 0; i < 300; ++i) {
    // A pipeline that falls behind: each second of scans takes two.
    rig.guard.OnDetections(rig.now / 2, rig.now);
    rig.Step();
  }

  EXPECT_TRUE(rig.guard.PermitAt(rig.now).detections_missing);
}

class StopGuardDistanceTest : public testing::TestWithParam<double> {};

TEST_P(StopGuardDistanceTest, PermitsTheSpeedFromWhichItStopsBeforeAPost) {
  const double distance_m = GetParam();
  Rig rig;

  const Permit permit = rig.Run(50, Post(static_cast<float>(0.3 + distance_m), 0.0F));

  const Braking braking{rig.vehicle_.deceleration_mps2,
                        rig.vehicle_.ReactionTime(),
                        StopGuardConfig{}.front_margin_m};
  const double expected = std::fmin(FreeSpeed(distance_m, braking), rig.vehicle_.max_forward_mps);
  EXPECT_NEAR(permit.forward_mps(), expected, 1e-5);
  if (expected < rig.vehicle_.max_forward_mps) {
    EXPECT_EQ(permit.reason, PermitReason::kObstacle);
    EXPECT_NEAR(permit[Direction::kForward].free_way, distance_m, 1e-5);
    EXPECT_NEAR(permit[Direction::kForward].cause_vehicle.x(), 0.3 + distance_m, 1e-5);
    EXPECT_NEAR(permit[Direction::kForward].cause_vehicle.z(), 0.3, 1e-5);
  }
  EXPECT_DOUBLE_EQ(permit.backward_mps(), StopGuardConfig{}.unseen_speed_mps) << "the way out";
}

INSTANTIATE_TEST_SUITE_P(Distances,
                         StopGuardDistanceTest,
                         testing::Values(0.01, 0.1, 0.11, 0.2, 0.4, 0.6, 0.9, 1.5, 5.0));

TEST(StopGuard, AnswersASuddenObstacleWithTheSliceThatShowsIt) {
  Rig rig;
  ASSERT_FALSE(rig.Run(100).is_closed());

  const Permit permit = rig.Run(1, Post(0.38F, 0.0F));

  EXPECT_EQ(permit.forward_mps(), 0.0);
}

TEST(StopGuard, HoldsAHitWhileTheSensorsPatternMissesItThenLetsGo) {
  Rig rig;
  rig.Run(100, Post(0.5F, 0.0F));

  EXPECT_EQ(rig.Run(49).reason, PermitReason::kObstacle);
  EXPECT_EQ(rig.Run(3).reason, PermitReason::kFree);
}

TEST(StopGuard, IgnoresWhatIsNotInTheWay) {
  for (const auto& points : {Post(1.0F, 0.4F), Post(0.6F, 0.0F, 0.02F), Post(0.6F, 0.0F, 0.9F)}) {
    Rig rig;
    EXPECT_EQ(rig.Run(100, points).reason, PermitReason::kFree) << points[0].transpose();
  }
}

TEST(StopGuard, IgnoresReturnsFromTheRobotItself) {
  VehicleConfig vehicle = Vehicle();
  vehicle.body = {{0.1, 0.3, -0.1, 0.1, 0.1, 0.4}};
  Rig rig(vehicle);

  EXPECT_EQ(rig.Run(100, Post(0.25F, 0.0F)).reason, PermitReason::kFree);
  EXPECT_EQ(rig.Run(100, Post(0.25F, 0.15F)).reason, PermitReason::kObstacle)
      << "inside the footprint, not on the body";
}

TEST(StopGuard, SeesAHoleWhereTheBeamPassesTheFloor) {
  Rig rig;
  // From the sensor at 0.3 m the beam passes z = 0 at x = 0.8 and ends 0.3 m below the floor.
  const Permit permit = rig.Run(100, Post(1.6F, 0.0F, -0.3F));

  ASSERT_EQ(permit.reason, PermitReason::kObstacle);
  EXPECT_NEAR(permit[Direction::kForward].free_way, 0.5, 1e-5);
  EXPECT_GT(rig.guard.counts().hole_points, 0);
}

TEST(StopGuard, ExpectsWhatItSawToComeNearerAsTheVehicleMoves) {
  Rig rig;
  rig.v_mps = 1.0;
  rig.Run(100);
  const double before = rig.Run(1, Post(1.5F, 0.0F))[Direction::kForward].free_way;

  const double after = rig.Run(30)[Direction::kForward].free_way;

  EXPECT_NEAR(before - after, 0.3, 0.011) << "one slice of motion";
}

TEST(StopGuard, SlowsDownWhileDetectionsAreMissing) {
  Rig rig;
  rig.sends_detections = false;

  const Permit permit = rig.Run(100);

  EXPECT_TRUE(permit.detections_missing);
  EXPECT_EQ(permit.reason, PermitReason::kNoDetections);
  EXPECT_DOUBLE_EQ(permit.forward_mps(), StopGuardConfig{}.degraded_speed_mps);
}

TEST(StopGuard, LetsNoHitExpireAndAssumesTopSpeedWhileOdometryIsMissing) {
  StopGuardConfig config;
  config.odometry_stop_us = 5'000'000;
  Rig rig(Vehicle(), config);
  rig.Run(100, Post(1.5F, 0.0F));
  rig.sends_odometry = false;

  const Permit permit = rig.Run(90);

  EXPECT_TRUE(permit.odometry_missing);
  EXPECT_EQ(permit.reason, PermitReason::kObstacle);
  EXPECT_NEAR(permit[Direction::kForward].free_way, 1.2 - 0.9, 1e-5);
}

TEST(StopGuard, NeedsNoOdometryWhereNothingMoves) {
  VehicleConfig vehicle = Vehicle();
  vehicle.stationary = true;
  Rig rig(vehicle);
  rig.sends_odometry = false;

  EXPECT_FALSE(rig.Run(100).is_closed());
}

TEST(StopGuard, GoesOnWithoutAnOptionalSensorButNotInItsDirection) {
  VehicleConfig vehicle = Vehicle();
  vehicle.sensors.push_back(vehicle.sensors[0]);
  vehicle.sensors[1].name = "rear";
  vehicle.sensors[1].yaw_rad = std::numbers::pi;
  vehicle.sensors[1].required = false;
  Rig rig(vehicle);

  const Permit permit = rig.Run(100);

  EXPECT_DOUBLE_EQ(permit.forward_mps(), vehicle.max_forward_mps);
  EXPECT_DOUBLE_EQ(permit.backward_mps(), StopGuardConfig{}.unseen_speed_mps);
}

// The fail-closed table: what goes wrong on a healthy graph, after how long at most the guard is
// closed, and what it says.
struct Fault {
  std::string name;
  std::function<void(Rig&)> begin;
  std::int64_t within_us;
  PermitReason reason;
};

void PrintTo(const Fault& fault, std::ostream* os) {
  *os << fault.name;
}

class StopGuardFaultTest : public testing::TestWithParam<Fault> {};

TEST_P(StopGuardFaultTest, ClosesInTime) {
  Rig rig;
  ASSERT_FALSE(rig.Run(200).is_closed());
  const std::int64_t begin_us = rig.now;

  GetParam().begin(rig);
  Permit permit = rig.guard.PermitAt(rig.now);
  while (!permit.is_closed() && rig.now - begin_us < 10'000'000) permit = rig.Run(1);

  EXPECT_LE(rig.now - begin_us, GetParam().within_us);
  EXPECT_EQ(permit.reason, GetParam().reason);
  EXPECT_TRUE(AllZero(permit));
  for (int i = 0; i < 100; ++i) EXPECT_TRUE(rig.Run(1).is_closed()) << "and stays closed";
}

INSTANTIATE_TEST_SUITE_P(FailClosed,
                         StopGuardFaultTest,
                         testing::Values(Fault{"driver dead",
                                               [](Rig& r) { r.sends_slices = false; },
                                               110'000,
                                               PermitReason::kSensorSilent},
                                         Fault{"an old slice again and again",
                                               [](Rig& r) {
                                                 r.repeats_sequence = true;
                                                 r.sequence -= 15;
                                               },
                                               110'000,
                                               PermitReason::kSensorSilent},
                                         Fault{"the same slice again and again",
                                               [](Rig& r) {
                                                 r.repeats_sequence = true;
                                                 r.sequence -= 1;
                                               },
                                               110'000,
                                               PermitReason::kSensorSilent},
                                         Fault{"lens covered",
                                               [](Rig& r) { r.num_wall_points = 0; },
                                               800'000,
                                               PermitReason::kNoReturns},
                                         Fault{"odometry dead",
                                               [](Rig& r) { r.sends_odometry = false; },
                                               510'000,
                                               PermitReason::kNoOdometry},
                                         Fault{"odometry not a number",
                                               [](Rig& r) {
                                                 r.v_mps = std::numeric_limits<double>::quiet_NaN();
                                               },
                                               510'000,
                                               PermitReason::kNoOdometry}),
                         [](const testing::TestParamInfo<Fault>& fault) {
                           std::string name = fault.param.name;
                           for (char& c : name) {
                             if (c == ' ') c = '_';
                           }
                           return name;
                         });

TEST(StopGuard, PermitsNothingBeforeAnythingHasArrived) {
  StopGuard guard({}, Vehicle());

  const Permit permit = guard.PermitAt(123'456);

  EXPECT_TRUE(AllZero(permit));
  EXPECT_EQ(permit.reason, PermitReason::kStarting);
  EXPECT_EQ(permit.sensor, 0);
}

TEST(StopGuard, PermitsNothingUntilEveryRequiredSensorIsHeard) {
  VehicleConfig vehicle = Vehicle();
  vehicle.sensors.push_back(vehicle.sensors[0]);
  vehicle.sensors[1].name = "rear";
  Rig rig(vehicle);

  const Permit permit = rig.Run(100);

  EXPECT_TRUE(AllZero(permit));
  EXPECT_EQ(permit.reason, PermitReason::kStarting);
  EXPECT_EQ(permit.sensor, 1);
}

TEST(StopGuard, PermitsNothingBeforeOdometry) {
  Rig rig;
  rig.sends_odometry = false;

  EXPECT_EQ(rig.Run(100).reason, PermitReason::kNoOdometry);
}

TEST(StopGuard, ClosesWhileALatePipelineDrainsItsQueue) {
  Rig rig;
  ASSERT_FALSE(rig.Run(200).is_closed());

  // Everything stands still for a second; then the slices of that second come in quick order.
  rig.now += 1'000'000;
  rig.guard.OnOdometry(0.0, 0.0, rig.now);
  EXPECT_EQ(rig.guard.PermitAt(rig.now).reason, PermitReason::kSensorSilent);
  for (int i = 0; i < 85; ++i) {
    rig.now += 200;
    rig.guard.OnSlice(rig.MakeSlice({}), rig.now);
    ++rig.sequence;
    EXPECT_EQ(rig.guard.PermitAt(rig.now).reason, PermitReason::kSlicesLate);
  }
}

TEST(StopGuard, ClosesWhenAStageIsSteadilyTooSlow) {
  Rig rig;
  ASSERT_FALSE(rig.Run(200).is_closed());

  // Each slice takes 12 ms for 10 ms of measurement.
  int slices = 0;
  while (!rig.Run(1).is_closed() && slices < 1000) {
    rig.now += 2000;
    ++slices;
  }

  EXPECT_EQ(rig.guard.PermitAt(rig.now).reason, PermitReason::kSlicesLate);
  EXPECT_LE(slices * 2000, 110'000);
}

TEST(StopGuard, ClosesForTwoPublishersOfOneSensor) {
  Rig rig;
  ASSERT_FALSE(rig.Run(200).is_closed());

  for (int i = 0; i < 10; ++i) {
    rig.session = 1 + i % 2;
    rig.Step();
  }

  EXPECT_EQ(rig.guard.PermitAt(rig.now).reason, PermitReason::kTwoPublishers);
}

TEST(StopGuard, OpensAgainAfterTheDriverWasRestarted) {
  Rig rig;
  rig.Run(200);
  rig.sends_slices = false;
  ASSERT_TRUE(rig.Run(300).is_closed());
  rig.sends_slices = true;
  rig.session = 77;
  rig.sequence = 0;
  rig.stamp_shift_us = 5'000'000;

  EXPECT_FALSE(rig.Run(100).is_closed());
}

TEST(StopGuard, IgnoresNonsenseAndCountsIt) {
  Rig rig;
  Slice unknown = rig.MakeSlice({});
  unknown.sensor = 7;
  Slice invalid = rig.MakeSlice({});
  invalid.slice_count = 0;
  Slice uneven = rig.MakeSlice({});
  uneven.cloud_sensor.y.clear();

  for (const Slice& slice : {unknown, invalid, uneven}) rig.guard.OnSlice(slice, rig.now);
  rig.guard.OnOdometry(std::numeric_limits<double>::infinity(), 0.0, rig.now);

  EXPECT_EQ(rig.guard.PermitAt(rig.now).reason, PermitReason::kStarting);
  EXPECT_EQ(rig.guard.counts().unknown_sensor, 1);
  EXPECT_EQ(rig.guard.counts().invalid_slices, 2);
  EXPECT_EQ(rig.guard.counts().invalid_odometry, 1);
}

TEST(StopGuard, IsNotFooledByPointsThatAreNoReturns) {
  constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
  constexpr float kInf = std::numeric_limits<float>::infinity();
  Rig rig;
  rig.num_wall_points = 0;
  const Eigen::Vector3f origin(0.0F, 0.0F, 0.3F);  // The sensor: a zero return.
  std::vector<Eigen::Vector3f> points(100, origin);
  points.insert(points.end(), {{kNan, 0, 0}, {0, kInf, 0}, {kNan, kNan, kNan}, {1e30F, 0, 0}});

  const Permit permit = rig.Run(100, points);

  EXPECT_EQ(permit.reason, PermitReason::kNoReturns);
  EXPECT_EQ(rig.guard.counts().returns, 0);
}

TEST(StopGuard, AllocatesNothingForASliceOrAPermit) {
  Rig rig;
  std::vector<Eigen::Vector3f> points;
  for (int i = 0; i < 500; ++i) {
    points.emplace_back(
        0.4F + 0.005F * static_cast<float>(i), 0.001F * static_cast<float>(i % 200), 0.2F);
  }
  rig.Run(50, points);
  const Slice slice = rig.MakeSlice(points);

  const std::size_t before = test::NumAllocations();
  for (int i = 0; i < 100; ++i) {
    rig.guard.OnSlice(slice, rig.now);
    (void)rig.guard.PermitAt(rig.now + i);
  }

  EXPECT_EQ(test::NumAllocations(), before);
}

}  // namespace
}  // namespace clearway::core
