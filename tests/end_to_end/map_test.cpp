// SPDX-License-Identifier: BSD-3-Clause
// A map on its way between real programs: killed servers, and a large map beside running scans.
#include <algorithm>
#include <optional>
#include <random>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "common/io/map/map_writer.hpp"
#include "common/messages/channels.hpp"
#include "common/process/live_runtime.hpp"
#include "common/process/map_client.hpp"
#include "common/process/node.hpp"
#include "tests/support/kill_fixture.hpp"

namespace clearway::test {
namespace {

using core::OccupancyGrid;
namespace channels = messages::channels;

// Rooms of 8 x 8 m with walls of one cell, doors, clutter, and unknown space between some of them.
OccupancyGrid Building(int side) {
  OccupancyGrid map{{side, side, 0.05, -5.0, -5.0, 0.0}, {}};
  map.cells.assign(map.geometry.num_cells(), OccupancyGrid::kFree);
  std::mt19937 random(5);
  constexpr int kRoom = 160;
  for (int row = 0; row < side; ++row) {
    for (int column = 0; column < side; ++column) {
      std::uint8_t& cell = map.cells[map.geometry.IndexOf({column, row})];
      const bool is_wall = row % kRoom == 0 || column % kRoom == 0;
      const bool is_door = row % kRoom > 70 && row % kRoom < 90;
      if ((row / kRoom + column / kRoom) % 4 == 3) cell = OccupancyGrid::kUnknown;
      if ((is_wall && !is_door) || random() % 200 == 0) cell = OccupancyGrid::kOccupied;
    }
  }
  return map;
}

// Nothing that run-length coding could make shorter.
OccupancyGrid Noise(int side) {
  OccupancyGrid map{{side, side, 0.05, -5.0, -5.0, 0.0}, {}};
  map.cells.resize(map.geometry.num_cells());
  std::mt19937 random(6);
  for (std::uint8_t& cell : map.cells) {
    cell = random() % 2 == 0 ? OccupancyGrid::kFree : OccupancyGrid::kOccupied;
  }
  return map;
}

class MapTest : public RunningGraphTest {
 protected:
  std::string SaveMap(const OccupancyGrid& map) const {
    const auto yaml = folder_.path() / "map.yaml";
    io::SaveMap(map, yaml);
    return yaml;
  }

  // A graph that filters with that map, from a fixed pose.
  [[nodiscard]] RunningGraph GraphWithMap(const OccupancyGrid& map,
                                          const std::vector<std::string>& more = {}) const {
    std::vector<std::string> arguments{"--config",
                                       SourceFolder() / "config" / "lab_standing.xml",
                                       "--lcm-url",
                                       url_,
                                       "--set",
                                       "map_server.file=" + SaveMap(map),
                                       "--set",
                                       "preprocessor.map_filter.enabled=true",
                                       "--set",
                                       "pose_source.mode=fixed"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return {url_,
            arguments,
            {"--input",
             SourceFolder() / "tests" / "support" / "free_room_scene.xml",
             "--scene-seconds",
             "2",
             "--loop"},
            folder_.path()};
  }

  // The stop guard goes on without a map: a permit to move comes.
  bool AwaitPermitToMove() {
    const std::size_t seen = listener_.permits.size();
    return listener_.Await([&] {
      return listener_.permits.size() > seen && listener_.permits.back().message.forward_mps > 0.0;
    });
  }

  bool AwaitMapState(std::int8_t state) {
    return listener_.Await([&] {
      return !listener_.detections.empty() &&
             listener_.detections.back().message.map_state == state;
    });
  }
};

TEST_F(MapTest, WhenTheServerIsKilledNothingIsFilteredAnyMoreUntilItIsBack) {
  RunningGraph graph = GraphWithMap(Building(400));
  for (const char* process : {"map_server", "pose_source"}) graph.Start(process);
  graph.StartAll();
  ASSERT_TRUE(AwaitMapState(obstacle_points_t::MAP_FILTERED)) << Describe();
  const std::int64_t epoch = listener_.detections.back().message.map_epoch;

  graph.Kill("map_server");
  const std::int64_t killed_us = GraphListener::NowUs();
  ASSERT_TRUE(AwaitMapState(obstacle_points_t::MAP_MISSING)) << Describe();
  Report("server_killed_to_nothing_filtered_ms", GraphListener::NowUs() - killed_us);

  EXPECT_EQ(listener_.detections.back().message.map_epoch, 0);
  ASSERT_TRUE(listener_.Await([&] {
    return listener_.statuses.at("preprocessor").message.text.find("silent") != std::string::npos;
  })) << Describe();
  EXPECT_EQ(listener_.statuses.at("preprocessor").message.state, status_t::STATE_DEGRADED);
  EXPECT_TRUE(AwaitPermitToMove()) << Describe();

  graph.Start("map_server");
  ASSERT_TRUE(AwaitMapState(obstacle_points_t::MAP_FILTERED)) << Describe();
  EXPECT_GT(listener_.detections.back().message.map_epoch, epoch);
}

TEST_F(MapTest, WhenThePoseSourceIsKilledNothingIsFilteredAnyMore) {
  RunningGraph graph = GraphWithMap(Building(400));
  for (const char* process : {"map_server", "pose_source"}) graph.Start(process);
  graph.StartAll();
  ASSERT_TRUE(AwaitMapState(obstacle_points_t::MAP_FILTERED)) << Describe();

  graph.Kill("pose_source");
  const std::int64_t killed_us = GraphListener::NowUs();

  ASSERT_TRUE(AwaitMapState(obstacle_points_t::POSE_OLD)) << Describe();
  Report("pose_source_killed_to_nothing_filtered_ms", GraphListener::NowUs() - killed_us);
  EXPECT_TRUE(AwaitPermitToMove()) << Describe();
}

// What a client that comes late gets over LCM, at the socket buffer of a stock kernel, while the
// graph works beside it.
class LargeMapTest : public MapTest {
 protected:
  static constexpr int kStockBuffer_bytes = 212'992;

  // Nothing was lost by anybody.
  void ExpectNothingMissing() const {
    for (const auto& [process, status] : listener_.statuses) {
      EXPECT_EQ(status.message.missing, 0) << process;
      EXPECT_EQ(status.message.dropped, 0) << process;
    }
  }

  void ExpectToArriveWhole(const OccupancyGrid& map, const std::string& name) {
    const std::string stock = std::to_string(kStockBuffer_bytes);
    RunningGraph graph = GraphWithMap(map,
                                      {"--set",
                                       "buses.local.receive_buffer_bytes=" + stock,
                                       "--set",
                                       "buses.shared.receive_buffer_bytes=" + stock});
    for (const char* process : {"map_server", "pose_source"}) graph.Start(process);
    graph.StartAll();
    ASSERT_TRUE(AwaitMapState(obstacle_points_t::MAP_FILTERED)) << Describe();

    process::BusesConfig buses;
    buses.local.url = buses.shared.url = url_;
    buses.local.receive_buffer_bytes = buses.shared.receive_buffer_bytes = kStockBuffer_bytes;
    process::LiveRuntime runtime(buses, "");
    process::Node node(runtime, {"late_client", "test", "digest"}, channels::kRunStatus);
    std::optional<std::int64_t> asked_us;
    node.Subscribe<map_request_t>(channels::kMapRequest, [&](const map_request_t& request) {
      if (request.client == "late_client" && !asked_us) asked_us = runtime.MonotonicUs();
    });
    process::MapClient client(node, "late_client");
    while (client.map() == nullptr &&
           runtime.MonotonicUs() - asked_us.value_or(runtime.MonotonicUs()) < 60'000'000) {
      runtime.RunFor(20'000);
    }

    ASSERT_NE(client.map(), nullptr) << client.Trouble();
    Report(name + "_request_to_whole_map_ms", runtime.MonotonicUs() - *asked_us);
    EXPECT_EQ(client.map()->grid.cells, map.cells);
    node.RefreshAndPublishStatus();
    EXPECT_TRUE(listener_.Await([&] { return listener_.statuses.contains("late_client"); }));
    ExpectNothingMissing();
  }
};

TEST_F(LargeMapTest, ABuildingArrivesWholeBesideRunningScans) {
  ExpectToArriveWhole(Building(kIsSanitized ? 1000 : 4000), "building");
}

TEST_F(LargeMapTest, NoiseThatDoesNotCompressArrivesWholeBesideRunningScans) {
  ExpectToArriveWhole(Noise(kIsSanitized ? 300 : 1500), "noise");
}

}  // namespace
}  // namespace clearway::test
