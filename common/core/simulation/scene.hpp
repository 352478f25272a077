// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include <Eigen/Geometry>

#include "common/core/simulation/scene_shapes.hpp"

namespace clearway::core {

/// The level floor, z = 0 of the map frame. XML element: <floor> in a scene.
struct SceneFloor {
  bool present = true;
  double reflectivity = 0.3;
  Material material = Material::kDiffuse;

  template <typename Self, typename Visitor>
  static void Visit(Self& self, Visitor& visitor) {
    visitor.Flag("present", self.present, "Without a floor, shots below the horizon are lost.");
    visitor.Number("reflectivity", self.reflectivity, 0.0, 1.0, "Share of light thrown back.");
    visitor.Choice("material", self.material, kMaterialNames, kMaterialHelp);
  }
};

/// Where the vehicle stands when the scene starts, in the map frame. XML element: <start>.
struct SceneStart {
  double x_m = 0.0;
  double y_m = 0.0;
  double yaw_rad = 0.0;

  [[nodiscard]] Eigen::Isometry3d T_map_vehicle() const {
    return Eigen::Translation3d(x_m, y_m, 0.0) *
           Eigen::AngleAxisd(yaw_rad, Eigen::Vector3d::UnitZ());
  }

  template <typename Self, typename Visitor>
  static void Visit(Self& self, Visitor& visitor) {
    visitor.Number("x_m", self.x_m, -1000.0, 1000.0, "Position of the vehicle's origin [m].");
    visitor.Number("y_m", self.y_m, -1000.0, 1000.0, "Position of the vehicle's origin [m].");
    visitor.Degrees("yaw_deg", self.yaw_rad, -180.0, 180.0, "Heading, from map's x axis [deg].");
  }
};

/// A small world: what stands, moves, appears and vanishes in it, in the map frame (x, y level,
/// z up, floor at z = 0). XML element: <scene>.
/// Objects are numbered in the order of the lists below, floor and misses apart; see
/// DescribeObjects() in scene_geometry.hpp.
struct SceneConfig {
  SceneStart start;
  SceneFloor floor;
  std::vector<SceneRoom> rooms;
  std::vector<SceneWall> walls;
  std::vector<SceneBox> boxes;
  std::vector<SceneCylinder> cylinders;
  std::vector<SceneShelf> shelves;
  std::vector<SceneTable> tables;
  std::vector<SceneCable> cables;
  std::vector<SceneRamp> ramps;
  std::vector<SceneHole> holes;
  std::vector<ScenePerson> persons;
  std::vector<SceneDust> dust;

  template <typename Self, typename Visitor>
  static void Visit(Self& self, Visitor& visitor) {
    visitor.Group("start", self.start, "Where the vehicle starts.");
    visitor.Group("floor", self.floor, "The floor.");
    visitor.List("room", self.rooms, "Rectangular rooms.");
    visitor.List("wall", self.walls, "Single walls.");
    visitor.List("box", self.boxes, "Cuboids.");
    visitor.List("cylinder", self.cylinders, "Upright cylinders.");
    visitor.List("shelf", self.shelves, "Shelves with boards.");
    visitor.List("table", self.tables, "Tables.");
    visitor.List("cable", self.cables, "Cables on the floor.");
    visitor.List("ramp", self.ramps, "Wedges.");
    visitor.List("hole", self.holes, "Pits in the floor.");
    visitor.List("person", self.persons, "People.");
    visitor.List("dust", self.dust, "Clouds of dust.");
  }

  /// Rules that concern the scene as a whole: names are there and unique. The rules of a single
  /// element are that element's own.
  [[nodiscard]] std::vector<std::string> Validate() const;
};

/// A scene file: <clearway version="1"> with one <scene>.
struct SceneFile {
  SceneConfig scene;

  template <typename Self, typename Visitor>
  static void Visit(Self& self, Visitor& visitor) {
    visitor.Group("scene", self.scene, "The world that is simulated.");
  }
};

}  // namespace clearway::core
