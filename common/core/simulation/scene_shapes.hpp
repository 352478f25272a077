// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "common/core/simulation/scene_object.hpp"

namespace clearway::core {

/// A cuboid. XML element: <box>.
struct SceneBox {
  SceneObject object;
  double length_m = 0.3;
  double width_m = 0.3;
  double height_m = 0.3;

  template <typename Self, typename Visitor>
  static void Visit(Self& self, Visitor& visitor) {
    SceneObject::Visit(self.object, visitor);
    visitor.Number("length_m", self.length_m, 0.001, 1000.0, "Extent along yaw [m].");
    visitor.Number("width_m", self.width_m, 0.001, 1000.0, "Extent across yaw [m].");
    visitor.Number("height_m", self.height_m, 0.001, 100.0, "Extent upwards from z_m [m].");
  }
  [[nodiscard]] std::vector<std::string> Validate() const { return object.Validate("box"); }
};

/// An upright cylinder: a post, a bin, a leg of 7 cm. XML element: <cylinder>.
struct SceneCylinder {
  SceneObject object;
  double radius_m = 0.1;
  double height_m = 1.0;

  template <typename Self, typename Visitor>
  static void Visit(Self& self, Visitor& visitor) {
    SceneObject::Visit(self.object, visitor);
    visitor.Number("radius_m", self.radius_m, 0.001, 100.0, "Radius [m].");
    visitor.Number("height_m", self.height_m, 0.001, 100.0, "Extent upwards from z_m [m].");
  }
  [[nodiscard]] std::vector<std::string> Validate() const { return object.Validate("cylinder"); }
};

/// Four posts with boards between them, open to all sides. XML element: <shelf>.
struct SceneShelf {
  SceneObject object;
  double length_m = 1.0;
  double width_m = 0.4;
  double height_m = 1.8;
  int num_boards = 4;
  double board_thickness_m = 0.03;
  double lowest_board_m = 0.1;
  double post_width_m = 0.04;

  template <typename Self, typename Visitor>
  static void Visit(Self& self, Visitor& visitor) {
    SceneObject::Visit(self.object, visitor);
    visitor.Number("length_m", self.length_m, 0.1, 100.0, "Extent along yaw [m].");
    visitor.Number("width_m", self.width_m, 0.05, 10.0, "Depth, across yaw [m].");
    visitor.Number("height_m", self.height_m, 0.1, 20.0, "Top of the highest board [m].");
    visitor.Integer("num_boards", self.num_boards, 1, 50, "Boards, evenly spaced.");
    visitor.Number("board_thickness_m", self.board_thickness_m, 0.002, 0.5, "Of a board [m].");
    visitor.Number("lowest_board_m",
                   self.lowest_board_m,
                   0.0,
                   20.0,
                   "Underside of the lowest board above z_m [m].");
    visitor.Number("post_width_m", self.post_width_m, 0.005, 0.5, "Of a square post [m].");
  }
  [[nodiscard]] std::vector<std::string> Validate() const;
};

/// A table whose top hangs over its legs. XML element: <table>.
struct SceneTable {
  SceneObject object;
  double length_m = 1.2;
  double width_m = 0.8;
  double height_m = 0.74;
  double top_thickness_m = 0.03;
  double overhang_m = 0.1;
  double leg_diameter_m = 0.07;

  template <typename Self, typename Visitor>
  static void Visit(Self& self, Visitor& visitor) {
    SceneObject::Visit(self.object, visitor);
    visitor.Number("length_m", self.length_m, 0.1, 100.0, "Of the top, along yaw [m].");
    visitor.Number("width_m", self.width_m, 0.1, 100.0, "Of the top, across yaw [m].");
    visitor.Number("height_m", self.height_m, 0.05, 10.0, "Upper side of the top [m].");
    visitor.Number("top_thickness_m", self.top_thickness_m, 0.002, 1.0, "Of the top [m].");
    visitor.Number("overhang_m",
                   self.overhang_m,
                   0.0,
                   10.0,
                   "From the edge of the top inwards to the outside of a leg [m].");
    visitor.Number("leg_diameter_m", self.leg_diameter_m, 0.005, 1.0, "Of a round leg [m].");
  }
  [[nodiscard]] std::vector<std::string> Validate() const;
};

/// A straight cable, lying on its underside. XML element: <cable>.
struct SceneCable {
  SceneObject object;
  double length_m = 1.0;
  double diameter_m = 0.01;

  template <typename Self, typename Visitor>
  static void Visit(Self& self, Visitor& visitor) {
    SceneObject::Visit(self.object, visitor);
    visitor.Number("length_m", self.length_m, 0.01, 100.0, "Extent along yaw [m].");
    visitor.Number("diameter_m", self.diameter_m, 0.001, 1.0, "Thickness [m].");
  }
  [[nodiscard]] std::vector<std::string> Validate() const { return object.Validate("cable"); }
};

/// A wedge that rises along yaw from z_m to z_m + height. XML element: <ramp>.
struct SceneRamp {
  SceneObject object;
  double length_m = 1.0;
  double width_m = 1.0;
  double height_m = 0.1;

  template <typename Self, typename Visitor>
  static void Visit(Self& self, Visitor& visitor) {
    SceneObject::Visit(self.object, visitor);
    visitor.Number("length_m", self.length_m, 0.01, 100.0, "Extent along yaw, level [m].");
    visitor.Number("width_m", self.width_m, 0.01, 100.0, "Extent across yaw [m].");
    visitor.Number("height_m", self.height_m, 0.001, 20.0, "Rise over the whole length [m].");
  }
  [[nodiscard]] std::vector<std::string> Validate() const { return object.Validate("ramp"); }
};

/// A pit in the floor with upright walls: a hole, a step down. XML element: <hole>.
struct SceneHole {
  SceneObject object;
  double length_m = 0.5;
  double width_m = 0.5;
  double depth_m = 0.3;

  template <typename Self, typename Visitor>
  static void Visit(Self& self, Visitor& visitor) {
    SceneObject::Visit(self.object, visitor);
    visitor.Number("length_m", self.length_m, 0.01, 1000.0, "Extent along yaw [m].");
    visitor.Number("width_m", self.width_m, 0.01, 1000.0, "Extent across yaw [m].");
    visitor.Number("depth_m", self.depth_m, 0.001, 100.0, "Bottom below the floor [m].");
  }
  [[nodiscard]] std::vector<std::string> Validate() const;
};

/// A person: two legs that swing while walking, a trunk and a head, all within a cylinder.
/// XML element: <person>.
struct ScenePerson {
  SceneObject object;
  double radius_m = 0.25;
  double height_m = 1.75;

  template <typename Self, typename Visitor>
  static void Visit(Self& self, Visitor& visitor) {
    SceneObject::Visit(self.object, visitor);
    visitor.Number("radius_m", self.radius_m, 0.1, 1.0, "Of the trunk [m].");
    visitor.Number("height_m", self.height_m, 0.5, 2.5, "Top of the head above z_m [m].");
  }
  [[nodiscard]] std::vector<std::string> Validate() const { return object.Validate("person"); }
};

/// An upright wall between two points of the floor. XML element: <wall>.
struct SceneWall {
  std::string name = {};
  double x1_m = 0.0;
  double y1_m = 0.0;
  double x2_m = 1.0;
  double y2_m = 0.0;
  double thickness_m = 0.1;
  double height_m = 2.5;
  double reflectivity = 0.6;
  Material material = Material::kDiffuse;
  bool on_map = true;

  template <typename Self, typename Visitor>
  static void Visit(Self& self, Visitor& visitor) {
    visitor.Text("name", self.name, "Unique name.");
    visitor.Number("x1_m", self.x1_m, -1000.0, 1000.0, "One end, map frame [m].");
    visitor.Number("y1_m", self.y1_m, -1000.0, 1000.0, "One end, map frame [m].");
    visitor.Number("x2_m", self.x2_m, -1000.0, 1000.0, "Other end, map frame [m].");
    visitor.Number("y2_m", self.y2_m, -1000.0, 1000.0, "Other end, map frame [m].");
    visitor.Number("thickness_m",
                   self.thickness_m,
                   0.001,
                   10.0,
                   "Half of it lies on either side of the line between the ends [m].");
    visitor.Number("height_m", self.height_m, 0.01, 100.0, "Height above the floor [m].");
    visitor.Number("reflectivity", self.reflectivity, 0.0, 1.0, "Share of light thrown back.");
    visitor.Choice("material", self.material, kMaterialNames, kMaterialHelp);
    visitor.Flag("on_map", self.on_map, "Whether the robot's map shows it.");
  }
  [[nodiscard]] std::vector<std::string> Validate() const;
};

/// A rectangular room seen from within: four walls and a ceiling. XML element: <room>.
struct SceneRoom {
  std::string name = {};
  double x_min_m = 0.0;
  double x_max_m = 8.0;
  double y_min_m = 0.0;
  double y_max_m = 6.0;
  double height_m = 2.5;
  bool ceiling = true;
  double reflectivity = 0.6;
  Material material = Material::kDiffuse;
  bool on_map = true;

  template <typename Self, typename Visitor>
  static void Visit(Self& self, Visitor& visitor) {
    visitor.Text("name", self.name, "Unique name.");
    visitor.Number("x_min_m", self.x_min_m, -1000.0, 1000.0, "Inner side, map frame [m].");
    visitor.Number("x_max_m", self.x_max_m, -1000.0, 1000.0, "Inner side, map frame [m].");
    visitor.Number("y_min_m", self.y_min_m, -1000.0, 1000.0, "Inner side, map frame [m].");
    visitor.Number("y_max_m", self.y_max_m, -1000.0, 1000.0, "Inner side, map frame [m].");
    visitor.Number("height_m", self.height_m, 0.1, 100.0, "From floor to ceiling [m].");
    visitor.Flag("ceiling", self.ceiling, "Whether it has one; without, the walls end there.");
    visitor.Number("reflectivity", self.reflectivity, 0.0, 1.0, "Of walls and ceiling.");
    visitor.Choice("material", self.material, kMaterialNames, kMaterialHelp);
    visitor.Flag("on_map", self.on_map, "Whether the robot's map shows its walls.");
  }
  [[nodiscard]] std::vector<std::string> Validate() const;
};

/// A cloud of dust: an upright cylinder in which shots return from nothing, tagged as noise.
/// XML element: <dust>.
struct SceneDust {
  double x_m = 0.0;
  double y_m = 0.0;
  double radius_m = 1.0;
  double height_m = 2.0;
  double density_per_m = 0.05;
  double from_s = 0.0;
  double to_s = -1.0;

  template <typename Self, typename Visitor>
  static void Visit(Self& self, Visitor& visitor) {
    visitor.Number("x_m", self.x_m, -1000.0, 1000.0, "Middle, map frame [m].");
    visitor.Number("y_m", self.y_m, -1000.0, 1000.0, "Middle, map frame [m].");
    visitor.Number("radius_m", self.radius_m, 0.01, 1000.0, "Radius [m].");
    visitor.Number("height_m", self.height_m, 0.01, 100.0, "From the floor up [m].");
    visitor.Number("density_per_m",
                   self.density_per_m,
                   0.0,
                   100.0,
                   "Returns that a shot would meet on each metre of its way through it [1/m].");
    visitor.Number("from_s", self.from_s, 0.0, 86400.0, "When it rises, after the start [s].");
    visitor.Number("to_s", self.to_s, -1.0, 86400.0, "When it has settled [s]; -1: never.");
  }
};

}  // namespace clearway::core
