// SPDX-License-Identifier: BSD-3-Clause
// The simulator in virtual time: what it publishes and how its robot obeys.
#include <cmath>
#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "common/messages/odometry.hpp"
#include "common/messages/pose.hpp"
#include "common/net/memory_network.hpp"
#include "common/process/simulated_runtime.hpp"
#include "processes/livox_driver/livox_driver_process.hpp"
#include "processes/simulator/simulator_process.hpp"

namespace clearway::test {
namespace {

using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Pair;
namespace channels = messages::channels;

constexpr std::int64_t kStart_utime = 1'600'000'000'037'000;  // Not on the grid of scans.
constexpr std::int64_t kSecond = 1'000'000;

core::SceneConfig Room() {
  core::SceneConfig scene;
  core::SceneBox box;
  box.object.name = "crate";
  box.object.x_m = 3.0;
  box.object.on_map = true;
  scene.boxes.push_back(box);
  core::ScenePerson person;
  person.object.name = "walker";
  person.object.x_m = 4.0;
  person.object.y_m = 2.0;
  person.object.speed_mps = 1.0;
  person.object.waypoints = {{4.0, -20.0, 0.0}};
  scene.persons.push_back(person);
  return scene;
}

/// A simulator on a bus and a network in memory, and what it says.
class Lab {
 public:
  explicit Lab(const core::SimulatorConfig& config, const core::SceneConfig& scene = Room())
      : runtime_(kStart_utime, {}),
        wire_(runtime_),
        host_(wire_, {}),
        peer_(runtime_,
              {.process = "peer", .version = "", .config_digest = ""},
              channels::kPlayStatus),
        node_(runtime_,
              {.process = "simulator", .version = "1", .config_digest = "d"},
              channels::kSimulatorStatus) {
    runtime_.SetTap(
        [this](messages::BusId, const std::string& channel, std::span<const std::byte> bytes) {
          if (channel == "PLAY_STATUS") return;
          log_ += channel + '\0';
          log_.append(reinterpret_cast<const char*>(bytes.data()), bytes.size());
        });
    peer_.Subscribe<odometry_t>(channels::kOdometry, [this](const auto& m) {
      odometry_.push_back({Now(), m});
    });
    peer_.Subscribe<pose_t>(channels::kPose, [this](const auto& m) {
      poses_.push_back({Now(), m});
    });
    peer_.Subscribe<pose_status_t>(channels::kPoseStatus,
                                   [this](const auto& m) { pose_statuses_.push_back(m); });
    peer_.Subscribe<truth_t>(channels::kTruth, [this](const auto& m) {
      truths_.push_back({Now(), m});
    });
    peer_.Subscribe<status_t>(channels::kSimulatorStatus, [this](const auto& m) { status_ = m; });
    simulator_ = std::make_unique<SimulatorProcess>(
        config, vehicle_, SimulatorProcess::Setting{scene, std::nullopt, 100'000}, node_, host_);
  }

  /// World time.
  [[nodiscard]] std::int64_t Now() const { return runtime_.UtimeNow() - kStart_utime; }
  void RunUntil(std::int64_t time_us) { runtime_.RunUntil(kStart_utime + time_us); }

  /// Permits at 50 Hz from now until before `to_us`.
  void Permit(std::int64_t to_us, double forward_mps, std::int64_t session = 1) {
    while (Now() < to_us) {
      SendPermit(forward_mps, session);
      RunUntil(Now() + 20'000);
    }
  }

  void SendPermit(double forward_mps, std::int64_t session = 1) {
    drive_permit_t permit{};
    permit.utime = runtime_.UtimeNow();
    permit.session = session;
    permit.sequence = next_permit_[session]++;
    permit.valid_us = 100'000;
    permit.forward_mps = permit.backward_mps = forward_mps;
    permit.turn_left_radps = permit.turn_right_radps = 1.0;
    permit.text = forward_mps > 0.0 ? "free" : "obstacle";
    permit.free_distance_m = 0.62;
    runtime_.Publish(messages::BusId::kLocal, "DRIVE_PERMIT", messages::Encode(permit));
  }

  template <typename Message>
  void SendOrder(const messages::Channel<Message>& channel, double v_mps) {
    Message order{};
    order.utime = runtime_.UtimeNow();
    order.v_mps = v_mps;
    peer_.Publish(channel, order);
  }

  [[nodiscard]] std::int64_t Counter(const std::string& name) {
    node_.RefreshAndPublishStatus();
    RunUntil(Now());
    for (const counter_t& counter : status_.counters) {
      if (counter.name == name) return counter.value;
    }
    return -999;
  }

  /// When the robot first stands at or after `from_us`, by ODOMETRY.
  [[nodiscard]] std::int64_t StandsAt(std::int64_t from_us) const {
    for (const auto& [time_us, message] : odometry_) {
      if (time_us >= from_us && message.v_mps == 0.0) return time_us;
    }
    return -1;
  }

  core::VehicleConfig vehicle_;
  process::SimulatedRuntime runtime_;
  net::MemoryWire wire_;
  net::MemoryHost host_;
  process::Node peer_;
  process::Node node_;
  std::string log_;
  std::vector<std::pair<std::int64_t, odometry_t>> odometry_;
  std::vector<std::pair<std::int64_t, pose_t>> poses_;
  std::vector<pose_status_t> pose_statuses_;
  std::vector<std::pair<std::int64_t, truth_t>> truths_;
  status_t status_{};
  std::map<std::int64_t, std::int64_t> next_permit_;
  std::unique_ptr<SimulatorProcess> simulator_;
};

core::SimulatorConfig Config(core::DriveMode drive) {
  core::SimulatorConfig config;
  config.robot.drive = drive;
  config.sensors.clear();
  return config;
}

// Everything random at once.
core::SimulatorConfig WithErrors() {
  core::SimulatorConfig config = Config(core::DriveMode::kPath);
  config.robot.waypoints = {{2.0, 0.5}, {0.0, 2.0}};
  config.robot.wheel_slips = {{{.from_s = 2.0, .to_s = 3.0}, 0.3, 0.1}};
  config.robot.pose_errors.resize(1);
  config.robot.pose_errors[0].noise_m = 0.1;
  config.robot.pose_errors[0].loss = 0.2;
  config.robot.pose_errors[0].delay_us = 35'000;
  config.robot.odometry_errors.resize(1);
  config.robot.odometry_errors[0].noise_mps = 0.1;
  config.robot.odometry_errors[0].loss = 0.1;
  return config;
}

TEST(SimulatedLab, SaysTheSameBytesForTheSameSeedAndMessages) {
  const auto run = [](int seed) {
    core::SimulatorConfig config = WithErrors();
    config.seed = seed;
    Lab lab(config);
    lab.Permit(5 * kSecond, 0.8);
    return lab.log_;
  };

  const std::string first = run(1);

  EXPECT_GT(first.size(), 10'000U);
  EXPECT_EQ(run(1), first);
  EXPECT_NE(run(2), first);
}

TEST(SimulatedLab, PublishesOdometryAt50HzOnAGridOfItsTime) {
  Lab lab(Config(core::DriveMode::kStill));

  lab.RunUntil(2 * kSecond);

  ASSERT_EQ(lab.odometry_.size(), 100U);
  for (std::size_t i = 0; i < 100; ++i) {
    EXPECT_EQ(lab.odometry_[i].second.utime,
              kStart_utime + 20'000 * static_cast<std::int64_t>(i + 1));
    EXPECT_EQ(lab.odometry_[i].second.sequence, static_cast<std::int64_t>(i));
  }
}

TEST(SimulatedLab, PublishesTheTruePoseUnlessToldOtherwise) {
  core::SimulatorConfig config = Config(core::DriveMode::kStraight);
  config.robot.obey_permit = false;
  Lab lab(config);

  lab.RunUntil(3 * kSecond);

  ASSERT_EQ(lab.poses_.size(), 60U);
  ASSERT_EQ(lab.pose_statuses_.size(), 60U);
  EXPECT_EQ(lab.pose_statuses_.back().utime, lab.poses_.back().second.utime);
  EXPECT_EQ(lab.pose_statuses_.back().state, pose_status_t::STATE_GOOD);
  EXPECT_NEAR(lab.poses_.back().second.pos[0], lab.odometry_.back().second.pos[0], 1e-9);
  EXPECT_GT(lab.poses_.back().second.pos[0], 1.0);

  config.robot.publish_pose = false;
  Lab silent(config);
  silent.RunUntil(3 * kSecond);
  EXPECT_THAT(silent.poses_, IsEmpty());
  EXPECT_THAT(silent.pose_statuses_, IsEmpty());
}

TEST(SimulatedLab, DelaysPosesInOrderAndKeepsTheirStamps) {
  core::SimulatorConfig config = Config(core::DriveMode::kStill);
  config.robot.pose_errors.resize(1);
  config.robot.pose_errors[0].times = {.from_s = 1.0, .to_s = 2.0};
  config.robot.pose_errors[0].delay_us = 170'000;
  config.robot.pose_errors[0].claim = core::PoseClaim::kUncertain;
  Lab lab(config);

  lab.RunUntil(4 * kSecond);

  ASSERT_EQ(lab.poses_.size(), 80U);
  std::int64_t before = 0;
  for (const auto& [arrival_us, pose] : lab.poses_) {
    const std::int64_t time_us = pose.utime - kStart_utime;
    EXPECT_GT(pose.utime, before);
    before = pose.utime;
    if (time_us >= kSecond && time_us < 2 * kSecond) {
      EXPECT_EQ(arrival_us - time_us, 170'000);
    } else if (time_us < kSecond || time_us > 2 * kSecond + 170'000) {
      EXPECT_EQ(arrival_us, time_us);
    }
  }
  EXPECT_EQ(lab.pose_statuses_[30].state, pose_status_t::STATE_UNCERTAIN);
  EXPECT_EQ(lab.pose_statuses_[70].state, pose_status_t::STATE_GOOD);
}

TEST(SimulatedLab, CountsWhatItLosesOnPurpose) {
  core::SimulatorConfig config = Config(core::DriveMode::kStill);
  config.robot.pose_errors.resize(1);
  config.robot.pose_errors[0].loss = 0.3;
  config.robot.odometry_errors.resize(1);
  config.robot.odometry_errors[0].loss = 0.3;
  Lab lab(config);

  lab.RunUntil(20 * kSecond);

  const std::int64_t poses_lost = lab.Counter("poses_lost_on_purpose");
  EXPECT_EQ(static_cast<std::int64_t>(lab.poses_.size()) + poses_lost, 400);
  EXPECT_GT(poses_lost, 60);
  EXPECT_EQ(
      static_cast<std::int64_t>(lab.odometry_.size()) + lab.Counter("odometry_lost_on_purpose"),
      1000);
}

TEST(SimulatedLab, TellsTheTruthOnceAScanOnTheGridOfTheTimeOfDay) {
  Lab lab(Config(core::DriveMode::kStill));

  lab.RunUntil(2 * kSecond);

  ASSERT_GE(lab.truths_.size(), 19U);
  for (std::size_t i = 0; i < lab.truths_.size(); ++i) {
    const truth_t& truth = lab.truths_[i].second;
    EXPECT_EQ(truth.utime % 100'000, 0);
    EXPECT_EQ(truth.utime, (truth.scan_id + 1) * 100'000);
    EXPECT_LT(kStart_utime + lab.truths_[i].first - truth.utime, 100'000);
    EXPECT_EQ(truth.scan_id, lab.truths_[0].second.scan_id + static_cast<std::int64_t>(i));
    ASSERT_EQ(truth.n, 2);
    EXPECT_EQ(truth.objects[0].name, "crate");
    EXPECT_EQ(truth.objects[0].kind, "box");
    EXPECT_TRUE(truth.objects[0].on_map);
    EXPECT_EQ(truth.objects[1].name, "walker");
    EXPECT_FALSE(truth.objects[1].on_map);
    EXPECT_NEAR(truth.objects[1].velocity[1], -1.0, 1e-9);
    const double time_s = 1e-6 * static_cast<double>(truth.utime - kStart_utime);
    EXPECT_NEAR(truth.objects[1].center[1], 2.0 - time_s, 1e-6);
  }
}

TEST(SimulatedLab, StandsAfterDelayAndBrakingWhenThePermitIsZero) {
  Lab lab(Config(core::DriveMode::kStraight));
  lab.Permit(3 * kSecond, 1.0);
  EXPECT_EQ(lab.odometry_.back().second.v_mps, 0.5);

  lab.Permit(5 * kSecond, 0.0);

  // 0.1 s of actuation, 0.5 / 1.0 s of braking, up to 20 ms until ODOMETRY tells.
  const std::int64_t took_us = lab.StandsAt(3 * kSecond) - 3 * kSecond;
  EXPECT_GE(took_us, 600'000);
  EXPECT_LE(took_us, 622'000);
  (void)lab.Counter("contacts");
  EXPECT_EQ(lab.status_.text, "stands; permit 0.00 m/s: obstacle, 0.62 m ahead");
}

TEST(SimulatedLab, StandsWhenPermitsStopComing) {
  Lab lab(Config(core::DriveMode::kStraight));
  lab.Permit(3 * kSecond, 1.0);

  lab.RunUntil(5 * kSecond);

  // The last one came at 2.98 s and holds for 0.1 s.
  const std::int64_t took_us = lab.StandsAt(3 * kSecond) - 2'980'000;
  EXPECT_GE(took_us, 700'000);
  EXPECT_LE(took_us, 722'000);
  EXPECT_EQ(lab.status_.text, "stands; the permit has stopped coming");
  EXPECT_EQ(lab.status_.state, status_t::STATE_WAITING);
}

TEST(SimulatedLab, ObeysTheFirstOfTwoGuardsAndCountsTheOther) {
  Lab lab(Config(core::DriveMode::kStraight));

  for (int i = 0; i < 100; ++i) {
    lab.SendPermit(0.0, 1);
    lab.SendPermit(1.0, 2);
    lab.RunUntil(lab.Now() + 20'000);
  }

  EXPECT_EQ(lab.odometry_.back().second.pos[0], 0.0);
  EXPECT_EQ(lab.Counter("permits_foreign"), 100);
}

TEST(SimulatedLab, FollowsRequestsOrCommandsAsConfigured) {
  Lab requests(Config(core::DriveMode::kRequest));
  Lab commands(Config(core::DriveMode::kCommand));
  for (int i = 0; i < 100; ++i) {
    for (Lab* const lab : {&requests, &commands}) {
      lab->SendPermit(1.0);
      lab->SendOrder(channels::kDriveRequest, 0.3);
      lab->SendOrder(channels::kDriveCommand, 0.4);
      lab->RunUntil(lab->Now() + 20'000);
    }
  }

  EXPECT_EQ(requests.odometry_.back().second.v_mps, 0.3);
  EXPECT_EQ(commands.odometry_.back().second.v_mps, 0.4);
}

TEST(SimulatedLab, SaysThatItTouchedSomethingAtOnce) {
  core::SimulatorConfig config = Config(core::DriveMode::kStraight);
  config.robot.obey_permit = false;
  core::SceneConfig scene = Room();
  scene.persons.clear();
  Lab lab(config, scene);

  lab.RunUntil(10 * kSecond);

  EXPECT_THAT(lab.status_.text, HasSubstr("touches crate"));
  EXPECT_EQ(lab.status_.state, status_t::STATE_DEGRADED);
  EXPECT_EQ(lab.Counter("contacts"), 1);
  EXPECT_EQ(lab.Counter("nearest_mm"), 0);
  // The crate begins at 2.85 m; the robot ends 0.3 m ahead of its origin.
  EXPECT_NEAR(static_cast<double>(lab.Counter("driven_mm")), 2550.0, 2.0);
}

TEST(SimulatedLab, CountsPermitsThatCannotBeDecoded) {
  Lab lab(Config(core::DriveMode::kStraight));

  lab.runtime_.Publish(messages::BusId::kLocal, "DRIVE_PERMIT", std::vector<std::byte>(7));
  lab.RunUntil(2 * kSecond);

  EXPECT_EQ(lab.status_.invalid, 1);
  EXPECT_EQ(lab.odometry_.back().second.v_mps, 0.0);
}

/// The lab with the driver of its one sensor on the same host.
struct LabWithDriver {
  explicit LabWithDriver(const core::SimulatorConfig& config,
                         const core::SceneConfig& scene = Room())
      : lab(config, scene),
        node(lab.runtime_,
             {.process = "livox_driver", .version = "1", .config_digest = "d"},
             channels::kLivoxDriverStatus),
        driver(core::livox::DriverConfig{}, lab.vehicle_, node, lab.host_) {
    lab.peer_.Subscribe<lidar_points_t>(channels::kLidarPoints,
                                        [this](const auto& m) { slices.push_back(m); });
  }

  Lab lab;
  process::Node node;
  LivoxDriverProcess driver;
  std::vector<lidar_points_t> slices;
};

core::SimulatorConfig WithSensor(core::DriveMode drive) {
  core::SimulatorConfig config = Config(drive);
  config.sensors.resize(1);
  return config;
}

TEST(SimulatedLab, ItsSensorAndDriverSayTheSameBytesForTheSameSeed) {
  const auto run = [](int seed) {
    core::SimulatorConfig config = WithSensor(core::DriveMode::kStraight);
    config.robot.obey_permit = false;
    config.seed = seed;
    LabWithDriver lab(config);
    lab.lab.RunUntil(4 * kSecond);
    EXPECT_GT(lab.slices.size(), 100U);
    return lab.lab.log_;
  };

  const std::string first = run(1);

  EXPECT_EQ(run(1), first);
  EXPECT_NE(run(2), first);
}

// The driver's returns that lie on an object, counted by its box, against TRUTH.
TEST(SimulatedLab, TruthCountsTheRaysThatTheDriverPublishes) {
  core::SimulatorConfig config = WithSensor(core::DriveMode::kStill);
  config.lidar.noise_sigma_m = 0.001;
  core::SceneConfig scene = Room();
  scene.persons.clear();
  LabWithDriver lab(config, scene);

  lab.lab.RunUntil(6 * kSecond);

  std::map<std::int64_t, std::int32_t> points;
  const Eigen::Isometry3d T_vehicle_sensor = lab.lab.vehicle_.sensors[0].T_vehicle_sensor();
  for (const lidar_points_t& slice : lab.slices) {
    std::int32_t& count = points[slice.scan_id];
    for (std::size_t i = 0; i < static_cast<std::size_t>(slice.n); ++i) {
      const Eigen::Vector3d p =
          T_vehicle_sensor * Eigen::Vector3d(slice.x[i], slice.y[i], slice.z[i]);
      if (std::abs(p.x() - 3.0) < 0.2 && std::abs(p.y()) < 0.2 && p.z() > 0.05) ++count;
    }
  }
  int scans = 0;
  int of_truth = 0;
  int of_driver = 0;
  for (const auto& [time_us, truth] : lab.lab.truths_) {
    if (time_us < 4 * kSecond) continue;
    ASSERT_EQ(truth.objects[0].name, "crate");
    EXPECT_GT(truth.objects[0].points, 20);
    // The driver's stamps may be off by 1 ms, 100 shots; not all of them hit the crate.
    EXPECT_NEAR(truth.objects[0].points, points[truth.scan_id], 40) << truth.scan_id;
    of_truth += truth.objects[0].points;
    of_driver += points[truth.scan_id];
    EXPECT_LT(truth.objects[0].first_ray_utime, kStart_utime + 4 * kSecond);
    EXPECT_GT(truth.objects[0].first_ray_utime, kStart_utime);
    ++scans;
  }
  EXPECT_GE(scans, 18);
  EXPECT_NEAR(of_truth, of_driver, 40);
}

TEST(SimulatedLab, SaysThatASensorWaitsForItsDriver) {
  Lab lab(WithSensor(core::DriveMode::kStill));
  lab.RunUntil(5 * kSecond);

  EXPECT_EQ(lab.status_.text, "stands; front at 127.0.0.2 waits for a driver");
  EXPECT_EQ(lab.status_.state, status_t::STATE_WAITING);
  EXPECT_TRUE(lab.status_.ready);

  LabWithDriver driven(WithSensor(core::DriveMode::kStill));
  driven.lab.RunUntil(5 * kSecond);

  EXPECT_EQ(driven.lab.status_.text, "stands");
  EXPECT_EQ(driven.lab.status_.state, status_t::STATE_OK);
  EXPECT_GT(driven.lab.Counter("packets"), 2000);
  EXPECT_EQ(driven.lab.Counter("packets_skipped"), 0);
}

TEST(SimulatedLab, RefusesASensorThatIsNotOnTheVehicle) {
  core::SimulatorConfig config = Config(core::DriveMode::kStill);
  config.sensors.resize(1);
  config.sensors[0].sensor = "rear";

  EXPECT_THROW(Lab{config}, std::invalid_argument);
}

}  // namespace
}  // namespace clearway::test
