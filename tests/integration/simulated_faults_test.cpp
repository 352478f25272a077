// SPDX-License-Identifier: BSD-3-Clause
// The whole graph behind a bad wire: what is lost, repeated, overtaken, late, foreign or garbage is
// counted, and nothing else happens.
#include <algorithm>
#include <array>
#include <functional>
#include <map>
#include <ostream>
#include <random>
#include <set>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/simulated_graph.hpp"

namespace clearway::test {
namespace {

namespace channels = messages::channels;

constexpr std::int64_t kSecond = 1'000'000;

// Loses, repeats and delays slices by chance, and keeps the books.
class BadWire {
 public:
  struct Odds {
    double lost = 0.0;
    double repeated = 0.0;
    double overtaken = 0.0;  // Delayed by one and a half slices.
    double late = 0.0;       // Delayed beyond the assembler's patience.
  };
  // Odd figures: no delivery falls together with a deadline or with another slice.
  static constexpr std::int64_t kOvertaken_us = 15'037;
  static constexpr std::int64_t kLate_us = 130'041;

  BadWire(std::uint64_t seed, const Odds& odds) : random_(seed), odds_(odds) {}

  RelayRuntime::Deliveries operator()(std::span<const std::byte> bytes) {
    const auto slice = messages::Decode<lidar_points_t>(bytes).value();
    highest_ = std::max(highest_, slice.sequence);
    const double chance = static_cast<double>(random_() >> 11U) * 0x1p-53;
    if (chance < odds_.lost) {
      lost_.insert(slice.sequence);
      return {};
    }
    if (chance < odds_.lost + odds_.repeated) return {0, kOvertaken_us};
    if (chance < odds_.lost + odds_.repeated + odds_.overtaken) return {kOvertaken_us};
    if (chance < odds_.lost + odds_.repeated + odds_.overtaken + odds_.late) return {kLate_us};
    return {0};
  }

  // Of those that a receiver can know of: before the last one that it got.
  [[nodiscard]] std::int64_t NumLostBefore(std::int64_t sequence) const {
    return std::distance(lost_.begin(), lost_.lower_bound(sequence));
  }

 private:
  std::mt19937_64 random_;
  Odds odds_;
  std::set<std::int64_t> lost_;
  std::int64_t highest_ = -1;
};

struct ScanOnTheWire {
  std::int32_t slice_count = 0;
  std::map<std::int32_t, std::int64_t> first_arrival_us;  // By slice index.

  [[nodiscard]] std::int32_t MissingAt(std::int64_t time_us) const {
    std::int32_t there = 0;
    for (const auto& [index, arrival_us] : first_arrival_us) there += arrival_us <= time_us ? 1 : 0;
    return slice_count - there;
  }
};

std::map<std::int64_t, ScanOnTheWire> ScansOnTheWire(const SimulatedGraph& graph) {
  std::map<std::int64_t, ScanOnTheWire> scans;
  for (const auto& slice : graph.On(channels::kLidarPoints)) {
    ScanOnTheWire& scan = scans[slice.message.scan_id];
    scan.slice_count = slice.message.slice_count;
    scan.first_arrival_us.emplace(slice.message.slice_index, slice.time_us);
  }
  return scans;
}

struct WireCase {
  std::string name;
  BadWire::Odds odds;

  friend void PrintTo(const WireCase& wire, std::ostream* out) { *out << wire.name; }
};

// A whole run behind one wire.
struct WireRun {
  explicit WireRun(const WireCase& wire_case) : wire(20240607, wire_case.odds) {
    static ListedScans scans(ReadAll(*FreeRoom(5.0)));
    graph.Play(scans, std::ref(wire));
    graph.RunToTheEnd();
  }
  BadWire wire;
  SimulatedGraph graph{LabConfig()};
};

// All tests of one wire look at the same run.
class BadWireTest : public testing::TestWithParam<WireCase> {
 protected:
  static WireRun& Run() {
    static std::map<std::string, std::unique_ptr<WireRun>> runs;
    std::unique_ptr<WireRun>& run = runs[GetParam().name];
    if (!run) run = std::make_unique<WireRun>(GetParam());
    return *run;
  }
  BadWire& wire_ = Run().wire;
  SimulatedGraph& graph_ = Run().graph;
};

TEST_P(BadWireTest, EachScanComesOutOnceInOrderAndTellsWhatWasMissing) {
  const auto wire = ScansOnTheWire(graph_);
  std::int64_t last_id = -1;
  std::int64_t incomplete = 0;

  const auto outputs = graph_.On(channels::kObstaclePoints);

  std::set<std::int64_t> seen;
  for (const auto& output : outputs) {
    const obstacle_points_t& points = output.message;
    if (points.slice_index != 0) continue;
    EXPECT_GT(points.scan_id, last_id);
    last_id = points.scan_id;
    seen.insert(points.scan_id);
    EXPECT_EQ(points.missing_slices, wire.at(points.scan_id).MissingAt(output.time_us))
        << "scan " << points.scan_id;
    EXPECT_EQ(points.scan_state == obstacle_points_t::SCAN_INCOMPLETE, points.missing_slices > 0);
    incomplete += points.missing_slices > 0 ? 1 : 0;
  }
  // A scan of which the first slice comes after a newer one has gone out comes too late as a whole.
  EXPECT_EQ(seen.size(), wire.size());
  const status_t status = graph_.FreshStatus(channels::kPreprocessorStatus);
  EXPECT_EQ(CounterOf(status, "scans"), static_cast<std::int64_t>(seen.size()));
  EXPECT_EQ(CounterOf(status, "scans_incomplete"), incomplete);
}

TEST_P(BadWireTest, DetectionsOfIncompleteScansSaySo) {
  std::map<std::int64_t, std::int8_t> state_of_points;
  for (const auto& points : graph_.On(channels::kObstaclePoints)) {
    state_of_points[points.message.scan_id] = points.message.scan_state;
  }

  const auto detections = graph_.On(channels::kDetections);

  std::map<std::int64_t, std::int8_t> state_of_detections;
  for (const auto& slice : detections) {
    state_of_detections[slice.message.scan_id] = slice.message.scan_state;
  }
  EXPECT_EQ(state_of_detections, state_of_points);
}

TEST_P(BadWireTest, TheCountersAddUp) {
  const auto slices = graph_.On(channels::kLidarPoints);
  std::int64_t newest = -1;
  for (const auto& slice : slices) newest = std::max(newest, slice.message.sequence);
  std::int64_t assembled = 0;
  const auto wire = ScansOnTheWire(graph_);
  for (const auto& output : graph_.On(channels::kObstaclePoints)) {
    const obstacle_points_t& points = output.message;
    if (points.slice_index != 0) continue;
    assembled += wire.at(points.scan_id).slice_count - points.missing_slices;
  }

  const status_t preprocessor = graph_.FreshStatus(channels::kPreprocessorStatus);
  const status_t guard = graph_.FreshStatus(channels::kStopGuardStatus);

  EXPECT_EQ(preprocessor.received, static_cast<std::int64_t>(slices.size()));
  EXPECT_EQ(preprocessor.received,
            assembled + CounterOf(preprocessor, "slices_duplicate") +
                CounterOf(preprocessor, "slices_late"));
  for (const char* name : {"slices_foreign", "slices_inconsistent", "slices_unknown_sensor"}) {
    EXPECT_EQ(CounterOf(preprocessor, name), 0) << name;
  }
  EXPECT_EQ(preprocessor.missing, wire_.NumLostBefore(newest));
  EXPECT_EQ(guard.missing, wire_.NumLostBefore(newest));
  EXPECT_EQ(CounterOf(guard, "slices"), static_cast<std::int64_t>(slices.size()));
  EXPECT_EQ(preprocessor.invalid + guard.invalid, 0);
  EXPECT_EQ(preprocessor.foreign + guard.foreign, 0);
}

TEST_P(BadWireTest, ThePermitIsOpenWhileFreshSlicesComeAndNeverWithoutThem) {
  constexpr std::int64_t kLimit_us = 100'000;
  // What is news: a slice newer than all before it. Others must not make the sensor fresh.
  std::vector<std::int64_t> news_us;
  std::int64_t newest = -1;
  for (const auto& slice : graph_.On(channels::kLidarPoints)) {
    if (slice.message.sequence <= newest) continue;
    newest = slice.message.sequence;
    news_us.push_back(slice.time_us);
  }

  const auto permits = graph_.On(channels::kDrivePermit);

  std::size_t num_open = 0;
  for (std::size_t i = 0; i < permits.size(); ++i) {
    EXPECT_EQ(permits[i].message.sequence, static_cast<std::int64_t>(i));
    if (IsStop(permits[i].message)) continue;
    ++num_open;
    const auto after = std::upper_bound(news_us.begin(), news_us.end(), permits[i].time_us);
    ASSERT_NE(after, news_us.begin());
    EXPECT_LE(permits[i].time_us - *std::prev(after), kLimit_us);
  }
  EXPECT_GT(num_open, permits.size() / 2);
}

INSTANTIATE_TEST_SUITE_P(
    Wires,
    BadWireTest,
    testing::Values(WireCase{"Good", {}},
                    WireCase{"Losing", {.lost = 0.05}},
                    WireCase{"LosingMost", {.lost = 0.4}},
                    WireCase{"Repeating", {.repeated = 0.2}},
                    WireCase{"Overtaking", {.overtaken = 0.2}},
                    WireCase{"Delaying", {.late = 0.05}},
                    WireCase{"DoingAllOfIt",
                             {.lost = 0.03, .repeated = 0.05, .overtaken = 0.1, .late = 0.02}}),
    [](const auto& test) { return test.param.name; });

TEST(ForeignPublisherTest, ASecondPublisherOfOneSensorIsReportedAndStopsTheVehicle) {
  const auto first = FreeRoom(20.0);
  const auto second = FreeRoom(20.0);
  SimulatedGraph graph(LabConfig());
  const std::int64_t second_from_us = graph.now_us() + 2 * kSecond;
  const std::int64_t second_until_us = graph.now_us() + 4 * kSecond;

  graph.Play(*first);
  graph.RunFor(2 * kSecond + 4'321);  // So that the two take turns.
  const std::int64_t foreign_before = graph.FreshStatus(channels::kStopGuardStatus).foreign;
  graph.Play(*second, [&](auto) {
    return graph.now_us() < second_until_us ? RelayRuntime::Deliveries{0}
                                            : RelayRuntime::Deliveries{};
  });
  graph.RunFor(6 * kSecond);

  EXPECT_EQ(foreign_before, 0);
  EXPECT_GT(graph.FreshStatus(channels::kStopGuardStatus).foreign, 0);
  const status_t preprocessor = graph.FreshStatus(channels::kPreprocessorStatus);
  EXPECT_GT(preprocessor.foreign, 0);
  EXPECT_GT(CounterOf(preprocessor, "slices_foreign"), 0);
  bool was_reported = false;
  for (const auto& permit : graph.On(channels::kDrivePermit)) {
    // The first slices of the newcomer look like a restart; then the old one is heard again.
    if (permit.time_us < second_from_us + 200'000 || permit.time_us > second_until_us) continue;
    EXPECT_TRUE(IsStop(permit.message)) << permit.time_us - SimulatedGraph::kStart;
    was_reported |= permit.message.reason == drive_permit_t::REASON_TWO_PUBLISHERS;
  }
  EXPECT_TRUE(was_reported);
  EXPECT_EQ(graph.On(channels::kDrivePermit).back().message.reason, drive_permit_t::REASON_FREE);
}

// Everything but status, and what was put in on purpose.
std::vector<TappedMessage> WorkOf(const SimulatedGraph& graph,
                                  const std::vector<std::vector<std::byte>>& put_in = {}) {
  std::vector<TappedMessage> work;
  for (const TappedMessage& message : graph.tapped()) {
    if (message.channel.ends_with("_STATUS")) continue;
    if (std::find(put_in.begin(), put_in.end(), message.bytes) != put_in.end()) continue;
    work.push_back(message);
  }
  return work;
}

void ExpectSameWork(const std::vector<TappedMessage>& work,
                    const std::vector<TappedMessage>& expected) {
  ASSERT_EQ(work.size(), expected.size());
  for (std::size_t i = 0; i < work.size(); ++i) {
    ASSERT_TRUE(work[i] == expected[i]) << "message " << i << " on " << expected[i].channel;
  }
}

std::vector<TappedMessage> WorkOfACleanRun(double seconds) {
  const auto room = FreeRoom(seconds);
  SimulatedGraph graph(LabConfig());
  graph.Play(*room);
  graph.RunToTheEnd();
  return WorkOf(graph);
}

TEST(UnknownSensorTest, ItsSlicesAreCountedAndChangeNothingElse) {
  const auto room = FreeRoom(1.0);
  SimulatedGraph graph(LabConfig());
  lidar_points_t stranger{};
  stranger.sensor = "nobody";
  stranger.session = 77;
  stranger.scan_id = 1000;
  stranger.scan_end_utime = 100'000;
  stranger.slice_count = 1;
  const std::vector<std::byte> bytes = messages::Encode(stranger);

  graph.Play(*room);
  graph.RunFor(500'000);
  graph.runtime().Publish(channels::kLidarPoints.bus, channels::kLidarPoints.name, bytes);
  graph.RunToTheEnd();

  EXPECT_EQ(CounterOf(graph.FreshStatus(channels::kPreprocessorStatus), "slices_unknown_sensor"),
            1);
  EXPECT_EQ(CounterOf(graph.FreshStatus(channels::kStopGuardStatus), "slices_unknown_sensor"), 1);
  auto expected = WorkOfACleanRun(1.0);
  auto work = WorkOf(graph, {bytes});
  // Permits tell the newest slice that came, whoever sent it: compare what they permit.
  const auto is_permit = [](const TappedMessage& m) {
    return m.channel == channels::kDrivePermit.name;
  };
  std::erase_if(expected, is_permit);
  std::erase_if(work, is_permit);
  ExpectSameWork(work, expected);
  EXPECT_EQ(graph.On(channels::kDrivePermit).back().message.reason,
            drive_permit_t::REASON_SENSOR_SILENT);
}

std::vector<std::vector<std::byte>> GarbageLike(const std::vector<std::byte>& good) {
  std::vector<std::vector<std::byte>> garbage;
  garbage.emplace_back();
  garbage.emplace_back(good.begin(), good.begin() + 7);
  garbage.emplace_back(good.begin(), good.end() - 1);
  garbage.push_back(good);
  garbage.back().push_back(std::byte{0});
  garbage.push_back(good);
  garbage.back()[3] ^= std::byte{1};  // Another type's fingerprint.
  garbage.emplace_back(good.begin(), good.begin() + 8);
  garbage.back().resize(good.size(), std::byte{0xFF});  // All lengths are -1.
  garbage.emplace_back(60'000, std::byte{0xA5});
  return garbage;
}

struct GarbageCase {
  std::string channel;
  messages::BusId bus;
  std::vector<std::byte> good;
  std::vector<messages::Channel<status_t>> listeners;
};

std::vector<GarbageCase> GarbageCases() {
  lidar_points_t lidar{};
  lidar.sensor = "front";
  return {{channels::kLidarPoints.name,
           channels::kLidarPoints.bus,
           messages::Encode(lidar),
           {channels::kPreprocessorStatus, channels::kStopGuardStatus}},
          {channels::kObstaclePoints.name,
           channels::kObstaclePoints.bus,
           messages::Encode(obstacle_points_t{}),
           {channels::kClustererStatus}},
          {channels::kDetections.name,
           channels::kDetections.bus,
           messages::Encode(detections_t{}),
           {channels::kStopGuardStatus}}};
}

TEST(GarbageTest, BytesThatDoNotDecodeAreCountedAsInvalidAndChangeNothingElse) {
  const std::vector<TappedMessage> expected = WorkOfACleanRun(1.0);
  for (const GarbageCase& garbage : GarbageCases()) {
    SCOPED_TRACE(garbage.channel);
    const auto room = FreeRoom(1.0);
    SimulatedGraph graph(LabConfig());
    std::vector<std::vector<std::byte>> put_in;

    graph.Play(*room);
    for (const std::vector<std::byte>& bytes : GarbageLike(garbage.good)) {
      graph.RunFor(100'000);
      graph.runtime().Publish(garbage.bus, garbage.channel, bytes);
      put_in.push_back(bytes);
    }
    graph.RunToTheEnd();

    ExpectSameWork(WorkOf(graph, put_in), expected);
    for (const auto& channel :
         {channels::kPreprocessorStatus, channels::kClustererStatus, channels::kStopGuardStatus}) {
      const bool listens = std::any_of(
          garbage.listeners.begin(), garbage.listeners.end(), [&](const auto& listener) {
            return std::string(listener.name) == channel.name;
          });
      EXPECT_EQ(graph.FreshStatus(channel).invalid,
                listens ? static_cast<std::int64_t>(put_in.size()) : 0)
          << channel.name;
    }
  }
}

TEST(GarbageTest, OdometryThatDoesNotDecodeOrIsNoPoseIsCountedAsInvalid) {
  graph::GraphConfig config = LabConfig();
  config.vehicle.stationary = false;
  const auto room = FreeRoom(1.0);
  SimulatedGraph graph(config);

  graph.Play(*room);
  graph.RunFor(300'000);
  const auto garbage = GarbageLike(messages::Encode(odometry_t{}));
  for (const auto& bytes : garbage) {
    graph.runtime().Publish(channels::kOdometry.bus, channels::kOdometry.name, bytes);
  }
  odometry_t no_pose{};  // A quaternion of length zero.
  graph.runtime().Publish(
      channels::kOdometry.bus, channels::kOdometry.name, messages::Encode(no_pose));
  graph.RunToTheEnd();

  const auto count = static_cast<std::int64_t>(garbage.size());
  EXPECT_EQ(graph.FreshStatus(channels::kPreprocessorStatus).invalid, count + 1);
  // One of them decodes, to NaN: the type has no length that could be wrong.
  const status_t guard = graph.FreshStatus(channels::kStopGuardStatus);
  EXPECT_EQ(guard.invalid + CounterOf(guard, "odometry_invalid"), count);
}

// Messages that decode, but whose fields no sender can mean.
TEST(GarbageTest, SlicesWithImpossibleFieldsAreCountedAndChangeNoDetection) {
  const std::vector<std::function<void(lidar_points_t&)>> defects{
      [](auto& m) { m.slice_count = 0; },
      [](auto& m) { m.slice_index = m.slice_count; },
      [](auto& m) { m.slice_index = -1; },
      [](auto& m) { m.slice_count = 1 << 30; },
      [](auto& m) { m.scan_end_utime = m.scan_utime - 1; },
      [](auto& m) { m.scan_end_utime = std::numeric_limits<std::int64_t>::max(); },
      [](auto& m) { m.scan_utime = std::numeric_limits<std::int64_t>::min(); },
      [](auto& m) { m.scan_id = -1; },
      [](auto& m) { m.shots = -1; },
      [](auto& m) { m.zero_returns = -1; }};
  const auto room = FreeRoom(1.0);
  SimulatedGraph graph(LabConfig());

  graph.Play(*room);
  graph.RunFor(300'000);
  lidar_points_t slice = graph.On(channels::kLidarPoints).back().message;
  std::vector<std::vector<std::byte>> put_in;
  for (const auto& break_it : defects) {
    lidar_points_t broken = slice;
    break_it(broken);
    put_in.push_back(messages::Encode(broken));
    graph.runtime().Publish(
        channels::kLidarPoints.bus, channels::kLidarPoints.name, messages::Encode(broken));
  }
  graph.RunToTheEnd();

  const auto count = static_cast<std::int64_t>(defects.size());
  EXPECT_EQ(graph.FreshStatus(channels::kPreprocessorStatus).invalid, count);
  EXPECT_EQ(CounterOf(graph.FreshStatus(channels::kStopGuardStatus), "slices_invalid"), count);
  const auto is_detections = [](const TappedMessage& m) {
    return m.channel != channels::kDetections.name;
  };
  auto expected = WorkOfACleanRun(1.0);
  auto work = WorkOf(graph, put_in);
  std::erase_if(expected, is_detections);
  std::erase_if(work, is_detections);
  ExpectSameWork(work, expected);
}

}  // namespace
}  // namespace clearway::test
