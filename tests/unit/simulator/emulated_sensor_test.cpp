// SPDX-License-Identifier: BSD-3-Clause
#include "processes/simulator/emulated_sensor.hpp"

#include <algorithm>
#include <array>
#include <cstdint>
#include <memory>
#include <set>
#include <span>
#include <string>
#include <vector>

#include <gmock/gmock.h>

#include "common/net/memory_network.hpp"
#include "common/process/simulated_runtime.hpp"
#include "tests/support/sensor_host.hpp"

namespace clearway {
namespace {

using core::livox::CommandCode;
using core::livox::DataType;
using core::livox::TimestampType;
using test::SensorHost;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::SizeIs;

constexpr std::int64_t kStart_utime = 1'700'000'000'000'000;
constexpr core::Ipv4 kHostIp = 0xC0A80132;
constexpr core::Ipv4 kSensorIp = 0xC0A80165;
constexpr double kSecond_ns = 1e9;

// A sensor with a faultless network, in front of a host; every shot returns from its own number.
class EmulatedSensorTest : public testing::Test {
 protected:
  EmulatedSensorTest() {
    config_.ip = "192.168.1.101";
    config_.broadcast_to = "255.255.255.255";
    host_.return_mode = core::livox::ReturnMode::kFirst;
    runtime_.Every(800'000, [this] { host_.Send(CommandCode::kHeartbeat); });
  }

  void PowerOn(std::uint64_t seed = 1) {
    sensor_ = std::make_unique<EmulatedSensor>(
        config_,
        seed,
        runtime_,
        sensor_side_,
        [this](std::int64_t first_shot,
               std::int64_t time_us,
               core::livox::ReturnMode,
               std::span<core::SimulatedShot> shots) {
          fired_.push_back({first_shot, time_us, shots.size()});
          for (std::size_t i = 0; i < shots.size(); ++i) {
            const auto shot = static_cast<std::int32_t>(first_shot) + static_cast<std::int32_t>(i);
            shots[i].echoes[0].point_sensor = {.x_mm = shot, .reflectivity = 1, .tag = 0x10};
            shots[i].echoes[1].point_sensor = {.x_mm = -shot, .reflectivity = 2, .tag = 0x20};
          }
        });
  }
  void RunTo(double seconds) {
    runtime_.RunUntil(kStart_utime + static_cast<std::int64_t>(seconds * 1e6));
  }
  [[nodiscard]] double At(const SensorHost::Packet& packet) const {
    return 1e-6 * static_cast<double>(packet.arrival_utime - kStart_utime);
  }
  // Packets that came in [from_s, to_s).
  [[nodiscard]] std::vector<SensorHost::Packet> Between(double from_s, double to_s) const {
    std::vector<SensorHost::Packet> found;
    for (const auto& packet : host_.packets) {
      if (At(packet) >= from_s && At(packet) < to_s) found.push_back(packet);
    }
    return found;
  }

  struct Fired {
    std::int64_t first_shot = 0;
    std::int64_t time_us = 0;
    std::size_t shots = 0;
  };

  process::SimulatedRuntime runtime_{kStart_utime, {}};
  net::MemoryWire wire_{runtime_};
  net::MemoryHost host_side_{wire_, {kHostIp}};
  net::MemoryHost sensor_side_{wire_, {kSensorIp, kSensorIp + 1}};
  SensorHost host_{host_side_, kHostIp};
  core::EmulatedSensorConfig config_;
  std::vector<Fired> fired_;
  std::unique_ptr<EmulatedSensor> sensor_;
};

TEST_F(EmulatedSensorTest, SendsAPacketEach960MicrosecondsFromItsStartOn) {
  PowerOn();

  RunTo(3.0);

  const auto packets = Between(1.5, 2.5);
  EXPECT_NEAR(static_cast<double>(packets.size()), 1e6 / 960.0, 1.0);
  for (std::size_t i = 1; i < packets.size(); ++i) {
    ASSERT_EQ(packets[i].header.timestamp - packets[i - 1].header.timestamp, 960'000U);
  }
  EXPECT_EQ(packets[0].header.data_type, DataType::kExtendedCartesian);
  EXPECT_THAT(packets[0].bytes, SizeIs(1362));
  EXPECT_EQ(packets[0].from, (core::Endpoint{kSensorIp, 60001}));
  EXPECT_NEAR(At(host_.packets.front()), 1.0, 0.005) << "as soon as it measures";
  EXPECT_EQ(sensor_->counts().packets, static_cast<std::int64_t>(host_.packets.size()));
  EXPECT_EQ(host_.CountOf(CommandCode::kBroadcast), 1);
}

TEST_F(EmulatedSensorTest, APacketLeavesWhenItsLastShotIsOver) {
  PowerOn();

  RunTo(3.0);

  ASSERT_EQ(fired_.size(), host_.packets.size());
  for (std::size_t i = 0; i < fired_.size(); ++i) {
    const std::int64_t end_us = fired_[i].time_us + 960;
    const std::int64_t arrival_us = host_.packets[i].arrival_utime - kStart_utime;
    ASSERT_GE(arrival_us, end_us);
    ASSERT_LE(arrival_us, end_us + 1'000);
  }
}

TEST_F(EmulatedSensorTest, StampsAreThoseOfTheShotsOfThePattern) {
  config_.uptime_s = 100.0;
  PowerOn();

  RunTo(1.5);

  ASSERT_THAT(fired_, Not(IsEmpty()));
  for (std::size_t i = 0; i < fired_.size(); ++i) {
    const auto stamp = static_cast<std::int64_t>(host_.packets[i].header.timestamp);
    ASSERT_EQ(stamp, 100'000'000'000 + fired_[i].first_shot * 10'000);
    const auto x_mm = core::livox::Load<std::int32_t>(host_.packets[i].bytes, 18);
    ASSERT_EQ(x_mm, fired_[i].first_shot);
  }
}

TEST_F(EmulatedSensorTest, DualReturnSendsBothEchoesTwiceAsOften) {
  host_.return_mode = core::livox::ReturnMode::kDual;
  PowerOn();

  RunTo(2.5);

  const auto packets = Between(1.2, 2.2);
  EXPECT_NEAR(static_cast<double>(packets.size()), 1e6 / 480.0, 3.0);
  std::vector<core::livox::Point> points(96);
  const auto parsed = core::livox::ParsePacket(packets[0].bytes);
  core::livox::DecodePoints(*parsed.packet, points);
  EXPECT_EQ(packets[0].header.data_type, DataType::kDualCartesian);
  EXPECT_FLOAT_EQ(points[0].x_m, -points[1].x_m);
  EXPECT_EQ(points[0].tag, 0x10);
  EXPECT_EQ(points[1].tag, 0x20);
}

TEST_F(EmulatedSensorTest, ItsClockDrifts) {
  config_.clock_drift_ppm = 50.0;
  PowerOn();

  RunTo(62.0);

  const auto& first = host_.packets.front();
  const auto& last = host_.packets.back();
  const double stamps_ns = static_cast<double>(last.header.timestamp - first.header.timestamp);
  const double arrivals_s = At(last) - At(first);
  // A tick of 1 ms at both ends.
  EXPECT_NEAR((stamps_ns / kSecond_ns / arrivals_s - 1.0) * 1e6, 50.0, 2.0 * 1e-3 / 60.0 * 1e6);
}

TEST_F(EmulatedSensorTest, ClockStepsAndResetsHappenOnceEachAndInOrder) {
  config_.uptime_s = 100.0;
  config_.clock_steps = {{.at_s = 4.0, .reset = true}, {.at_s = 2.0, .step_s = -10.0}};
  PowerOn();

  RunTo(5.0);

  const auto stamp_s = [this](double at_s) {
    return static_cast<double>(Between(at_s, at_s + 0.01).front().header.timestamp) / kSecond_ns;
  };
  EXPECT_NEAR(stamp_s(1.9), 101.9, 0.01);
  EXPECT_NEAR(stamp_s(2.1), 92.1, 0.01);
  EXPECT_NEAR(stamp_s(4.5), 0.5, 0.01);
}

TEST_F(EmulatedSensorTest, PtpStampsAreTheTimeOfDayUntilTheSourceIsLost) {
  config_.time_sync = TimestampType::kPtp;
  config_.time_sync_losses = {{.times = {.from_s = 3.0}}};
  config_.clock_drift_ppm = -50.0;
  PowerOn();

  RunTo(4.0);

  for (const auto& packet : Between(1.0, 3.0)) {
    ASSERT_EQ(packet.header.timestamp_type, TimestampType::kPtp);
    const auto late_us =
        packet.arrival_utime - static_cast<std::int64_t>(packet.header.timestamp / 1000U);
    ASSERT_GE(late_us, 959);
    ASSERT_LE(late_us, 1'961);
    ASSERT_TRUE(core::livox::DecodeStatus(packet.header.status_code).ptp_present);
  }
  for (const auto& packet : Between(3.01, 4.0)) {
    ASSERT_EQ(packet.header.timestamp_type, TimestampType::kNoSync);
    ASSERT_FALSE(core::livox::DecodeStatus(packet.header.status_code).ptp_present);
  }
}

TEST_F(EmulatedSensorTest, APowerCutEndsAllAndItsClockBeginsAnew) {
  config_.power_cuts = {{.times = {.from_s = 3.0, .to_s = 5.0}}};
  PowerOn();

  RunTo(4.0);
  EXPECT_FALSE(sensor_->is_on());
  const std::size_t heard = host_.heard.size();
  RunTo(4.9);
  EXPECT_EQ(host_.heard.size(), heard) << "heartbeats are not answered";
  RunTo(8.0);

  EXPECT_TRUE(sensor_->is_on());
  EXPECT_THAT(Between(3.005, 6.0), IsEmpty());
  const auto again = Between(6.0, 6.1);
  ASSERT_THAT(again, Not(IsEmpty()));
  EXPECT_NEAR(static_cast<double>(again[0].header.timestamp) / kSecond_ns, 1.0, 0.01);
  EXPECT_EQ(host_.CountOf(CommandCode::kBroadcast), 2);
}

TEST_F(EmulatedSensorTest, WithoutPowerAtTheStartItIsSilent) {
  config_.power_cuts = {{.times = {.from_s = 0.0, .to_s = 2.0}}};
  PowerOn();

  RunTo(1.9);
  EXPECT_THAT(host_.heard, IsEmpty());
  RunTo(4.0);

  EXPECT_THAT(host_.packets, Not(IsEmpty()));
}

TEST_F(EmulatedSensorTest, SilencesAreWhatTheySay) {
  using core::Silenced;
  config_.silences = {{.times = {.from_s = 2.0, .to_s = 3.0}, .what = Silenced::kData},
                      {.times = {.from_s = 4.0, .to_s = 6.0}, .what = Silenced::kHeartbeats},
                      {.times = {.from_s = 7.0, .to_s = 8.0}, .what = Silenced::kAll}};
  PowerOn();

  RunTo(9.0);

  EXPECT_THAT(Between(2.005, 3.0), IsEmpty());
  EXPECT_THAT(Between(4.0, 6.0), Not(IsEmpty())) << "points go on";
  EXPECT_THAT(Between(7.005, 8.0), IsEmpty());
  for (const auto& heard : host_.heard) {
    const double at_s = 1e-6 * static_cast<double>(heard.arrival_utime - kStart_utime);
    const bool is_muted = at_s >= 4.0 && at_s < 6.0;
    EXPECT_FALSE(is_muted && heard.code == CommandCode::kHeartbeat) << at_s;
    EXPECT_FALSE(at_s >= 7.0 && at_s < 8.0) << at_s;
  }
  EXPECT_EQ(sensor_->counts().packets - sensor_->counts().silenced,
            static_cast<std::int64_t>(host_.packets.size()));
}

TEST_F(EmulatedSensorTest, AnotherAddressIsAnnouncedAndUsed) {
  config_.address_changes = {{.at_s = 3.0, .ip = "192.168.1.102"}};
  PowerOn();

  RunTo(5.0);

  ASSERT_TRUE(host_.sensor.has_value());
  EXPECT_EQ(host_.sensor->ip, kSensorIp + 1);
  for (const auto& packet : Between(3.5, 5.0)) ASSERT_EQ(packet.from.ip, kSensorIp + 1);
  EXPECT_THAT(Between(3.5, 5.0), Not(IsEmpty()));
}

TEST_F(EmulatedSensorTest, AnAddressThatCannotBeHadIsToldAndTriedAgain) {
  config_.address_changes = {{.at_s = 2.0, .ip = "10.0.0.1"}, {.at_s = 4.0, .ip = "192.168.1.102"}};
  PowerOn();

  RunTo(3.0);
  EXPECT_THAT(sensor_->problem(), HasSubstr("10.0.0.1"));
  RunTo(6.0);

  EXPECT_THAT(sensor_->problem(), IsEmpty());
  EXPECT_THAT(Between(4.5, 6.0), Not(IsEmpty()));
}

TEST_F(EmulatedSensorTest, AnAddressThatAHostSetIsUsedAfterAReboot) {
  PowerOn();
  RunTo(2.0);
  core::livox::Bytes body = core::livox::PackByte(1);
  for (const std::uint8_t part :
       std::to_array<std::uint8_t>({192, 168, 1, 102, 255, 255, 255, 0, 192, 168, 1, 1})) {
    core::livox::Append(body, part);
  }

  host_.Send(CommandCode::kSetIp, body);
  host_.Send(CommandCode::kReboot, core::livox::Bytes(2));
  RunTo(5.0);

  EXPECT_EQ(host_.sensor->ip, kSensorIp + 1);
  EXPECT_EQ(host_.packets.back().from.ip, kSensorIp + 1);
}

TEST_F(EmulatedSensorTest, StatusFaultsThatHoldTogetherAddUp) {
  using core::livox::Severity;
  config_.status_faults = {
      {.times = {.from_s = 2.0}, .window = Severity::kWarning},
      {.times = {.from_s = 2.0, .to_s = 3.0}, .temperature = Severity::kWarning}};
  PowerOn();

  RunTo(4.0);

  const auto status = [this](double at_s) {
    return core::livox::DecodeStatus(Between(at_s, at_s + 0.01).front().header.status_code);
  };
  EXPECT_EQ(status(1.9), core::livox::DeviceStatus{});
  EXPECT_EQ(status(2.5),
            (core::livox::DeviceStatus{.temperature = Severity::kWarning,
                                       .window = Severity::kWarning,
                                       .system = Severity::kWarning}));
  EXPECT_EQ(status(3.5).temperature, Severity::kOk);
  EXPECT_NEAR(host_.CountOf(CommandCode::kAbnormalStatus), 20, 1);
}

TEST_F(EmulatedSensorTest, WhatABadNetworkDidIsCountedAsTheHostFindsIt) {
  config_.network_faults = {
      {.loss = 0.05, .duplicates = 0.05, .reorder = 0.05, .jitter_us = 2'000}};
  PowerOn();

  RunTo(12.0);
  host_.Send(CommandCode::kSampling, core::livox::PackByte(0));
  RunTo(12.5);

  std::set<std::uint64_t> stamps;
  std::int64_t duplicates = 0;
  std::int64_t reordered = 0;
  for (const auto& packet : host_.packets) {
    if (!stamps.insert(packet.header.timestamp).second) {
      ++duplicates;
    } else if (packet.header.timestamp < *stamps.rbegin()) {
      ++reordered;
    }
  }
  const EmulatedSensorCounts counts = sensor_->counts();
  EXPECT_EQ(counts.under_way, 0);
  EXPECT_EQ(counts.packets - counts.lost, static_cast<std::int64_t>(stamps.size()));
  EXPECT_EQ(counts.duplicates, duplicates);
  EXPECT_EQ(counts.reordered, reordered);
  EXPECT_GT(counts.lost, 300);
  EXPECT_GT(reordered, 300);
}

TEST_F(EmulatedSensorTest, AConnectionWithoutAnyCommandOrAnswerEnds) {
  config_.network_faults = {{.times = {.from_s = 2.0}, .control_loss = 1.0}};
  PowerOn();

  RunTo(9.0);

  EXPECT_EQ(sensor_->device().counts().host_timeouts, 1);
  EXPECT_THAT(Between(8.0, 9.0), IsEmpty());
  EXPECT_GT(sensor_->counts().control_lost, 3);
}

TEST_F(EmulatedSensorTest, TheSameSeedSendsTheSameBytes) {
  config_.network_faults = {{.loss = 0.2, .reorder = 0.1, .jitter_us = 3'000}};
  const auto run = [](const core::EmulatedSensorConfig& config, std::uint64_t seed) {
    process::SimulatedRuntime runtime(kStart_utime, {});
    net::MemoryWire wire(runtime);
    net::MemoryHost near(wire, {kHostIp});
    net::MemoryHost far(wire, {kSensorIp});
    SensorHost host(near, kHostIp);
    const EmulatedSensor sensor(config, seed, runtime, far, [](auto, auto, auto, auto) {});
    runtime.RunUntil(kStart_utime + 3'000'000);
    std::vector<core::livox::Bytes> bytes;
    for (const auto& packet : host.packets) bytes.push_back(packet.bytes);
    return bytes;
  };

  const auto first = run(config_, 1);

  EXPECT_GT(first.size(), 1000U);
  EXPECT_EQ(first, run(config_, 1));
  EXPECT_NE(first, run(config_, 2));
}

TEST_F(EmulatedSensorTest, SaysWhichPortIsTaken) {
  const auto taken = sensor_side_.Open({.bind = {kSensorIp, 65000}}, [](auto) {});

  EXPECT_THROW(PowerOn(), net::NetworkError);
}

// A simulator that the machine did not run for a while.
class LateRuntime final : public process::Runtime {
 public:
  explicit LateRuntime(process::SimulatedRuntime& inner) : inner_(inner) {}
  std::int64_t late_us = 0;

  [[nodiscard]] std::int64_t MonotonicUs() const override { return inner_.MonotonicUs() + late_us; }
  [[nodiscard]] std::int64_t UtimeNow() const override { return inner_.UtimeNow() + late_us; }
  [[nodiscard]] std::int64_t NewSession() override { return inner_.NewSession(); }
  [[nodiscard]] std::string HostName() const override { return inner_.HostName(); }
  [[nodiscard]] int ProcessId() const override { return inner_.ProcessId(); }
  void Publish(messages::BusId bus,
               const std::string& channel,
               std::span<const std::byte> bytes) override {
    inner_.Publish(bus, channel, bytes);
  }
  [[nodiscard]] std::int64_t SendFailures() const override { return 0; }
  void Subscribe(messages::BusId bus, const std::string& channel, BytesHandler handler) override {
    inner_.Subscribe(bus, channel, std::move(handler));
  }
  TimerId Every(std::int64_t period_us, std::function<void()> callback) override {
    return inner_.Every(period_us, std::move(callback));
  }
  TimerId After(std::int64_t delay_us, std::function<void()> callback) override {
    return inner_.After(delay_us, std::move(callback));
  }
  void Cancel(TimerId timer) override { inner_.Cancel(timer); }
  [[nodiscard]] std::size_t MaxMessageBytes(messages::BusId bus) const override {
    return inner_.MaxMessageBytes(bus);
  }
  [[nodiscard]] std::int64_t BurstIntervalUs(messages::BusId bus) const override {
    return inner_.BurstIntervalUs(bus);
  }
  [[nodiscard]] std::int64_t ReceiveBufferBytes() const override { return -1; }

 private:
  process::SimulatedRuntime& inner_;
};

TEST_F(EmulatedSensorTest, CatchesUpWith50MillisecondsAndSkipsAndCountsTheRest) {
  LateRuntime late(runtime_);
  EmulatedSensor sensor(config_, 1, late, sensor_side_, [](auto, auto, auto, auto) {});
  RunTo(2.0);

  late.late_us = 30'000;
  RunTo(2.01);
  EXPECT_EQ(sensor.counts().skipped, 0);
  late.late_us = 30'000 + 1'000'000;
  RunTo(2.5);

  EXPECT_NEAR(static_cast<double>(sensor.counts().skipped), 950'000.0 / 960.0, 3.0);
  std::int64_t widest_us = 0;
  for (std::size_t i = 1; i < host_.packets.size(); ++i) {
    const auto gap_ns = host_.packets[i].header.timestamp - host_.packets[i - 1].header.timestamp;
    widest_us = std::max(widest_us, static_cast<std::int64_t>(gap_ns / 1000U));
  }
  EXPECT_EQ(widest_us, (sensor.counts().skipped + 1) * 960);
}

}  // namespace
}  // namespace clearway
