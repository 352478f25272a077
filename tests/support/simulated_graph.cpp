// SPDX-License-Identifier: BSD-3-Clause
#include "tests/support/simulated_graph.hpp"

#include <stdexcept>
#include <utility>

#include "common/config/config.hpp"
#include "common/process/log.hpp"
#include "tests/support/test_data.hpp"

namespace clearway::test {
namespace {

namespace channels = messages::channels;

constexpr std::int64_t kDrain_us = 500'000;
constexpr std::int64_t kLongest_us = 600'000'000;

// The processes begin to log when they are made; the tests look at STATUS.
const graph::GraphConfig& WithoutLog(const graph::GraphConfig& config) {
  process::SetUpLog("test", "off");
  return config;
}

}  // namespace

graph::GraphConfig LabConfig() {
  return config::Load<graph::GraphConfig>(SourceFolder() / "config" / "lab_standing.xml").root;
}

std::unique_ptr<play::ScanSource> FreeRoom(double seconds) {
  return play::OpenSource(
      SourceFolder() / "tests" / "support" / "free_room_scene.xml", LabConfig(), seconds);
}

std::vector<core::PointCloud> ReadAll(play::ScanSource& source) {
  std::vector<core::PointCloud> scans;
  for (std::size_t i = 0; i < source.size(); ++i) scans.push_back(source.Read(i).cloud_sensor);
  return scans;
}

SimulatedGraph::SimulatedGraph(const graph::GraphConfig& config)
    : SimulatedGraph(config, Parts{}) {}

SimulatedGraph::SimulatedGraph(const graph::GraphConfig& config,
                               const Parts& parts,
                               std::optional<core::OccupancyGrid> map)
    : graph_(WithoutLog(config),
             {.start_utime = kStart,
              .version = "test",
              .config_digest = "digest",
              .map = std::move(map),
              .parts = parts}) {
  runtime().SetTap(
      [this](messages::BusId, const std::string& channel, std::span<const std::byte> bytes) {
        tapped_.push_back({now_us(), channel, {bytes.begin(), bytes.end()}});
      });
}

void SimulatedGraph::Play(play::ScanSource& source, RelayRuntime::Decide wire) {
  if (!wire) wire = [](auto) { return RelayRuntime::Deliveries{0}; };
  Playing playing;
  playing.relay =
      std::make_unique<RelayRuntime>(runtime(), channels::kLidarPoints.name, std::move(wire));
  playing.node = std::make_unique<process::Node>(
      *playing.relay, process::Identity{"play", "test", "digest"}, channels::kPlayStatus);
  playing.player = std::make_unique<play::Player>(
      *playing.node, source, play::PlayerSettings{.sensor = "front"}, [this] { ++num_done_; });
  players_.push_back(std::move(playing));
}

void SimulatedGraph::RunToTheEnd() {
  const std::int64_t give_up_us = now_us() + kLongest_us;
  while (num_done_ < players_.size()) {
    if (now_us() > give_up_us) throw std::runtime_error("the players do not come to an end");
    RunFor(100'000);
  }
  RunFor(kDrain_us);
}

status_t SimulatedGraph::FreshStatus(const messages::Channel<status_t>& channel) {
  graph_.PublishStatuses();
  const auto statuses = On(channel);
  if (statuses.empty()) throw std::runtime_error(std::string("nothing on ") + channel.name);
  return statuses.back().message;
}

std::int64_t CounterOf(const status_t& status, const std::string& name) {
  for (const counter_t& counter : status.counters) {
    if (counter.name == name) return counter.value;
  }
  return -1;
}

bool IsStop(const drive_permit_t& permit) {
  return permit.forward_mps == 0.0 && permit.backward_mps == 0.0 && permit.turn_left_radps == 0.0 &&
         permit.turn_right_radps == 0.0;
}

}  // namespace clearway::test
