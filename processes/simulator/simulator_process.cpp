// SPDX-License-Identifier: BSD-3-Clause
#include "processes/simulator/simulator_process.hpp"

#include <algorithm>
#include <span>
#include <stdexcept>
#include <string>
#include <utility>

#include "common/core/simulation/noise.hpp"
#include "common/core/simulation/scene_geometry.hpp"
#include "common/messages/truth.hpp"

namespace clearway {
namespace {

using messages::channels::kTruth;

// The sensors' last packets of a scan leave after its end.
constexpr std::int64_t kTruthDelay_us = 30'000;

}  // namespace

SimulatorProcess::SimulatorProcess(const core::SimulatorConfig& config,
                                   const core::VehicleConfig& vehicle,
                                   Setting setting,
                                   process::Node& node,
                                   net::Network& network)
    : config_(config),
      setting_(std::move(setting)),
      node_(node),
      clock_(node.runtime()),
      world_(setting_.scene, setting_.walls),
      tally_(core::DescribeObjects(setting_.scene).size(), {.period_us = setting_.scan_period_us}),
      base_(config.robot,
            vehicle,
            setting_.scene,
            setting_.walls,
            static_cast<std::uint64_t>(config.seed),
            node,
            clock_) {
  for (std::size_t i = 0; i < config_.sensors.size(); ++i) AddSensor(i, vehicle, network);
  base_.OnContact([this](const core::Contact&) { Refresh(); });
  node_.BeforeStatus([this] { Refresh(); });
  ScheduleTruth();
  Refresh();
}

void SimulatorProcess::AddSensor(std::size_t index,
                                 const core::VehicleConfig& vehicle,
                                 net::Network& network) {
  const core::EmulatedSensorConfig& config = config_.sensors[index];
  const std::optional<int> mounted = vehicle.FindSensor(config.sensor);
  if (!mounted) {
    throw std::invalid_argument("simulator.mid70[" + std::to_string(index) + "].sensor \"" +
                                config.sensor + "\": no sensor of the vehicle has that name");
  }
  // Sensors at one place must not have the same noise.
  const auto seed = core::SplitMix64(static_cast<std::uint64_t>(config_.seed) + 1000 * (index + 1));
  eyes_.push_back(std::make_unique<SensorEyes>(
      config_.lidar,
      seed,
      vehicle.sensors[static_cast<std::size_t>(*mounted)].T_vehicle_sensor(),
      world_,
      base_,
      tally_,
      setting_.scan_period_us,
      clock_));
  // A sensor's time starts with it, a moment after the world's.
  const std::int64_t start_us = clock_.Now();
  sensors_.push_back(std::make_unique<EmulatedSensor>(
      config,
      seed,
      node_.runtime(),
      network,
      [&eyes = *eyes_.back(), start_us](std::int64_t first_shot,
                                        std::int64_t time_us,
                                        core::livox::ReturnMode mode,
                                        std::span<core::SimulatedShot> shots) {
        eyes.Fire(first_shot, start_us + time_us, mode, shots);
      }));
}

// Scans lie on the grid of the time of day.
void SimulatorProcess::ScheduleTruth() {
  const std::int64_t utime = node_.runtime().UtimeNow();
  const std::int64_t scan_id = (utime - kTruthDelay_us) / setting_.scan_period_us;
  const std::int64_t due_utime = (scan_id + 1) * setting_.scan_period_us + kTruthDelay_us;
  node_.runtime().After(due_utime - utime, [this, scan_id] {
    PublishTruth(scan_id);
    ScheduleTruth();
  });
}

void SimulatorProcess::PublishTruth(std::int64_t scan_id) {
  const std::int64_t end_utime = (scan_id + 1) * setting_.scan_period_us;
  const std::int64_t end_us = clock_.TimeOf(end_utime);
  if (end_us < 0) return;  // The scan ended before the world began.
  messages::Truth truth;
  truth.utime = end_utime;
  truth.scan_id = scan_id;
  truth.T_map_vehicle = base_.StateAt(end_us).in_map.Transform();
  truth.boxes = core::TruthBoxesAt(setting_.scene, end_us);
  if (!sensors_.empty()) {
    for (const core::RayTally& rays : tally_.TakeScan(scan_id * setting_.scan_period_us)) {
      truth.rays.push_back({rays.points, std::max<std::int64_t>(0, rays.first_ray_us)});
    }
  }
  node_.Publish(kTruth, messages::ToTruth(truth));
}

void SimulatorProcess::SetSensorCounters() {
  EmulatedSensorCounts sum;
  for (const auto& sensor : sensors_) {
    const EmulatedSensorCounts& counts = sensor->counts();
    sum.packets += counts.packets;
    sum.lost += counts.lost;
    sum.silenced += counts.silenced;
    sum.duplicates += counts.duplicates;
    sum.reordered += counts.reordered;
    sum.skipped += counts.skipped;
  }
  node_.SetCounter("packets", sum.packets);
  node_.SetCounter("packets_lost_on_purpose", sum.lost);
  node_.SetCounter("packets_silenced", sum.silenced);
  node_.SetCounter("packets_duplicated", sum.duplicates);
  node_.SetCounter("packets_reordered", sum.reordered);
  node_.SetCounter("packets_skipped", sum.skipped);
}

std::string SimulatorProcess::SensorText() const {
  std::string text;
  for (const auto& sensor : sensors_) {
    if (!sensor->is_on()) {
      text += "; " + sensor->config().sensor + " has no power";
    } else if (!sensor->device().host()) {
      text += "; " + sensor->config().sensor + " at " + sensor->config().ip + " waits for a driver";
    }
  }
  return text;
}

void SimulatorProcess::Refresh() {
  base_.SetCounters();
  SetSensorCounters();
  process::State state = base_.State();
  const std::string sensors = SensorText();
  state.text += sensors;
  if (!sensors.empty() && state.code == status_t::STATE_OK) state.code = status_t::STATE_WAITING;
  node_.SetState(state);
}

}  // namespace clearway
