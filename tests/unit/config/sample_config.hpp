// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdint>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

/// A small configuration with every kind of entry.
namespace clearway::config::sample {

enum class Backend { kNative, kTextbook };

inline constexpr std::array<std::pair<const char*, Backend>, 2> kBackendNames = {
    {{"native", Backend::kNative}, {"textbook", Backend::kTextbook}}};

struct VoxelGrid {
  double leaf_m = 0.05;
  int min_points = 1;

  bool operator==(const VoxelGrid&) const = default;

  template <typename Self, typename Visitor>
  static void Visit(Self& self, Visitor& visitor) {
    visitor.Number("leaf_m", self.leaf_m, 0.005, 2.0, "Side of a cubic cell [m].");
    visitor.Integer("min_points", self.min_points, 1, 100, "Least points -- a cell | voxel.");
  }
};

struct Floor {
  double tilt_rad = 15.0 * std::numbers::pi / 180.0;
  double lo_m = -0.1;
  double hi_m = 0.1;

  bool operator==(const Floor&) const = default;

  template <typename Self, typename Visitor>
  static void Visit(Self& self, Visitor& visitor) {
    visitor.Degrees("tilt_deg", self.tilt_rad, 0.0, 45.0, "Steepest floor.");
    visitor.Number("lo_m", self.lo_m, -1.0, 1.0, "Lower edge of the band.");
    visitor.Number("hi_m", self.hi_m, -1.0, 1.0, "Upper edge of the band.");
  }

  [[nodiscard]] std::vector<std::string> Validate() const {
    if (lo_m < hi_m) return {};
    return {"lo_m must be below hi_m"};
  }
};

struct Preprocessor {
  Backend backend = Backend::kNative;
  VoxelGrid voxel_grid;
  bool deskew = true;
  std::int64_t window_us = 100'000;
  Floor floor;

  bool operator==(const Preprocessor&) const = default;

  template <typename Self, typename Visitor>
  static void Visit(Self& self, Visitor& visitor) {
    visitor.Choice("backend", self.backend, kBackendNames, "Which implementation runs.");
    visitor.Group("voxel_grid", self.voxel_grid, "Thinning of the cloud.");
    visitor.Flag("deskew", self.deskew, "Undo the robot's motion.");
    visitor.Milliseconds("window_ms", self.window_us, 1.0, 1000.0, "Time of a scan.");
    visitor.Group("floor", self.floor, "Search for the floor.");
  }
};

struct Sensor {
  std::string name = "front";
  double x_m = 0.0;
  double yaw_rad = 0.0;

  bool operator==(const Sensor&) const = default;

  template <typename Self, typename Visitor>
  static void Visit(Self& self, Visitor& visitor) {
    visitor.Text("name", self.name, "Name in messages.");
    visitor.Number("x_m", self.x_m, -10.0, 10.0, "Position before the axle.");
    visitor.Degrees("yaw_deg", self.yaw_rad, -180.0, 180.0, "Turn about z.");
  }
};

struct Root {
  double speed_mps = 1.5;
  Preprocessor preprocessor;
  std::vector<Sensor> sensors = {Sensor{}};

  bool operator==(const Root&) const = default;

  template <typename Self, typename Visitor>
  static void Visit(Self& self, Visitor& visitor) {
    visitor.Number("speed_mps", self.speed_mps, 0.0, 5.0, "Highest speed.");
    visitor.Group("preprocessor", self.preprocessor, "From slices to scans.");
    visitor.List("sensor", self.sensors, "One lidar.");
  }

  [[nodiscard]] std::vector<std::string> Validate() const {
    std::vector<std::string> broken;
    for (std::size_t i = 1; i < sensors.size(); ++i) {
      if (sensors[i].name == sensors[i - 1].name)
        broken.push_back("two neighbouring sensors have the name " + sensors[i].name);
    }
    return broken;
  }
};

}  // namespace clearway::config::sample
