// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "common/core/mapping/occupancy_grid.hpp"
#include "common/graph/graph_config.hpp"
#include "common/messages/channels.hpp"
#include "common/net/memory_network.hpp"
#include "common/process/node.hpp"
#include "common/process/simulated_runtime.hpp"
#include "processes/simulator/simulator_process.hpp"

namespace clearway::replay {

/// Which processes of a graph may run. Each message reaches them in this order.
struct GraphParts {
  bool map_server = true;   ///< When there is a map.
  bool pose_source = true;  ///< When the configuration gives it something to do.
  bool preprocessor = true;
  bool clusterer = true;
  bool stop_guard = true;
  bool livox_driver = true;  ///< When there is a simulator for it.
};

struct MemoryGraphSettings {
  std::int64_t start_utime = 0;                 ///< Virtual time of the start [us since the epoch].
  std::string version = {};                     ///< As the statuses tell it.
  std::string config_digest = {};               ///< Likewise.
  std::optional<core::OccupancyGrid> map = {};  ///< What the map server serves; nothing: no server.
  GraphParts parts = {};
  /// What is simulated; nothing: no simulator and no driver.
  std::optional<SimulatorProcess::Setting> simulation = {};
};

/// The process objects of a graph, each with its own node, on one in-memory bus in virtual time:
/// what the programs of a live graph are, in a fixed order and without threads. A simulator's
/// sensors and the driver talk over a network in memory. Same configuration, same messages in: same
/// messages out, byte for byte.
class MemoryGraph {
 public:
  /// Makes the processes. Their first messages are delivered when virtual time runs, so that a tap
  /// set by then sees all.
  MemoryGraph(const graph::GraphConfig& config, MemoryGraphSettings settings);
  MemoryGraph(const MemoryGraph&) = delete;
  MemoryGraph& operator=(const MemoryGraph&) = delete;

  [[nodiscard]] process::SimulatedRuntime& runtime() { return runtime_; }
  [[nodiscard]] const process::SimulatedRuntime& runtime() const { return runtime_; }

  /// Asks all processes for their status, as a process gives it when it ends.
  void PublishStatuses();

 private:
  process::Node& AddNode(const std::string& name, const messages::Channel<status_t>& channel);

  template <typename Process, typename... Arguments>
  void AddProcess(Arguments&&... arguments);

  void AddSimulation(const graph::GraphConfig& config);

  process::SimulatedRuntime runtime_;
  MemoryGraphSettings settings_;
  net::MemoryWire wire_;
  std::vector<std::unique_ptr<net::MemoryHost>> hosts_;
  std::vector<std::unique_ptr<process::Node>> nodes_;
  std::vector<std::shared_ptr<void>> processes_;
};

}  // namespace clearway::replay
