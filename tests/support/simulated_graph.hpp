// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "common/graph/graph_config.hpp"
#include "common/messages/channels.hpp"
#include "common/messages/encoding.hpp"
#include "common/process/node.hpp"
#include "common/process/simulated_runtime.hpp"
#include "tests/support/relay_runtime.hpp"
#include "tools/play/player.hpp"
#include "tools/replay/memory_graph.hpp"

namespace clearway::test {

/// A message as the bus delivered it.
struct TappedMessage {
  std::int64_t time_us = 0;  ///< Virtual time.
  std::string channel;
  std::vector<std::byte> bytes;
  friend bool operator==(const TappedMessage&, const TappedMessage&) = default;
};

/// A decoded message and when it was delivered.
template <typename Message>
struct Timed {
  std::int64_t time_us = 0;
  Message message;
};

/// The scans of a test, as a source that can be played.
class ListedScans final : public play::ScanSource {
 public:
  explicit ListedScans(std::vector<core::PointCloud> scans, std::int64_t period_us = 100'000)
      : scans_(std::move(scans)), period_us_(period_us) {}

  [[nodiscard]] std::size_t size() const override { return scans_.size(); }
  [[nodiscard]] std::int64_t period_us() const override { return period_us_; }
  [[nodiscard]] std::int64_t utime(std::size_t i) const override {
    return 1'000'000'000'000'000 + static_cast<std::int64_t>(i) * period_us_;
  }
  [[nodiscard]] play::PlayedScan Read(std::size_t i) override {
    return {scans_[i], utime(i), "listed#" + std::to_string(i)};
  }

 private:
  std::vector<core::PointCloud> scans_;
  std::int64_t period_us_;
};

/// The shipped configuration of the lab: one stationary sensor, "front".
[[nodiscard]] graph::GraphConfig LabConfig();

/// The lab's sensor in tests/support/free_room_scene.xml, where the way ahead is free.
[[nodiscard]] std::unique_ptr<play::ScanSource> FreeRoom(double seconds);

/// All scans of a source.
[[nodiscard]] std::vector<core::PointCloud> ReadAll(play::ScanSource& source);

/// A MemoryGraph with players, and ears.
class SimulatedGraph {
 public:
  using Parts = replay::GraphParts;
  static constexpr std::int64_t kStart = 1'700'000'000'000'000;

  explicit SimulatedGraph(const graph::GraphConfig& config);
  /// `map` is what the map server serves; without one there is no map server.
  SimulatedGraph(const graph::GraphConfig& config,
                 const Parts& parts,
                 std::optional<core::OccupancyGrid> map = std::nullopt);

  [[nodiscard]] process::SimulatedRuntime& runtime() { return graph_.runtime(); }
  [[nodiscard]] std::int64_t now_us() const { return graph_.runtime().MonotonicUs(); }

  /// Starts a player now; what it publishes on LIDAR_POINTS goes through `wire` when that is given.
  void Play(play::ScanSource& source, RelayRuntime::Decide wire = {});

  void RunFor(std::int64_t duration_us) { runtime().RunUntil(now_us() + duration_us); }

  /// Runs until the last player is done and its last scan has gone through; at most 10 minutes.
  void RunToTheEnd();

  [[nodiscard]] const std::vector<TappedMessage>& tapped() const { return tapped_; }

  /// Everything delivered on a channel that decodes.
  template <typename Message>
  [[nodiscard]] std::vector<Timed<Message>> On(const messages::Channel<Message>& channel) const {
    std::vector<Timed<Message>> found;
    for (const TappedMessage& message : tapped_) {
      if (message.channel != channel.name) continue;
      auto decoded = messages::Decode<Message>(message.bytes);
      if (decoded) found.push_back({message.time_us, *std::move(decoded)});
    }
    return found;
  }

  /// The newest status after all processes have been asked for it.
  [[nodiscard]] status_t FreshStatus(const messages::Channel<status_t>& channel);

 private:
  struct Playing {
    std::unique_ptr<RelayRuntime> relay;
    std::unique_ptr<process::Node> node;
    std::unique_ptr<play::Player> player;
  };

  replay::MemoryGraph graph_;
  std::vector<TappedMessage> tapped_;
  std::vector<Playing> players_;
  std::size_t num_done_ = 0;
};

/// A counter of a status; -1 when it has none of that name.
[[nodiscard]] std::int64_t CounterOf(const status_t& status, const std::string& name);

/// True when all four limits are 0.
[[nodiscard]] bool IsStop(const drive_permit_t& permit);

}  // namespace clearway::test
