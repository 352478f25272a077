// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

namespace clearway::core {

/// How a surface throws light back.
enum class Material : std::int8_t {
  kDiffuse,  ///< Into all directions.
  kGlass,    ///< Lets the light through, but for a glint where it is met head-on.
  kGlossy    ///< Like a mirror: what it shows seems to lie behind it, or below the floor.
};
inline constexpr std::array<std::pair<const char*, Material>, 3> kMaterialNames{
    {{"diffuse", Material::kDiffuse}, {"glass", Material::kGlass}, {"glossy", Material::kGlossy}}};
inline constexpr char kMaterialHelp[] =
    "\"diffuse\"; \"glass\": shots pass through it, but for a glint head-on; \"glossy\": a "
    "mirror, whose images seem to lie behind it. Black is diffuse with a small reflectivity.";

/// A place that a moving object goes to. XML element: <waypoint> in any object of a scene.
struct SceneWaypoint {
  double x_m = 0.0;
  double y_m = 0.0;
  double pause_s = 0.0;

  template <typename Self, typename Visitor>
  static void Visit(Self& self, Visitor& visitor) {
    visitor.Number("x_m", self.x_m, -1000.0, 1000.0, "Where it goes, x in the map frame [m].");
    visitor.Number("y_m", self.y_m, -1000.0, 1000.0, "Where it goes, y in the map frame [m].");
    visitor.Number(
        "pause_s", self.pause_s, 0.0, 86400.0, "How long it stands here before it goes on [s].");
  }
};

/// What all objects of a scene have in common: place, time and motion. Its fields are attributes
/// of the object's own element.
struct SceneObject {
  std::string name = {};
  double x_m = 0.0;
  double y_m = 0.0;
  double z_m = 0.0;
  double yaw_rad = 0.0;
  double reflectivity = 0.5;
  Material material = Material::kDiffuse;
  bool on_map = false;
  double appear_s = -1.0;
  double vanish_s = -1.0;
  double start_s = 0.0;
  double speed_mps = 0.0;
  bool loop = false;
  std::vector<SceneWaypoint> waypoints = {};

  template <typename Self, typename Visitor>
  static void Visit(Self& self, Visitor& visitor) {
    VisitPlace(self, visitor);
    VisitTime(self, visitor);
  }

  /// One sentence a broken rule; `kind` is the name of the XML element.
  [[nodiscard]] std::vector<std::string> Validate(const std::string& kind) const;

 private:
  template <typename Self, typename Visitor>
  static void VisitPlace(Self& self, Visitor& visitor) {
    visitor.Text("name", self.name, "Unique name; ground truth and reports use it.");
    visitor.Number("x_m", self.x_m, -1000.0, 1000.0, "Centre at the start, map frame [m].");
    visitor.Number("y_m", self.y_m, -1000.0, 1000.0, "Centre at the start, map frame [m].");
    visitor.Number("z_m",
                   self.z_m,
                   -10.0,
                   100.0,
                   "Underside above the floor [m]. More than 0 hangs in the air.");
    visitor.Degrees("yaw_deg",
                    self.yaw_rad,
                    -360.0,
                    360.0,
                    "Direction of the length from the map's x axis, counter-clockwise [deg]. An "
                    "object under way faces the way it goes instead.");
    visitor.Number("reflectivity",
                   self.reflectivity,
                   0.0,
                   1.0,
                   "Share of the laser's light that it throws back. 0 swallows every shot; below "
                   "0.1 its far and slanted faces return nothing.");
    visitor.Choice("material", self.material, kMaterialNames, kMaterialHelp);
    visitor.Flag("on_map", self.on_map, "Whether the robot's map shows it.");
  }

  template <typename Self, typename Visitor>
  static void VisitTime(Self& self, Visitor& visitor) {
    visitor.Number("appear_s",
                   self.appear_s,
                   -1.0,
                   86400.0,
                   "When it comes into being, after the scene's start [s]; -1: it is there from "
                   "the start.");
    visitor.Number("vanish_s",
                   self.vanish_s,
                   -1.0,
                   86400.0,
                   "When it is gone, after the scene's start [s]; -1: never.");
    visitor.Number("start_s",
                   self.start_s,
                   0.0,
                   86400.0,
                   "When it starts to move, after the scene's start [s].");
    visitor.Number("speed_mps",
                   self.speed_mps,
                   0.0,
                   20.0,
                   "Speed on the way from waypoint to waypoint [m/s]; 0: it stands.");
    visitor.Flag(
        "loop", self.loop, "After the last waypoint it goes back to its start and begins again.");
    visitor.List("waypoint", self.waypoints, "Where it goes, in this order, straight.");
  }
};

/// An object's place and motion at one moment, in the map frame.
struct SceneMotion {
  double x_m = 0.0;
  double y_m = 0.0;
  double yaw_rad = 0.0;
  double vx_mps = 0.0;
  double vy_mps = 0.0;
  double distance_m = 0.0;  ///< Gone so far.
};

/// True from appear_s on until vanish_s.
[[nodiscard]] bool IsPresent(const SceneObject& object, double time_s);

/// Place and velocity `time_s` after the scene's start: a closed form, so that any moment can be
/// asked for in any order. Turns at waypoints are instantaneous. O(waypoints).
[[nodiscard]] SceneMotion MotionAt(const SceneObject& object, double time_s);

}  // namespace clearway::core
