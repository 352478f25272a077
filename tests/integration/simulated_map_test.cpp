// SPDX-License-Identifier: BSD-3-Clause
// The map server, its client and the map filter on one bus in virtual time.
#include <algorithm>
#include <cstdint>
#include <limits>
#include <memory>
#include <random>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "common/core/mapping/run_length.hpp"
#include "common/messages/encoding.hpp"
#include "common/messages/map_tiles.hpp"
#include "common/process/log.hpp"
#include "common/process/map_client.hpp"
#include "common/process/simulated_runtime.hpp"
#include "processes/map_server/map_server_process.hpp"
#include "tests/support/relay_runtime.hpp"

namespace clearway {
namespace {

using core::OccupancyGrid;
using messages::channels::kMap;
using messages::channels::kMapRequest;
using messages::channels::kMapServerStatus;
using messages::channels::kPreprocessorStatus;
using process::MapClient;
using test::RelayRuntime;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;

constexpr std::int64_t kStart = 1'700'000'000'000'000;
constexpr std::int64_t kSecond = 1'000'000;

// Rooms, so to speak: runs of free and unknown cells between walls, from a seed.
OccupancyGrid RandomMap(int width, int height, std::uint32_t seed) {
  OccupancyGrid map{{width, height, 0.05, -3.0, -2.0, 0.3}, {}};
  std::mt19937 random(seed);
  constexpr std::uint8_t kValues[] = {
      OccupancyGrid::kFree, OccupancyGrid::kOccupied, OccupancyGrid::kUnknown, 37};
  while (map.cells.size() < map.geometry.num_cells()) {
    const std::size_t left = map.geometry.num_cells() - map.cells.size();
    map.cells.insert(
        map.cells.end(), std::min<std::size_t>(left, 1 + random() % 40), kValues[random() % 4]);
  }
  return map;
}

class Server {
 public:
  Server(process::Runtime& runtime, OccupancyGrid map)
      : node_(runtime, {"map_server", "test", "digest"}, kMapServerStatus),
        process_(std::move(map), node_) {}

 private:
  process::Node node_;
  MapServerProcess process_;
};

class SimulatedMapTest : public testing::Test {
 protected:
  SimulatedMapTest() {
    process::SetUpLog("test", "off");
    runtime_.SetTap([this](auto, const std::string& channel, std::span<const std::byte> bytes) {
      if (channel == kMap.name) tiles_.push_back(*messages::Decode<map_tile_t>(bytes));
      if (channel == kMapRequest.name) ++requests_;
      if (channel == kMapServerStatus.name) {
        const status_t status = *messages::Decode<status_t>(bytes);
        ++server_statuses_;
        for (const counter_t& counter : status.counters) {
          if (counter.name == "map_epoch") announced_ = {status.session, counter.value};
        }
      }
      if (channel == kPreprocessorStatus.name) client_status_ = *messages::Decode<status_t>(bytes);
    });
  }

  void RunFor(std::int64_t duration_us) { runtime_.RunUntil(runtime_.MonotonicUs() + duration_us); }

  // As from a server that the test plays.
  void Announce(const core::MapVersion& version) {
    status_t status{};
    status.session = version.session;
    status.sequence = next_announcement_++;
    status.n = 1;
    status.counters.resize(1);
    status.counters.front().name = "map_epoch";
    status.counters.front().value = version.epoch;
    runtime_.Publish(kMapServerStatus.bus, kMapServerStatus.name, messages::Encode(status));
    RunFor(1000);
  }

  void Publish(const core::MapTile& tile) {
    map_tile_t message = messages::ToLcm(tile);
    message.session = tile.version.session;
    runtime_.Publish(kMap.bus, kMap.name, messages::Encode(message));
    RunFor(0);
  }

  process::SimulatedRuntime runtime_{kStart, {.max_message_bytes = 1400}};
  std::vector<map_tile_t> tiles_;
  int requests_ = 0;
  std::int64_t server_statuses_ = 0;
  core::MapVersion announced_;  // By the newest status of a server.
  status_t client_status_{};
  std::int64_t next_announcement_ = 0;
  process::Node client_node_{runtime_, {"preprocessor", "test", "digest"}, kPreprocessorStatus};
};

TEST_F(SimulatedMapTest, AMapReachesAClientCellByCellWithOneRequest) {
  const OccupancyGrid map = RandomMap(300, 200, 1);
  MapClient client(client_node_, "preprocessor");
  EXPECT_THAT(client.Trouble(), HasSubstr("no map server"));

  Server server(runtime_, map);
  RunFor(2 * kSecond);

  ASSERT_NE(client.map(), nullptr);
  EXPECT_EQ(client.map()->grid, map);
  EXPECT_THAT(client.Trouble(), IsEmpty());
  EXPECT_EQ(requests_, 1);
  EXPECT_EQ(std::ssize(tiles_), tiles_.front().slice_count);
}

TEST_F(SimulatedMapTest, ALateClientHasTheMapAfterTheServersNextStatus) {
  const OccupancyGrid map = RandomMap(100, 100, 2);
  Server server(runtime_, map);
  RunFor(10 * kSecond);

  MapClient client(client_node_, "preprocessor");
  RunFor(2 * kSecond);

  ASSERT_NE(client.map(), nullptr);
  EXPECT_EQ(client.map()->grid, map);
}

TEST_F(SimulatedMapTest, TilesThatWereLostAreAskedForAgainAndOnlyThose) {
  const OccupancyGrid map = RandomMap(300, 200, 3);
  MapClient client(client_node_, "preprocessor");
  int sent = 0;
  RelayRuntime wire(runtime_, kMap.name, [&sent](auto) {
    return ++sent % 3 == 0 ? RelayRuntime::Deliveries{} : RelayRuntime::Deliveries{0};
  });

  Server server(wire, map);
  RunFor(10 * kSecond);

  ASSERT_NE(client.map(), nullptr);
  EXPECT_EQ(client.map()->grid, map);
  EXPECT_GT(requests_, 1);
  EXPECT_LT(sent, 2 * tiles_.front().slice_count);
}

TEST_F(SimulatedMapTest, TilesMayComeTwiceAndInAnyOrder) {
  const OccupancyGrid map = RandomMap(200, 200, 4);
  MapClient client(client_node_, "preprocessor");
  std::mt19937 random(4);
  RelayRuntime wire(runtime_, kMap.name, [&random](auto) {
    return RelayRuntime::Deliveries{static_cast<std::int64_t>(random() % 100'000),
                                    static_cast<std::int64_t>(random() % 100'000)};
  });

  Server server(wire, map);
  RunFor(5 * kSecond);

  ASSERT_NE(client.map(), nullptr);
  EXPECT_EQ(client.map()->grid, map);
}

TEST_F(SimulatedMapTest, ADamagedTileIsCountedAndAskedForAgain) {
  const OccupancyGrid map = RandomMap(100, 100, 5);
  MapClient client(client_node_, "preprocessor");
  RelayRuntime wire(runtime_, kMap.name, [](auto) { return RelayRuntime::Deliveries{}; });
  Server server(wire, map);
  RunFor(kSecond);
  core::MapTile tile{.version = {1, 1},
                     .geometry = map.geometry,
                     .index = 0,
                     .count = 1,
                     .rectangle = {0, 0, 100, 100},
                     .cells = map.cells};
  tile.version = announced_;
  map_tile_t damaged = messages::ToLcm(tile);
  damaged.session = tile.version.session;
  damaged.data.back() = static_cast<std::uint8_t>(damaged.data.back() ^ 1U);

  runtime_.Publish(kMap.bus, kMap.name, messages::Encode(damaged));
  RunFor(kSecond);

  EXPECT_EQ(client.map(), nullptr);
  EXPECT_GT(requests_, 1);
  client_node_.RefreshAndPublishStatus();
  RunFor(0);
  EXPECT_EQ(client_status_.invalid, 1);
}

// The halves of a map.
core::MapTile Half(const OccupancyGrid& map, const core::MapVersion& version, int index) {
  const int rows = map.geometry.height / 2;
  const core::CellRectangle rectangle{0, index * rows, map.geometry.width, rows};
  return {.version = version,
          .geometry = map.geometry,
          .index = index,
          .count = 2,
          .rectangle = rectangle,
          .cells = core::CellsOf(map, rectangle),
          .map_checksum = core::Checksum(map.cells)};
}

TEST_F(SimulatedMapTest, AFirstTileThatContradictsTheOthersDoesNotKeepTheMapAwayForEver) {
  MapClient client(client_node_, "preprocessor");
  const OccupancyGrid map = RandomMap(20, 20, 21);
  const core::MapVersion version{77, 100};
  Announce(version);
  Publish({.version = version,
           .geometry = {5000, 5000, 0.05, 0.0, 0.0, 0.0},
           .index = 7,
           .count = 25'000'000,
           .rectangle = {0, 0, 1, 1},
           .cells = {0}});

  for (const int index : {0, 1, 0}) Publish(Half(map, version, index));

  ASSERT_NE(client.map(), nullptr) << client.Trouble();
  EXPECT_EQ(client.map()->grid, map);
}

TEST_F(SimulatedMapTest, AVersionThatIsAnnouncedAgainAfterANewerOneIsTaken) {
  MapClient client(client_node_, "preprocessor");
  const OccupancyGrid map = RandomMap(20, 20, 22);
  for (const std::int64_t epoch : {100, 200, 100}) {
    Announce({77, epoch});
    Publish(Half(map, {77, epoch}, 1));
    RunFor(kSecond / 2);
  }

  Publish(Half(map, {77, 100}, 0));

  ASSERT_NE(client.map(), nullptr) << client.Trouble();
  EXPECT_EQ(client.map()->grid, map);
}

TEST_F(SimulatedMapTest, EpochsThatAreNoneGiveNoMapAndNoRequests) {
  MapClient client(client_node_, "preprocessor");

  for (const std::int64_t epoch :
       {std::numeric_limits<std::int64_t>::min(), std::int64_t{-1}, std::int64_t{0}}) {
    Announce({77, epoch});
    RunFor(kSecond);
    EXPECT_THAT(client.Trouble(), HasSubstr("has no map"));
  }

  EXPECT_EQ(requests_, 0);
}

TEST_F(SimulatedMapTest, AMapChecksumBeyondItsWidthIsRefused) {
  const OccupancyGrid map = RandomMap(20, 20, 23);
  map_tile_t tile = messages::ToLcm(core::MapTile{.version = {77, 100},
                                                  .geometry = map.geometry,
                                                  .index = 0,
                                                  .count = 1,
                                                  .rectangle = {0, 0, 20, 20},
                                                  .cells = map.cells,
                                                  .map_checksum = core::Checksum(map.cells)});
  ASSERT_TRUE(messages::FromLcm(tile));

  for (const std::int64_t wrong :
       {tile.map_checksum + (std::int64_t{1} << 32), tile.map_checksum - (std::int64_t{1} << 32)}) {
    tile.map_checksum = wrong;
    EXPECT_FALSE(messages::FromLcm(tile));
  }
}

TEST_F(SimulatedMapTest, WhenTheServerFallsSilentItsMapIsNotUsedUntilItIsHeardAgain) {
  bool is_silent = false;
  RelayRuntime wire(runtime_, kMapServerStatus.name, [&is_silent](auto) {
    return is_silent ? RelayRuntime::Deliveries{} : RelayRuntime::Deliveries{0};
  });
  MapClient client(client_node_, "preprocessor");
  Server server(wire, RandomMap(50, 50, 6));
  RunFor(2 * kSecond);
  ASSERT_NE(client.map(), nullptr);

  is_silent = true;
  RunFor(4 * kSecond);

  EXPECT_EQ(client.map(), nullptr);
  EXPECT_THAT(client.Trouble(), HasSubstr("silent"));

  is_silent = false;
  RunFor(kSecond);

  EXPECT_NE(client.map(), nullptr);
}

TEST_F(SimulatedMapTest, AServerThatStartsAnewIsFollowedToItsMap) {
  const OccupancyGrid second_map = RandomMap(60, 40, 8);
  bool first_lives = true;
  RelayRuntime wire(runtime_, kMapServerStatus.name, [&first_lives](auto) {
    return first_lives ? RelayRuntime::Deliveries{0} : RelayRuntime::Deliveries{};
  });
  MapClient client(client_node_, "preprocessor");
  Server first(wire, RandomMap(50, 50, 7));
  RunFor(2 * kSecond);
  const std::int64_t first_epoch = client.map()->version.epoch;

  first_lives = false;
  RunFor(3 * kSecond);
  Server second(runtime_, second_map);
  RunFor(2 * kSecond);

  ASSERT_NE(client.map(), nullptr);
  EXPECT_EQ(client.map()->grid, second_map);
  EXPECT_GT(client.map()->version.epoch, first_epoch);
}

TEST_F(SimulatedMapTest, TwoServersAreBelievedNeither) {
  MapClient client(client_node_, "preprocessor");
  Server first(runtime_, RandomMap(50, 50, 9));
  RunFor(2 * kSecond);
  ASSERT_NE(client.map(), nullptr);

  Server second(runtime_, RandomMap(50, 50, 10));
  RunFor(5 * kSecond);

  EXPECT_EQ(client.map(), nullptr);
  EXPECT_THAT(client.Trouble(), HasSubstr("two map servers"));
}

TEST_F(SimulatedMapTest, AWindowIsAnsweredWithTheTilesThatItTouches) {
  OccupancyGrid map = RandomMap(300, 200, 11);
  map.geometry.origin_yaw_rad = 0.0;
  Server server(runtime_, map);
  map_request_t request{};
  request.window_min[0] = -2.0;
  request.window_min[1] = 0.0;
  request.window_max[0] = -1.0;
  request.window_max[1] = 0.5;

  client_node_.Publish(kMapRequest, request);
  RunFor(2 * kSecond);

  ASSERT_THAT(tiles_, Not(IsEmpty()));
  EXPECT_LT(std::ssize(tiles_), tiles_.front().slice_count);
  core::MapAssembler assembler;
  for (const map_tile_t& tile : tiles_) assembler.Add(messages::FromLcm(tile).value());
  EXPECT_TRUE(assembler.Covers({-2.0, 0.0}, {-1.0, 0.5}));
  EXPECT_FALSE(assembler.IsComplete());
}

TEST_F(SimulatedMapTest, AFloodOfAbsurdRequestsNeitherMultipliesTilesNorSilencesTheServer) {
  Server server(runtime_, RandomMap(300, 200, 24));
  const double inf = std::numeric_limits<double>::infinity();
  const double nan = std::numeric_limits<double>::quiet_NaN();
  std::vector<map_request_t> requests(5);
  requests[0].window_min[0] = nan;
  requests[1].window_min[0] = requests[1].window_min[1] = -inf;
  requests[1].window_max[0] = requests[1].window_max[1] = inf;
  requests[2].window_min[0] = requests[2].window_min[1] = 1e300;
  requests[2].window_max[0] = requests[2].window_max[1] = 2e300;
  requests[3].epoch = kStart;
  for (int i = 0; i < 20'000; ++i) {
    requests[3].missing.push_back(i % 2 == 0 ? 1 : std::numeric_limits<int>::min() + i);
  }
  requests[3].n_missing = static_cast<std::int32_t>(requests[3].missing.size());
  requests[4].epoch = std::numeric_limits<std::int64_t>::max();
  requests[4].client = "\x1b[2J\n\x80";
  RunFor(0);
  const std::int64_t statuses_before = server_statuses_;

  for (int i = 0; i < 2000; ++i) {
    client_node_.Publish(kMapRequest, requests[static_cast<std::size_t>(i % 5)]);
    RunFor(1000);
  }

  EXPECT_EQ(server_statuses_ - statuses_before, 2);
  EXPECT_LE(std::ssize(tiles_), 2000 * 1000 / 2000 + 1);  // The pace, whatever is asked for.
}

TEST_F(SimulatedMapTest, RequestsThatCannotBeMetAreCountedAndNothingIsSent) {
  Server server(runtime_, RandomMap(50, 50, 12));
  map_request_t observed{};
  observed.layer = map_request_t::LAYER_OBSERVED;
  map_request_t elsewhere{};
  elsewhere.window_min[0] = elsewhere.window_min[1] = 1000.0;
  elsewhere.window_max[0] = elsewhere.window_max[1] = 1001.0;
  map_request_t no_such_tile{};
  no_such_tile.epoch = kStart;
  no_such_tile.missing = {-1, 1'000'000};
  no_such_tile.n_missing = 2;

  for (const map_request_t& request : {observed, elsewhere, no_such_tile}) {
    client_node_.Publish(kMapRequest, request);
  }
  RunFor(2 * kSecond);

  EXPECT_THAT(tiles_, IsEmpty());
}

}  // namespace
}  // namespace clearway
