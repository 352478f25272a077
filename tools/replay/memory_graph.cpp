// SPDX-License-Identifier: BSD-3-Clause
#include "tools/replay/memory_graph.hpp"

#include <set>
#include <utility>

#include "processes/clusterer/clusterer_process.hpp"
#include "processes/livox_driver/livox_driver_process.hpp"
#include "processes/map_server/map_server_process.hpp"
#include "processes/pose_source/pose_source_process.hpp"
#include "processes/preprocessor/preprocessor_process.hpp"
#include "processes/stop_guard/stop_guard_process.hpp"

namespace clearway::replay {
namespace {

namespace channels = messages::channels;

process::SimulatedRuntime::Limits LimitsOf(const graph::GraphConfig& config) {
  return {.max_message_bytes = static_cast<std::size_t>(config.buses.local.max_message_bytes),
          .burst_interval_us = config.buses.local.burst_interval_us};
}

// Those of the sensors that are not in 127.0.0.0/8, which every host has.
std::vector<core::Ipv4> AddressesOf(const core::SimulatorConfig& config) {
  std::set<core::Ipv4> addresses;
  for (const core::EmulatedSensorConfig& sensor : config.sensors) {
    const core::Ipv4 ip = *core::ParseIpv4(sensor.ip);
    if (ip >> 24U != 127U) addresses.insert(ip);
  }
  return {addresses.begin(), addresses.end()};
}

}  // namespace

MemoryGraph::MemoryGraph(const graph::GraphConfig& config, MemoryGraphSettings settings)
    : runtime_(settings.start_utime, LimitsOf(config)),
      settings_(std::move(settings)),
      wire_(runtime_) {
  const GraphParts& parts = settings_.parts;
  if (parts.map_server && settings_.map) {
    AddProcess<MapServerProcess>(*std::move(settings_.map),
                                 AddNode("map_server", channels::kMapServerStatus));
    settings_.map.reset();
  }
  if (parts.pose_source && config.pose_source.mode != core::PoseSourceMode::kOff) {
    AddProcess<PoseSourceProcess>(config.pose_source,
                                  AddNode("pose_source", channels::kPoseSourceStatus));
  }
  if (parts.preprocessor) {
    AddProcess<PreprocessorProcess>(config.preprocessor,
                                    config.vehicle,
                                    AddNode("preprocessor", channels::kPreprocessorStatus));
  }
  if (parts.clusterer) {
    AddProcess<ClustererProcess>(config.clusterer.backend,
                                 config.clusterer.clustering,
                                 AddNode("clusterer", channels::kClustererStatus));
  }
  if (parts.stop_guard) {
    AddProcess<StopGuardProcess>(
        config.stop_guard, config.vehicle, AddNode("stop_guard", channels::kStopGuardStatus));
  }
  if (settings_.simulation) AddSimulation(config);
}

// One host, as on a loopback: its addresses are those of the sensors and the driver.
void MemoryGraph::AddSimulation(const graph::GraphConfig& config) {
  hosts_.push_back(std::make_unique<net::MemoryHost>(wire_, AddressesOf(config.simulator)));
  net::MemoryHost& host = *hosts_.back();
  if (settings_.parts.livox_driver) {
    AddProcess<LivoxDriverProcess>(config.livox_driver,
                                   config.vehicle,
                                   AddNode("livox_driver", channels::kLivoxDriverStatus),
                                   host);
  }
  AddProcess<SimulatorProcess>(config.simulator,
                               config.vehicle,
                               *std::move(settings_.simulation),
                               AddNode("simulator", channels::kSimulatorStatus),
                               host);
  settings_.simulation.reset();
}

process::Node& MemoryGraph::AddNode(const std::string& name,
                                    const messages::Channel<status_t>& channel) {
  nodes_.push_back(std::make_unique<process::Node>(
      runtime_, process::Identity{name, settings_.version, settings_.config_digest}, channel));
  return *nodes_.back();
}

template <typename Process, typename... Arguments>
void MemoryGraph::AddProcess(Arguments&&... arguments) {
  processes_.push_back(std::make_shared<Process>(std::forward<Arguments>(arguments)...));
}

void MemoryGraph::PublishStatuses() {
  for (const auto& node : nodes_) node->RefreshAndPublishStatus();
  runtime_.RunUntil(runtime_.MonotonicUs());
}

}  // namespace clearway::replay
