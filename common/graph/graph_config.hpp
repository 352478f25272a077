// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "common/config/config.hpp"
#include "common/core/guard/stop_guard_config.hpp"
#include "common/core/perception/clustering/clusterer.hpp"
#include "common/core/preprocessing/preprocessor.hpp"
#include "common/core/vehicle.hpp"
#include "common/io/recording_config.hpp"
#include "common/process/buses_config.hpp"

namespace clearway::graph {

/// Settings of the clusterer. XML element: <clusterer>.
struct ClustererConfig {
  core::Backend backend = core::Backend::kTextbook;
  core::ClusteringConfig clustering;

  template <typename Self, typename Visitor>
  static void Visit(Self& self, Visitor& visitor) {
    visitor.Choice("backend", self.backend, core::kBackendNames, "Which implementation runs.");
    visitor.Group("clustering", self.clustering, "How points are joined to obstacles.");
  }
};

/// The one configuration file of a graph: each process takes its own element and the shared ones,
/// and refuses the file when anything in it is wrong. XML element: <clearway>.
struct GraphConfig {
  process::BusesConfig buses;
  core::VehicleConfig vehicle;
  io::RecordingConfig recording;
  core::PreprocessorConfig preprocessor;
  ClustererConfig clusterer;
  core::StopGuardConfig stop_guard;

  template <typename Self, typename Visitor>
  static void Visit(Self& self, Visitor& visitor) {
    visitor.Group("buses", self.buses, "Where messages travel.");
    visitor.Group("vehicle", self.vehicle, "The robot and its sensors.");
    visitor.Group("recording", self.recording, "What clearway-play reads, and how fast.");
    visitor.Group("preprocessor", self.preprocessor, "From raw points to obstacle points.");
    visitor.Group("clusterer", self.clusterer, "From obstacle points to detections.");
    visitor.Group("stop_guard", self.stop_guard, "Whether the robot may move.");
  }
};

}  // namespace clearway::graph
