// SPDX-License-Identifier: BSD-3-Clause
// The driver in virtual time: its points, and what it says about a network that is not as it should
// be.
#include <algorithm>
#include <array>
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

using testing::HasSubstr;

constexpr std::int64_t kStart_utime = 1'700'000'000'000'000;
constexpr core::Ipv4 kHostIp = 0xC0A80132;         // 192.168.1.50
constexpr core::Ipv4 kFirstSensorIp = 0xC0A80165;  // 192.168.1.101
constexpr core::Ipv4 kElsewhere = 0xC0A80205;      // 192.168.2.5

using Millimetres = std::array<std::int64_t, 5>;  // x, y, z, reflectivity, tag.

std::string CodeOf(std::size_t index) {
  return "3GGDJ6K0010010" + std::to_string(index);
}

class SimulatedDriverTest : public testing::Test {
 protected:
  SimulatedDriverTest() {
    vehicle_.sensors.clear();
    config_.lidars.clear();
    runtime_.SetTap([this](messages::BusId, const std::string& channel, auto bytes) {
      if (channel == messages::channels::kLidarPoints.name) {
        slices_.push_back(*messages::Decode<lidar_points_t>(bytes));
      } else if (channel == messages::channels::kLivoxDriverStatus.name) {
        status_ = *messages::Decode<status_t>(bytes);
      }
    });
  }

  void AddLidar(const std::string& code, const std::string& ip) {
    core::SensorConfig mounted;
    mounted.name = "sensor" + std::to_string(config_.lidars.size());
    vehicle_.sensors.push_back(mounted);
    core::livox::LidarConfig lidar;
    lidar.sensor = mounted.name;
    lidar.broadcast_code = code;
    lidar.ip = ip;
    config_.lidars.push_back(lidar);
  }

  void StartDriver() {
    node_ = std::make_unique<process::Node>(
        runtime_,
        process::Identity{.process = "livox_driver", .version = "", .config_digest = ""},
        messages::channels::kLivoxDriverStatus);
    driver_ = std::make_unique<LivoxDriverProcess>(config_, vehicle_, *node_, host_side_);
  }

  void PowerOn(std::size_t index, core::Ipv4 ip) {
    core::EmulatedSensorConfig sensor;
    sensor.broadcast_code = CodeOf(index);
    sensor.ip = core::ToString(ip);
    sensor.broadcast_to = "255.255.255.255";
    sensors_.push_back(std::make_unique<EmulatedSensor>(
        sensor,
        index + 1,
        runtime_,
        sensor_side_,
        [this](std::int64_t first, std::int64_t, core::livox::ReturnMode mode, auto shots) {
          Fire(first, mode, shots);
        }));
  }

  // Points all over the range of the wire, every seventh shot without a return.
  void Fire(std::int64_t first,
            core::livox::ReturnMode mode,
            std::span<core::SimulatedShot> shots) {
    for (std::size_t i = 0; i < shots.size(); ++i) {
      const std::int64_t shot = first + static_cast<std::int64_t>(i);
      if (shot % 7 == 0) continue;
      const auto value = [shot](std::int64_t factor) {
        return static_cast<std::int32_t>(shot * factor % 200'001 - 100'000);
      };
      shots[i].echoes[0].point_sensor = {
          value(7919), value(104'729), value(1'299'709), static_cast<std::uint8_t>(shot), 0x10};
      Remember(shots[i].echoes[0].point_sensor);
      if (mode != core::livox::ReturnMode::kDual || shot % 3 != 0) continue;
      shots[i].echoes[1].point_sensor = {
          value(15'485'863), value(13), value(17), static_cast<std::uint8_t>(shot), 0x20};
      Remember(shots[i].echoes[1].point_sensor);
    }
  }
  void Remember(const core::livox::WirePoint& p) {
    fired_.push_back({p.x_mm, p.y_mm, p.z_mm, p.reflectivity, p.tag});
  }

  void RunFor(double seconds) {
    runtime_.RunUntil(runtime_.UtimeNow() + static_cast<std::int64_t>(seconds * 1e6));
  }

  [[nodiscard]] std::int64_t Counter(const std::string& name) const {
    for (const counter_t& counter : status_.counters) {
      if (counter.name == name) return counter.value;
    }
    ADD_FAILURE() << "no counter " << name;
    return -1;
  }

  process::SimulatedRuntime runtime_{kStart_utime, {}};
  net::MemoryWire wire_{runtime_};
  net::MemoryHost host_side_{wire_, {kHostIp}};
  net::MemoryHost sensor_side_{
      wire_,
      {kFirstSensorIp, kFirstSensorIp + 1, kFirstSensorIp + 2, kElsewhere}};
  core::livox::DriverConfig config_;
  core::VehicleConfig vehicle_;
  std::vector<std::unique_ptr<EmulatedSensor>> sensors_;
  std::unique_ptr<process::Node> node_;
  std::unique_ptr<LivoxDriverProcess> driver_;
  std::vector<lidar_points_t> slices_;
  std::vector<Millimetres> fired_;
  status_t status_;
};

class SimulatedDriverPointsTest : public SimulatedDriverTest,
                                  public testing::WithParamInterface<core::livox::ReturnMode> {};

TEST_P(SimulatedDriverPointsTest, EveryEchoArrivesOnceInOrderToTheMillimetre) {
  AddLidar(CodeOf(0), "");
  config_.lidars[0].return_mode = GetParam();
  StartDriver();
  PowerOn(0, kFirstSensorIp);

  RunFor(5.0);

  std::vector<Millimetres> found;
  std::int64_t shots = 0;
  std::int64_t zero_returns = 0;
  for (const lidar_points_t& slice : slices_) {
    shots += slice.shots;
    zero_returns += slice.zero_returns;
    for (std::size_t i = 0; i < slice.x.size(); ++i) {
      const auto mm = [](float metres) { return std::llround(double{metres} * 1000.0); };
      found.push_back(
          {mm(slice.x[i]), mm(slice.y[i]), mm(slice.z[i]), slice.intensity[i], slice.tag[i]});
    }
  }
  ASSERT_GT(found.size(), 200'000U);
  ASSERT_LE(found.size(), fired_.size()) << "the last are still under way";
  EXPECT_LT(fired_.size() - found.size(), 8'000U);
  fired_.resize(found.size());
  EXPECT_TRUE(found == fired_);
  EXPECT_NEAR(static_cast<double>(zero_returns), static_cast<double>(shots) / 7.0, 2.0);
}

INSTANTIATE_TEST_SUITE_P(Modes,
                         SimulatedDriverPointsTest,
                         testing::Values(core::livox::ReturnMode::kFirst,
                                         core::livox::ReturnMode::kDual));

TEST_F(SimulatedDriverTest, SensorsShareOneGridOfScansWhateverTheirClocksSay) {
  for (std::size_t i = 0; i < 2; ++i) AddLidar(CodeOf(i), "");
  StartDriver();
  PowerOn(0, kFirstSensorIp);
  RunFor(0.7231);
  PowerOn(1, kFirstSensorIp + 1);

  RunFor(6.0);

  std::map<std::int64_t, std::map<std::string, int>> scans;
  for (const lidar_points_t& slice : slices_) {
    EXPECT_EQ(slice.scan_utime % 100'000, 0);
    EXPECT_EQ(slice.scan_id, slice.scan_utime / 100'000);
    ++scans[slice.scan_id][slice.sensor];
  }
  std::size_t whole = 0;
  for (const auto& [id, sensors] : scans) {
    whole += sensors.size() == 2 && sensors.begin()->second == 10 && sensors.rbegin()->second == 10;
  }
  EXPECT_GE(whole, 35U);
}

TEST_F(SimulatedDriverTest, ASensorThatIsNotConfiguredIsListedAndNotUsed) {
  AddLidar(CodeOf(0), "");
  StartDriver();
  PowerOn(0, kFirstSensorIp);
  PowerOn(1, kFirstSensorIp + 1);

  RunFor(5.0);

  EXPECT_EQ(status_.state, status_t::STATE_OK);
  EXPECT_THAT(status_.text, HasSubstr("; not used: MID-70 " + CodeOf(1) + " at 192.168.1.102"));
  EXPECT_EQ(sensors_[1]->device().host(), std::nullopt);
  EXPECT_TRUE(std::all_of(slices_.begin(), slices_.end(), [](const lidar_points_t& slice) {
    return slice.sensor == "sensor0";
  }));
}

TEST_F(SimulatedDriverTest, OfTwoThatCouldBeMeantNoneIsUsedAndBothAreListed) {
  AddLidar("", "");
  StartDriver();
  PowerOn(0, kFirstSensorIp);
  PowerOn(1, kFirstSensorIp + 1);

  RunFor(8.0);

  EXPECT_EQ(status_.state, status_t::STATE_FAULT);
  EXPECT_THAT(status_.text, HasSubstr("several sensors could be meant"));
  EXPECT_THAT(status_.text, HasSubstr(CodeOf(0) + " at 192.168.1.101"));
  EXPECT_THAT(status_.text, HasSubstr(CodeOf(1) + " at 192.168.1.102"));
  for (const auto& sensor : sensors_) EXPECT_EQ(sensor->device().counts().handshakes, 0);
}

TEST_F(SimulatedDriverTest, TheOnlyOneIsUsedWithoutCodeAndAddressWithin3SecondsOfItsBroadcast) {
  AddLidar("", "");
  StartDriver();
  PowerOn(0, kFirstSensorIp);

  RunFor(0.2 + 3.0);

  EXPECT_FALSE(slices_.empty());
  EXPECT_EQ(driver_->link(0).state(), core::livox::LinkState::kSampling);
}

TEST_F(SimulatedDriverTest, AKnownAddressIsAskedWhereBroadcastsDoNotArrive) {
  wire_.SetFilter([](const auto&, const auto& to, auto) -> std::optional<std::int64_t> {
    if (to.port == core::livox::kBroadcastPort) return std::nullopt;
    return 0;
  });
  AddLidar("", "192.168.1.101");
  StartDriver();
  PowerOn(0, kFirstSensorIp);

  RunFor(6.0);

  EXPECT_EQ(driver_->link(0).state(), core::livox::LinkState::kSampling);
  EXPECT_EQ(Counter("sensor0_packets"), Counter("sensor0_shots") / 96);
}

TEST_F(SimulatedDriverTest, ASensorInAnotherSubnetIsToldWithWhatThisHostHas) {
  AddLidar(CodeOf(0), "");
  StartDriver();
  PowerOn(0, kElsewhere);

  RunFor(3.0);

  EXPECT_EQ(status_.state, status_t::STATE_FAULT);
  EXPECT_THAT(status_.text,
              HasSubstr("sensor0: 192.168.2.5 is in another subnet than this host, which has"));
  EXPECT_THAT(status_.text, HasSubstr("192.168.1.50"));
}

TEST_F(SimulatedDriverTest, SilenceIsToldWithWhatToCheck) {
  AddLidar(CodeOf(0), "");
  StartDriver();

  RunFor(1.5);
  EXPECT_EQ(status_.state, status_t::STATE_WAITING);
  EXPECT_EQ(status_.text, "sensor0: looks for it");
  RunFor(3.0);

  EXPECT_EQ(status_.state, status_t::STATE_WAITING);
  EXPECT_THAT(status_.text,
              HasSubstr("no broadcast of \"" + CodeOf(0) +
                        "\" heard on UDP port "
                        "55000"));
  EXPECT_THAT(status_.text, HasSubstr("power and cable"));
}

TEST_F(SimulatedDriverTest, OneOfTwoThatIsMissingDegradesAndTellsWhich) {
  for (std::size_t i = 0; i < 2; ++i) AddLidar(CodeOf(i), "");
  StartDriver();
  PowerOn(0, kFirstSensorIp);
  PowerOn(1, kFirstSensorIp + 1);
  RunFor(4.0);
  ASSERT_EQ(status_.state, status_t::STATE_OK);

  sensors_[1].reset();
  RunFor(8.0);

  EXPECT_EQ(status_.state, status_t::STATE_DEGRADED);
  EXPECT_THAT(status_.text, HasSubstr("sensor1: 192.168.1.102 answers no handshake"));
  EXPECT_THAT(status_.text, HasSubstr("sensor0: samples"));
}

TEST_F(SimulatedDriverTest, WhatComesFromElsewhereIsCountedAndNotBelieved) {
  AddLidar(CodeOf(0), "");
  StartDriver();
  PowerOn(0, kFirstSensorIp);
  RunFor(4.0);
  const auto stranger = sensor_side_.Open({.bind = {kFirstSensorIp + 2, 60'000}}, [](auto) {});
  const std::vector<core::livox::WirePoint> points(96, {1000, 0, 0, 1, 1});
  const auto packet = core::livox::PackPacket({}, points);
  const auto frame = core::livox::PackCommand(core::livox::FrameType::kMessage,
                                              1,
                                              core::livox::CommandCode::kAbnormalStatus,
                                              std::vector<std::byte>(4, std::byte{0xFF}));
  for (int i = 0; i < 10; ++i) stranger->Send({kHostIp, 56001}, packet);
  for (int i = 0; i < 20; ++i) stranger->Send({kHostIp, 55501}, frame);

  RunFor(1.1);

  EXPECT_EQ(Counter("foreign_packets"), 10);
  EXPECT_EQ(Counter("foreign_frames"), 20);
  EXPECT_EQ(status_.state, status_t::STATE_OK);
  EXPECT_EQ(Counter("sensor0_unfit_packets"), 0);
}

TEST_F(SimulatedDriverTest, ForeignTypesAndBrokenPacketsAreCountedApart) {
  AddLidar(CodeOf(0), "");
  StartDriver();
  PowerOn(0, kFirstSensorIp);
  RunFor(4.0);
  const auto sender = sensor_side_.Open({.bind = {kFirstSensorIp, 60'002}}, [](auto) {});
  std::vector<std::byte> imu(42);
  imu[0] = std::byte{5};
  imu[9] = std::byte{6};
  const std::vector<std::byte> broken(10, std::byte{5});
  for (int i = 0; i < 3; ++i) sender->Send({kHostIp, 56001}, imu);
  for (int i = 0; i < 5; ++i) sender->Send({kHostIp, 56001}, broken);

  RunFor(1.1);

  EXPECT_EQ(Counter("sensor0_foreign_type"), 3);
  EXPECT_EQ(Counter("sensor0_broken_packets"), 5);
  EXPECT_EQ(Counter("sensor0_lost_packets"), 0);
}

TEST_F(SimulatedDriverTest, TheEndStopsTheSensors) {
  AddLidar(CodeOf(0), "");
  StartDriver();
  PowerOn(0, kFirstSensorIp);
  RunFor(4.0);
  ASSERT_NE(sensors_[0]->device().host(), std::nullopt);

  driver_.reset();
  RunFor(0.1);

  EXPECT_EQ(sensors_[0]->device().host(), std::nullopt);
}

TEST_F(SimulatedDriverTest, ALidarWithoutASensorOfTheVehicleIsRefusedInWords) {
  AddLidar(CodeOf(0), "");
  config_.lidars[0].sensor = "roof";

  try {
    StartDriver();
    FAIL();
  } catch (const std::runtime_error& error) {
    EXPECT_STREQ(error.what(),
                 "livox_driver.lidar: sensor=\"roof\" is none of the vehicle's sensors: "
                 "\"sensor0\"");
  }
}

// A runtime whose process has no processor for a while: timers are missed, as LiveRuntime misses
// them.
class StallingRuntime final : public process::Runtime {
 public:
  explicit StallingRuntime(process::SimulatedRuntime& runtime) : runtime_(runtime) {}
  bool is_stalled = false;

  [[nodiscard]] std::int64_t MonotonicUs() const override { return runtime_.MonotonicUs(); }
  [[nodiscard]] std::int64_t UtimeNow() const override { return runtime_.UtimeNow(); }
  [[nodiscard]] std::int64_t NewSession() override { return runtime_.NewSession(); }
  [[nodiscard]] std::string HostName() const override { return runtime_.HostName(); }
  [[nodiscard]] int ProcessId() const override { return runtime_.ProcessId(); }
  void Publish(messages::BusId bus,
               const std::string& channel,
               std::span<const std::byte> bytes) override {
    runtime_.Publish(bus, channel, bytes);
  }
  [[nodiscard]] std::int64_t SendFailures() const override { return 0; }
  void Subscribe(messages::BusId bus, const std::string& channel, BytesHandler handler) override {
    runtime_.Subscribe(bus, channel, std::move(handler));
  }
  TimerId Every(std::int64_t period_us, std::function<void()> callback) override {
    return runtime_.Every(period_us, [this, callback = std::move(callback)] {
      if (!is_stalled) callback();
    });
  }
  TimerId After(std::int64_t delay_us, std::function<void()> callback) override {
    return runtime_.After(delay_us, std::move(callback));
  }
  void Cancel(TimerId timer) override { runtime_.Cancel(timer); }
  [[nodiscard]] std::size_t MaxMessageBytes(messages::BusId bus) const override {
    return runtime_.MaxMessageBytes(bus);
  }
  [[nodiscard]] std::int64_t BurstIntervalUs(messages::BusId bus) const override {
    return runtime_.BurstIntervalUs(bus);
  }
  [[nodiscard]] std::int64_t ReceiveBufferBytes() const override { return -1; }

 private:
  process::SimulatedRuntime& runtime_;
};

// Packets that wait in the socket while the process has no processor arrive in one go; their
// arrival is when the kernel had them.
class StalledNetwork final : public net::Network {
 public:
  explicit StalledNetwork(process::Runtime& runtime)
      : runtime_(runtime),
        device_({.start_up_us = 0}, {.ip = kFirstSensorIp}, runtime.MonotonicUs()) {}

  std::unique_ptr<net::Socket> Open(const net::SocketSettings& settings, Handler handler) override {
    handlers_[settings.bind.port] = std::move(handler);
    return std::make_unique<Port>(*this);
  }
  [[nodiscard]] std::vector<net::Interface> Interfaces() const override {
    return {{"eth0", kHostIp, 0xFFFFFF00}};
  }

  void Tick() { Carry(device_.Advance(runtime_.MonotonicUs())); }

  // All packets since the last time, 64 at once, each with its own arrival.
  void DeliverPackets() {
    const std::vector<core::livox::WirePoint> points(96, {1000, 0, 0, 1, 1});
    std::vector<std::vector<std::byte>> packets;
    std::vector<net::Datagram> datagrams;
    if (sent_until_utime_ == 0) sent_until_utime_ = runtime_.UtimeNow();
    while (sent_until_utime_ + 960 <= runtime_.UtimeNow()) {
      const auto ns = static_cast<std::uint64_t>(sent_until_utime_ - kStart_utime) * 1000;
      packets.push_back(core::livox::PackPacket({.timestamp = ns}, points));
      sent_until_utime_ += 960;
      datagrams.push_back({{kFirstSensorIp, 60'001}, {}, sent_until_utime_ + 100});
    }
    for (std::size_t i = 0; i < packets.size(); ++i) datagrams[i].bytes = packets[i];
    const std::span<const net::Datagram> all(datagrams);
    for (std::size_t i = 0; i < all.size(); i += 64) {
      handlers_[56001](all.subspan(i, std::min<std::size_t>(64, all.size() - i)));
    }
    count_ += packets.size();
  }
  [[nodiscard]] bool samples() const {
    return device_.sampling(runtime_.MonotonicUs()).has_value();
  }
  [[nodiscard]] std::size_t count() const { return count_; }

 private:
  class Port final : public net::Socket {
   public:
    explicit Port(StalledNetwork& network) : network_(network) {}
    bool Send(const net::Endpoint&, std::span<const std::byte> bytes) override {
      network_.Carry(
          network_.device_.Receive({kHostIp, 55501}, bytes, network_.runtime_.MonotonicUs()));
      return true;
    }
    [[nodiscard]] net::Endpoint local() const override { return {}; }
    [[nodiscard]] net::SocketCounts counts() const override { return {}; }
    [[nodiscard]] int receive_buffer_bytes() const override { return -1; }

   private:
    StalledNetwork& network_;
  };

  // Later, so that no handler is called from within another.
  void Carry(const std::vector<core::EmulatedMid70::Outgoing>& frames) {
    for (const auto& frame : frames) {
      const bool is_broadcast = frame.code == core::livox::CommandCode::kBroadcast;
      runtime_.After(0, [this, bytes = frame.bytes, port = is_broadcast ? 55000 : 55501] {
        const net::Datagram datagram{{kFirstSensorIp, 65000}, bytes, runtime_.UtimeNow()};
        handlers_[static_cast<std::uint16_t>(port)]({&datagram, 1});
      });
    }
  }

  process::Runtime& runtime_;
  core::EmulatedMid70 device_;
  std::map<std::uint16_t, Handler> handlers_;
  std::int64_t sent_until_utime_ = 0;
  std::size_t count_ = 0;
};

TEST_F(SimulatedDriverTest, PacketsThatWaitedInTheSocketDoNotComeLate) {
  AddLidar("3GGDJ6K00100101", "");
  StallingRuntime stalling(runtime_);
  StalledNetwork network(runtime_);
  node_ = std::make_unique<process::Node>(
      stalling,
      process::Identity{.process = "livox_driver", .version = "", .config_digest = ""},
      messages::channels::kLivoxDriverStatus);
  driver_ = std::make_unique<LivoxDriverProcess>(config_, vehicle_, *node_, network);
  for (int i = 0; i < 300 && !network.samples(); ++i) {
    network.Tick();
    RunFor(0.01);
  }
  ASSERT_TRUE(network.samples());
  for (int i = 0; i < 500; ++i) {
    network.DeliverPackets();
    RunFor(0.004);
  }

  for (int stall = 0; stall < 5; ++stall) {
    stalling.is_stalled = true;
    RunFor(0.3);
    // The sockets are read before timers run.
    network.DeliverPackets();
    stalling.is_stalled = false;
    for (int i = 0; i < 50; ++i) {
      RunFor(0.004);
      network.DeliverPackets();
    }
  }
  RunFor(0.1);

  const core::livox::StreamCounts& counts = driver_->output(0).stream().counts();
  EXPECT_EQ(counts.packets, static_cast<std::int64_t>(network.count()));
  EXPECT_EQ(counts.late_packets, 0);
  EXPECT_EQ(counts.lost_packets, 0);
  driver_.reset();  // Before its network.
}

}  // namespace
}  // namespace clearway
