// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <span>
#include <string>

#include "common/config/config.hpp"
#include "common/core/geometry/pose_source.hpp"
#include "common/core/guard/stop_guard_config.hpp"
#include "common/core/livox/driver_config.hpp"
#include "common/core/perception/clustering/clusterer.hpp"
#include "common/core/preprocessing/preprocessor.hpp"
#include "common/core/simulation/simulator_config.hpp"
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

/// Settings of the map server. XML element: <map_server>.
struct MapServerConfig {
  std::string file;

  template <typename Self, typename Visitor>
  static void Visit(Self& self, Visitor& visitor) {
    visitor.Text("file",
                 self.file,
                 "The YAML file of a Nav2 map; a relative path starts at this configuration's "
                 "folder. Empty: no map is served.");
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
  MapServerConfig map_server;
  core::PoseSourceConfig pose_source;
  core::livox::DriverConfig livox_driver;
  core::SimulatorConfig simulator;

  /// Where relative paths of the configuration start: the folder of its file. Not a value of it.
  std::filesystem::path folder;

  /// The map that is to be served; empty when none is.
  [[nodiscard]] std::filesystem::path MapFile() const {
    return map_server.file.empty() ? std::filesystem::path() : folder / map_server.file;
  }

  template <typename Self, typename Visitor>
  static void Visit(Self& self, Visitor& visitor) {
    visitor.Group("buses", self.buses, "Where messages travel.");
    visitor.Group("vehicle", self.vehicle, "The robot and its sensors.");
    visitor.Group("recording", self.recording, "What clearway-play reads, and how fast.");
    visitor.Group("preprocessor", self.preprocessor, "From raw points to obstacle points.");
    visitor.Group("clusterer", self.clusterer, "From obstacle points to detections.");
    visitor.Group("stop_guard", self.stop_guard, "Whether the robot may move.");
    visitor.Group("map_server", self.map_server, "Which map is known.");
    visitor.Group("pose_source", self.pose_source, "POSE without a localization.");
    visitor.Group("livox_driver", self.livox_driver, "Livox sensors on the network.");
    visitor.Group("simulator", self.simulator, "A lab, a robot and sensors that are not there.");
  }
};

}  // namespace clearway::graph

// What is long to compile is compiled once, in graph_config.cpp.
namespace clearway::config {
extern template LoadResult<graph::GraphConfig> Parse(const std::string& text,
                                                     const std::string& file,
                                                     std::span<const std::string> overrides);
extern template LoadResult<graph::GraphConfig> Load(const std::filesystem::path& file,
                                                    std::span<const std::string> overrides);
extern template std::string Print(const LoadResult<graph::GraphConfig>& result);
extern template std::string ToXml(const graph::GraphConfig& root, const XmlOptions& options);
extern template std::string Digest(const graph::GraphConfig& root);
extern template std::string Reference(const graph::GraphConfig& root);
}  // namespace clearway::config
