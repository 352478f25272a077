// SPDX-License-Identifier: BSD-3-Clause
// Node and LiveRuntime over real LCM: channels, buses, bursts, gaps.
#include <algorithm>
#include <functional>
#include <map>
#include <optional>
#include <set>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "common/process/live_runtime.hpp"
#include "common/process/node.hpp"
#include "tests/support/live_buses.hpp"
#include "tests/support/pump.hpp"

namespace clearway::process {
namespace {

namespace channels = messages::channels;

using messages::BusId;
using test::TestBuses;
using test::TestUrl;

constexpr std::int64_t kDeadline_us = 20'000'000;
constexpr messages::Channel<drive_request_t> kMarker{"MARKER", BusId::kLocal};

const std::byte kByte{42};
const std::span<const std::byte> kMessage(&kByte, 1);

// Runs `step` every 20 ms until it says that it is done; false at the deadline.
bool RunUntil(LiveRuntime& runtime, const std::function<bool()>& step) {
  bool done = false;
  const test::Pump pump(runtime, [&] {
    done = step();
    if (done) runtime.Stop();
  });
  runtime.RunFor(kDeadline_us);
  return done;
}

TEST(LiveBusTest, ChannelNamesAreTakenLiterally) {
  LiveRuntime runtime(TestBuses(17120), "p+(1)[a].");
  std::multiset<std::string> heard;
  for (const std::string name : {"A.C", "A*", "^A$", "A|B", "A{2}", "\\A"}) {
    runtime.Subscribe(BusId::kLocal, name, [&heard, name](auto) { heard.insert(name); });
  }
  runtime.Subscribe(BusId::kLocal, "END", [&](auto) { heard.insert("END"); });

  const bool done = RunUntil(runtime, [&] {
    for (const char* name : {"ABC", "A", "AA", "AAA", "B", "AxC", "A.C", "A*", "END"}) {
      runtime.Publish(BusId::kLocal, name, kMessage);
    }
    return heard.count("END") >= 3;
  });

  ASSERT_TRUE(done);
  EXPECT_GE(heard.count("A.C"), 3U);
  EXPECT_GE(heard.count("A*"), 3U);
  for (const char* name : {"^A$", "A|B", "A{2}", "\\A"}) EXPECT_EQ(heard.count(name), 0U) << name;
  EXPECT_EQ(heard.count("A.C"), heard.count("A*"));  // Nothing but their own.
}

TEST(LiveBusTest, TwoPrefixesOnOnePortAreApart) {
  LiveRuntime left(TestBuses(17121), "left/");
  LiveRuntime right(TestBuses(17121), "right/");
  int to_left = 0;
  int to_right = 0;
  left.Subscribe(BusId::kLocal, "A", [&](auto) { ++to_left; });
  right.Subscribe(BusId::kLocal, "A", [&](auto) { ++to_right; });

  const bool done = RunUntil(right, [&] {
    right.Publish(BusId::kLocal, "A", kMessage);
    return to_right >= 5;
  });
  left.RunFor(50'000);

  EXPECT_TRUE(done);
  EXPECT_EQ(to_left, 0);
}

TEST(LiveBusTest, TwoBusesOnTwoPortsAreApart) {
  BusesConfig buses = TestBuses(17122);
  buses.shared.url = TestUrl(17123);
  LiveRuntime runtime(buses, "");
  int on_local = 0;
  int on_shared = 0;
  int end_of_local = 0;
  runtime.Subscribe(BusId::kLocal, "A", [&](auto) { ++on_local; });
  runtime.Subscribe(BusId::kLocal, "END", [&](auto) { ++end_of_local; });
  runtime.Subscribe(BusId::kShared, "A", [&](auto) { ++on_shared; });

  const bool done = RunUntil(runtime, [&] {
    runtime.Publish(BusId::kShared, "A", kMessage);
    runtime.Publish(BusId::kLocal, "END", kMessage);
    return on_shared >= 5 && end_of_local >= 5;
  });

  EXPECT_TRUE(done);
  EXPECT_EQ(on_local, 0);
}

TEST(LiveBusTest, OneUrlForBothBusesIsOneBus) {
  LiveRuntime runtime(TestBuses(17124), "");
  int heard = 0;
  runtime.Subscribe(BusId::kShared, "A", [&](auto) { ++heard; });

  EXPECT_TRUE(RunUntil(runtime, [&] {
    runtime.Publish(BusId::kLocal, "A", kMessage);
    return heard >= 1;
  }));
}

TEST(LiveBusTest, TheReceiveBufferThatTheKernelGrantedIsReported) {
  BusesConfig buses = TestBuses(17125);
  buses.local.receive_buffer_bytes = buses.shared.receive_buffer_bytes = 100'000;
  LiveRuntime runtime(buses, "");
  EXPECT_EQ(runtime.ReceiveBufferBytes(), -1);

  runtime.Subscribe(BusId::kLocal, "A", [](auto) {});

  EXPECT_EQ(runtime.ReceiveBufferBytes(), 100'000);
}

// One slice of LIDAR_POINTS of about 57 kB.
lidar_points_t LargeSlice() {
  constexpr std::size_t kPoints = 3150;
  lidar_points_t slice{};
  slice.sensor = "front";
  slice.slice_count = 7;
  slice.n = kPoints;
  slice.x.resize(kPoints);
  slice.y.resize(kPoints);
  slice.z.resize(kPoints);
  slice.intensity.resize(kPoints);
  slice.tag.resize(kPoints);
  slice.time_offset_us.resize(kPoints);
  return slice;
}

// The stock buffer holds about half of such a burst when it is sent at once. A loaded machine may
// keep LCM's thread waiting for longer than the pause between slices, so one burst proves nothing:
// unpaced ones never arrive complete, paced ones nearly always.
TEST(LiveBusTest, PacedBurstsArriveCompleteWithTheStockReceiveBuffer) {
  constexpr int kEnough = 10;
  constexpr int kSlices = 7;
  BusesConfig buses = TestBuses(17126);
  buses.local.receive_buffer_bytes = buses.shared.receive_buffer_bytes = 212'992;
  LiveRuntime runtime(buses, "");
  Node node(runtime, {"test", "test", "digest"}, channels::kRunStatus);
  std::map<std::int64_t, int> arrived;
  int complete = 0;
  std::size_t largest = 0;
  node.Subscribe<lidar_points_t>(channels::kLidarPoints, [&](const lidar_points_t& slice) {
    complete += ++arrived[slice.scan_id] == kSlices ? 1 : 0;
  });
  runtime.Subscribe(
      channels::kLidarPoints.bus,
      channels::kLidarPoints.name,
      [&](std::span<const std::byte> bytes) { largest = std::max(largest, bytes.size()); });

  std::int64_t bursts = 0;
  const bool done = RunUntil(runtime, [&] {
    if (complete >= kEnough) return true;
    std::vector<lidar_points_t> burst(kSlices, LargeSlice());
    for (int k = 0; k < kSlices; ++k) {
      burst[static_cast<std::size_t>(k)].scan_id = bursts;
      burst[static_cast<std::size_t>(k)].slice_index = k;
    }
    ++bursts;
    node.PublishBurst(channels::kLidarPoints, std::move(burst));
    return false;
  });

  RecordProperty("bursts_sent", static_cast<int>(bursts));
  RecordProperty("bursts_complete", complete);
  EXPECT_TRUE(done);
  EXPECT_GT(largest, 56'000U);
  EXPECT_LE(largest, 58'000U);
  EXPECT_GE(2 * complete, bursts);
}

TEST(LiveBusTest, GapsInTheSequenceAreCounted) {
  LiveRuntime runtime(TestBuses(17127), "");
  Node node(runtime, {"test", "test", "digest"}, channels::kRunStatus);
  std::int64_t handled = 0;
  std::int64_t first = -1;
  std::int64_t newest = -1;
  node.Subscribe<drive_request_t>(kMarker, [&](const drive_request_t& message) {
    if (++handled == 1) first = message.sequence;
    newest = message.sequence;
  });
  std::int64_t sequence = 0;
  ASSERT_TRUE(RunUntil(runtime, [&] {
    drive_request_t message{};
    message.session = 7;
    message.sequence = sequence;
    sequence += 3;  // Two are missing each time.
    runtime.Publish(kMarker.bus, kMarker.name, messages::Encode(message));
    return handled >= 5;
  }));
  std::optional<status_t> status;
  node.Subscribe<status_t>(channels::kRunStatus, [&](const status_t& m) { status = m; });

  const bool done = RunUntil(runtime, [&] {
    node.RefreshAndPublishStatus();
    return status.has_value();
  });

  ASSERT_TRUE(done);
  EXPECT_EQ(status->missing, newest - first - (handled - 1));
  EXPECT_GT(status->receive_buffer_bytes, 0);
}

}  // namespace
}  // namespace clearway::process
