// SPDX-License-Identifier: BSD-3-Clause
// The driver in front of emulated sensors, in virtual time and on a network in memory.
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include <gmock/gmock.h>

#include "common/messages/channels.hpp"
#include "common/net/memory_network.hpp"
#include "common/process/node.hpp"
#include "common/process/simulated_runtime.hpp"
#include "processes/livox_driver/livox_driver_process.hpp"
#include "processes/simulator/emulated_sensor.hpp"

namespace clearway {
namespace {

using core::livox::CommandCode;
using testing::SizeIs;

constexpr std::int64_t kStart_utime = 1'700'000'000'037'000;  // Not on the grid of scans.
constexpr core::Ipv4 kHostIp = 0xC0A80132;
constexpr core::Ipv4 kFirstSensorIp = 0xC0A80165;
constexpr std::size_t kMaxSensors = 4;

std::string CodeOf(std::size_t index) {
  return "3GGDJ6K0010010" + std::to_string(index);
}

std::vector<core::Ipv4> SensorIps() {
  std::vector<core::Ipv4> ips;
  for (std::size_t i = 0; i <= kMaxSensors; ++i) {
    ips.push_back(kFirstSensorIp + static_cast<core::Ipv4>(i));
  }
  return ips;
}

// When each shot of a sensor left, told by its points: their x counts shots modulo this.
constexpr std::int64_t kShotModulo = 20'000;

class EmulatedSensorsTest : public testing::Test {
 protected:
  EmulatedSensorsTest() {
    runtime_.SetTap([this](messages::BusId, const std::string& channel, auto bytes) {
      if (channel != messages::channels::kLidarPoints.name) return;
      slices_.push_back({runtime_.UtimeNow(), *messages::Decode<lidar_points_t>(bytes)});
    });
    wire_.SetFilter([this](const auto& from, const auto& to, auto bytes) {
      OnWire(from, to, bytes);
      return std::optional<std::int64_t>(0);
    });
  }

  // A driver for `count` sensors, and their configurations.
  void PrepareDriver(std::size_t count) {
    core::livox::DriverConfig driver;
    driver.lidars.clear();
    vehicle_.sensors.clear();
    for (std::size_t i = 0; i < count; ++i) {
      core::SensorConfig mounted;
      mounted.name = "sensor" + std::to_string(i);
      vehicle_.sensors.push_back(mounted);
      core::livox::LidarConfig lidar;
      lidar.sensor = mounted.name;
      lidar.broadcast_code = CodeOf(i);
      driver.lidars.push_back(lidar);
      core::EmulatedSensorConfig sensor;
      sensor.sensor = mounted.name;
      sensor.broadcast_code = CodeOf(i);
      sensor.ip = core::ToString(kFirstSensorIp + static_cast<core::Ipv4>(i));
      sensor.broadcast_to = "255.255.255.255";
      sensors_.push_back(sensor);
    }
    emulated_.resize(count);
    node_ = std::make_unique<process::Node>(
        runtime_,
        process::Identity{.process = "livox_driver", .version = "", .config_digest = ""},
        messages::channels::kLivoxDriverStatus);
    driver_ = std::make_unique<LivoxDriverProcess>(driver, vehicle_, *node_, host_side_);
  }

  void PowerOn(std::size_t index) {
    emulated_[index] = std::make_unique<EmulatedSensor>(
        sensors_[index],
        index + 1,
        runtime_,
        sensor_side_,
        [](std::int64_t first_shot, std::int64_t, core::livox::ReturnMode, auto shots) {
          for (std::size_t i = 0; i < shots.size(); ++i) {
            const std::int64_t shot = first_shot + static_cast<std::int64_t>(i);
            const auto x_mm = static_cast<std::int32_t>(1 + shot % kShotModulo);
            shots[i].echoes[0].point_sensor = {.x_mm = x_mm};
            shots[i].echoes[1].point_sensor = {.x_mm = x_mm, .y_mm = 500};
          }
        });
  }

  [[nodiscard]] double Now() const {
    return 1e-6 * static_cast<double>(runtime_.UtimeNow() - kStart_utime);
  }
  void RunTo(double seconds) {
    runtime_.RunUntil(kStart_utime + static_cast<std::int64_t>(seconds * 1e6));
  }

  void OnWire(const core::Endpoint& from, const core::Endpoint& to, core::livox::ByteView bytes) {
    if (const auto parsed = core::livox::ParseFrame(bytes); parsed.frame) {
      const CommandCode code = core::livox::CodeOf(*parsed.frame);
      if (code == CommandCode::kBroadcast && !first_broadcast_s_) first_broadcast_s_ = Now();
      const bool is_request = from.ip == kHostIp;
      if (code == CommandCode::kHandshake && is_request) {
        const auto body = core::livox::ParseHandshake(parsed.frame->data);
        ports_.insert({from.port, body->command_port, body->data_port});
      }
    } else if (to.port == 56001 && !first_data_s_) {
      first_data_s_ = Now();
    }
  }

  struct Slice {
    std::int64_t at_utime = 0;
    lidar_points_t message;
  };

  process::SimulatedRuntime runtime_{kStart_utime, {}};
  net::MemoryWire wire_{runtime_};
  net::MemoryHost host_side_{wire_, {kHostIp}};
  net::MemoryHost sensor_side_{wire_, SensorIps()};
  core::VehicleConfig vehicle_;
  std::vector<core::EmulatedSensorConfig> sensors_;
  std::unique_ptr<process::Node> node_;
  std::unique_ptr<LivoxDriverProcess> driver_;
  std::vector<std::unique_ptr<EmulatedSensor>> emulated_;
  std::vector<Slice> slices_;
  std::optional<double> first_broadcast_s_;
  std::optional<double> first_data_s_;
  std::set<std::vector<std::uint16_t>> ports_;  // Of the host, as handshakes come from and state.
};

TEST_F(EmulatedSensorsTest, TwentyRestartsGiveDataAgainWithin3SecondsOnTheSamePorts) {
  PrepareDriver(1);
  double longest_s = 0.0;
  for (int life = 0; life < 20; ++life) {
    first_broadcast_s_.reset();
    first_data_s_.reset();
    PowerOn(0);
    // The driver learns of the end in different moments of its own life.
    RunTo(Now() + 5.0 + 0.137 * life);
    ASSERT_TRUE(first_broadcast_s_.has_value()) << "life " << life;
    ASSERT_TRUE(first_data_s_.has_value()) << "life " << life;
    longest_s = std::max(longest_s, *first_data_s_ - *first_broadcast_s_);
    emulated_[0].reset();
    RunTo(Now() + 0.3 * life);
  }

  RecordProperty("longest_ms", static_cast<int>(longest_s * 1e3));
  EXPECT_LT(longest_s, 3.0);
  EXPECT_THAT(ports_, testing::ElementsAre(std::vector<std::uint16_t>{55501, 55501, 56001}));
}

TEST_F(EmulatedSensorsTest, FourSensorsAtOnceGiveAllTheirShotsEachUnderItsName) {
  PrepareDriver(kMaxSensors);
  for (std::size_t i = 0; i < kMaxSensors; ++i) PowerOn(i);

  RunTo(6.0);

  std::map<std::string, std::int64_t> shots;
  for (const Slice& slice : slices_) {
    const double from_s = 1e-6 * static_cast<double>(slice.message.scan_utime - kStart_utime);
    if (from_s >= 3.0 && from_s < 5.0) shots[slice.message.sensor] += slice.message.shots;
    EXPECT_EQ(slice.message.lost_packets, 0);
  }
  ASSERT_THAT(shots, SizeIs(kMaxSensors));
  for (const auto& [sensor, count] : shots) {
    EXPECT_NEAR(static_cast<double>(count), 200e3, 200.0) << sensor;
  }
}

struct Loss {
  double share;
  core::livox::ReturnMode mode;
};
class EmulatedSensorsLossTest : public EmulatedSensorsTest,
                                public testing::WithParamInterface<Loss> {};

TEST_P(EmulatedSensorsLossTest, TheDriverCountsWhatTheNetworkDid) {
  PrepareDriver(1);
  core::NetworkFaultConfig fault;
  fault.times = {.from_s = 3.0, .to_s = 13.0};
  fault.loss = GetParam().share;
  fault.duplicates = GetParam().share;
  fault.reorder = GetParam().share;
  fault.reorder_us = 2'500;
  sensors_[0].network_faults = {fault};
  PowerOn(0);

  RunTo(15.0);
  const EmulatedSensorCounts wanted = emulated_[0]->counts();
  const core::livox::StreamCounts& found = driver_->output(0).stream().counts();

  EXPECT_GT(wanted.lost, 0);
  EXPECT_EQ(found.lost_packets, wanted.lost);
  EXPECT_EQ(found.duplicates, wanted.duplicates);
  EXPECT_EQ(found.reordered, wanted.reordered);
  EXPECT_EQ(found.late_packets, 0);
  EXPECT_EQ(found.packets, wanted.packets - wanted.lost + wanted.duplicates);
  std::int64_t lost_by_slices = 0;
  for (const Slice& slice : slices_) {
    lost_by_slices += slice.message.lost_packets;
    if (slice.message.utime < kStart_utime + 3'000'000) continue;  // The clock is found meanwhile.
    const std::int64_t late_us = slice.at_utime - slice.message.utime - 10'000;
    EXPECT_LE(late_us, 15'000 + 2'000) << "a slice waits for its grace and no longer";
  }
  EXPECT_EQ(lost_by_slices, wanted.lost);
}

INSTANTIATE_TEST_SUITE_P(Shares,
                         EmulatedSensorsLossTest,
                         testing::Values(Loss{0.01, core::livox::ReturnMode::kFirst},
                                         Loss{0.05, core::livox::ReturnMode::kFirst},
                                         Loss{0.20, core::livox::ReturnMode::kFirst}));

class EmulatedSensorsClockTest : public EmulatedSensorsTest,
                                 public testing::WithParamInterface<double> {};

// Truth: shot n of the pattern leaves when the sensor's oscillator has counted n * 10 us.
TEST_P(EmulatedSensorsClockTest, PointsKeepTheirTimeWithinAMillisecondDespiteDriftAndJitter) {
  PrepareDriver(1);
  sensors_[0].clock_drift_ppm = GetParam();
  core::NetworkFaultConfig fault;
  fault.jitter_us = 5'000;
  sensors_[0].network_faults = {fault};
  PowerOn(0);

  RunTo(60.0);

  core::EmulatedClock clock(GetParam(), 0);
  double worst_us = 0.0;
  std::int64_t points = 0;
  for (const Slice& slice : slices_) {
    const lidar_points_t& message = slice.message;
    if (message.utime < kStart_utime + 5'000'000) continue;  // The clock is found meanwhile.
    for (std::size_t i = 0; i < message.x.size(); ++i) {
      const std::int64_t found_us = message.scan_utime + message.time_offset_us[i] - kStart_utime;
      const std::int64_t part = std::llround(message.x[i] * 1000.0F) - 1;
      const std::int64_t about = clock.OscillatorNs(found_us) / 10'000;
      // The shot with this rest that is nearest.
      std::int64_t shot = about - about % kShotModulo + part;
      if (shot - about > kShotModulo / 2) shot -= kShotModulo;
      if (about - shot > kShotModulo / 2) shot += kShotModulo;
      const auto error_us = static_cast<double>(found_us - clock.TrueUs(shot * 10'000));
      worst_us = std::max(worst_us, std::abs(error_us));
      ++points;
    }
  }
  EXPECT_GT(points, 5'000'000);
  EXPECT_LT(worst_us, 1e3);
  RecordProperty("worst_us", static_cast<int>(worst_us));
}

INSTANTIATE_TEST_SUITE_P(Drifts, EmulatedSensorsClockTest, testing::Values(-50.0, 0.0, 50.0));

TEST_F(EmulatedSensorsTest, SurvivesPowerCutSilenceAndAnotherAddress) {
  using core::Silenced;
  PrepareDriver(1);
  sensors_[0].power_cuts = {{.times = {.from_s = 5.0, .to_s = 7.0}}};
  sensors_[0].silences = {{.times = {.from_s = 15.0, .to_s = 20.0}, .what = Silenced::kAll},
                          {.times = {.from_s = 30.0, .to_s = 35.0}, .what = Silenced::kHeartbeats}};
  sensors_[0].address_changes = {{.at_s = 45.0, .ip = "192.168.1.102"}};
  PowerOn(0);

  for (const double quiet_s : {4.9, 14.9, 29.9, 44.9, 59.9}) {
    RunTo(quiet_s);
    const Slice& last = slices_.back();
    EXPECT_LT(runtime_.UtimeNow() - last.at_utime, 50'000) << "points at " << quiet_s << " s";
    EXPECT_EQ(driver_->link(0).state(), core::livox::LinkState::kSampling) << quiet_s;
  }

  EXPECT_EQ(driver_->link(0).address()->ip, kFirstSensorIp + 1);
}

class EmulatedSensorsControlLossTest : public EmulatedSensorsTest,
                                       public testing::WithParamInterface<double> {};

// A command and its answer both get through with (1 - share)^2.
TEST_P(EmulatedSensorsControlLossTest, ConnectsAndSamplesThroughLossOfCommandsAndAnswers) {
  PrepareDriver(1);
  core::NetworkFaultConfig fault;
  fault.control_loss = GetParam();
  sensors_[0].network_faults = {fault};
  PowerOn(0);

  RunTo(60.0);

  ASSERT_TRUE(first_data_s_.has_value());
  EXPECT_LT(*first_data_s_, 30.0);
}

INSTANTIATE_TEST_SUITE_P(Shares,
                         EmulatedSensorsControlLossTest,
                         testing::Values(0.1, 0.3, 0.4, 0.5));

TEST_F(EmulatedSensorsTest, ASecondHostThatTakesTheSensorIsFoughtOffOrTold) {
  PrepareDriver(1);
  PowerOn(0);
  RunTo(4.0);
  net::MemoryHost thief(wire_, {kHostIp + 1});
  const auto socket = thief.Open({.bind = {kHostIp + 1, 55501}}, [](auto) {});
  const auto steal = [&] {
    socket->Send({kFirstSensorIp, 65000},
                 core::livox::PackCommand(
                     core::livox::FrameType::kCommand,
                     1,
                     CommandCode::kHandshake,
                     core::livox::PackBody(core::livox::Handshake{kHostIp + 1, 56001, 55501, 0})));
  };

  steal();
  RunTo(4.5);
  EXPECT_EQ(emulated_[0]->device().host()->ip, kHostIp + 1);
  RunTo(14.0);

  EXPECT_EQ(emulated_[0]->device().host()->ip, kHostIp) << "the driver takes it back";
  EXPECT_LT(runtime_.UtimeNow() - slices_.back().at_utime, 50'000);
}

}  // namespace
}  // namespace clearway
