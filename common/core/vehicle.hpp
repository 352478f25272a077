// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numbers>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "common/core/geometry/pose.hpp"

namespace clearway::core {

/// A corner of the footprint in the vehicle frame. XML element: <vehicle><vertex>.
struct VertexConfig {
  double x_m = 0.0;
  double y_m = 0.0;

  template <typename Self, typename Visitor>
  static void Visit(Self& self, Visitor& visitor) {
    visitor.Number("x_m", self.x_m, -20.0, 20.0, "Forward of the axle [m].");
    visitor.Number("y_m", self.y_m, -20.0, 20.0, "Left of the middle [m].");
  }
};

/// A box with sides along the axes of the vehicle frame; its faces belong to it.
struct BoxConfig {
  double x_min_m = 0.0;
  double x_max_m = 0.0;
  double y_min_m = 0.0;
  double y_max_m = 0.0;
  double z_min_m = 0.0;
  double z_max_m = 0.0;

  [[nodiscard]] bool Contains(const Eigen::Vector3f& p) const {
    return p.x() >= x_min_m && p.x() <= x_max_m && p.y() >= y_min_m && p.y() <= y_max_m &&
           p.z() >= z_min_m && p.z() <= z_max_m;
  }

  template <typename Self, typename Visitor>
  static void Visit(Self& self, Visitor& visitor) {
    visitor.Number("x_min_m", self.x_min_m, -1000.0, 1000.0, "Rear face [m].");
    visitor.Number("x_max_m", self.x_max_m, -1000.0, 1000.0, "Front face [m].");
    visitor.Number("y_min_m", self.y_min_m, -1000.0, 1000.0, "Right face [m].");
    visitor.Number("y_max_m", self.y_max_m, -1000.0, 1000.0, "Left face [m].");
    visitor.Number("z_min_m", self.z_min_m, -1000.0, 1000.0, "Lower face, above the floor [m].");
    visitor.Number("z_max_m", self.z_max_m, -1000.0, 1000.0, "Upper face, above the floor [m].");
  }

  [[nodiscard]] std::vector<std::string> Validate() const {
    std::vector<std::string> broken;
    if (!(x_min_m < x_max_m)) broken.emplace_back("x_min_m must be less than x_max_m");
    if (!(y_min_m < y_max_m)) broken.emplace_back("y_min_m must be less than y_max_m");
    if (!(z_min_m < z_max_m)) broken.emplace_back("z_min_m must be less than z_max_m");
    return broken;
  }
};

/// One sensor and where it is mounted. XML element: <vehicle><sensor>.
struct SensorConfig {
  static constexpr std::size_t kMaxNameLength = 64;  ///< It travels in every slice.

  std::string name = "front";
  double x_m = 0.2;
  double y_m = 0.0;
  double z_m = 0.3;
  double roll_rad = 0.0;
  double pitch_rad = 0.0;
  double yaw_rad = 0.0;
  double field_of_view_rad = 1.2287117934040083;  // 70.4 deg: Livox MID-70.
  double min_range_m = 0.05;
  double max_range_m = 90.0;
  bool required = true;

  /// Takes points of the sensor frame (x along the middle of the field of view, z up when mounted
  /// upright) to the vehicle frame; angles as in FromRpy().
  [[nodiscard]] Eigen::Isometry3d T_vehicle_sensor() const {
    return FromRpy({x_m, y_m, z_m}, {roll_rad, pitch_rad, yaw_rad});
  }

  template <typename Self, typename Visitor>
  static void Visit(Self& self, Visitor& visitor) {
    visitor.Text("name", self.name, "As in the slices of LIDAR_POINTS; each name once.");
    visitor.Number("x_m", self.x_m, -20.0, 20.0, "Origin, forward of the axle [m].");
    visitor.Number("y_m", self.y_m, -20.0, 20.0, "Origin, left of the middle [m].");
    visitor.Number("z_m", self.z_m, -5.0, 20.0, "Origin, above the floor [m].");
    visitor.Degrees("roll_deg", self.roll_rad, -180.0, 180.0, "About x, applied first [deg].");
    visitor.Degrees("pitch_deg",
                    self.pitch_rad,
                    -90.0,
                    90.0,
                    "About y, applied second [deg]. Positive looks down.");
    visitor.Degrees("yaw_deg", self.yaw_rad, -180.0, 180.0, "About z, applied last [deg].");
    visitor.Degrees("field_of_view_deg",
                    self.field_of_view_rad,
                    1.0,
                    360.0,
                    "Horizontal field about the sensor's x axis [deg]; 360 for a spinning sensor. "
                    "Outside all fields the stop guard allows only unseen_speed_mps.");
    visitor.Number("min_range_m",
                   self.min_range_m,
                   0.0,
                   10.0,
                   "Nearer returns are not believed [m]: reflections of the cover.");
    visitor.Number(
        "max_range_m", self.max_range_m, 0.5, 1000.0, "Farther returns are left out [m].");
    visitor.Flag("required",
                 self.required,
                 "While a required sensor is silent the stop guard permits no motion. An optional "
                 "one that is silent only makes its field count as unseen.");
  }

  [[nodiscard]] std::vector<std::string> Validate() const {
    std::vector<std::string> broken;
    if (name.empty() || name.size() > kMaxNameLength) {
      broken.push_back("a sensor needs a name of 1 to " + std::to_string(kMaxNameLength) +
                       " characters");
    }
    if (!(min_range_m < max_range_m)) {
      broken.emplace_back("min_range_m must be less than max_range_m");
    }
    return broken;
  }
};

/// The robot: outline, limits and sensors, shared by all processes. XML element: <vehicle>.
/// Frame `vehicle`: x forward, y left, z up, origin on the floor under the axle.
struct VehicleConfig {
  bool stationary = false;
  std::vector<VertexConfig> footprint = {{-0.2, -0.2}, {0.3, -0.2}, {0.3, 0.2}, {-0.2, 0.2}};
  std::vector<BoxConfig> body;
  std::vector<SensorConfig> sensors = {SensorConfig{}};
  double max_forward_mps = 1.0;
  double max_backward_mps = 0.5;
  double max_turn_radps = 1.5;
  double deceleration_mps2 = 1.0;
  double turn_deceleration_radps2 = 2.0;
  std::int64_t sensing_us = 50'000;
  std::int64_t processing_us = 20'000;
  std::int64_t transport_us = 30'000;
  std::int64_t actuation_us = 100'000;

  /// From the moment that something can be seen to the moment that the brakes act [s]. Source of
  /// the parts: IEC 61496 / ISO 13855 practice, as in scanner manuals.
  [[nodiscard]] double ReactionTime() const {
    return 1e-6 * static_cast<double>(sensing_us + processing_us + transport_us + actuation_us);
  }

  /// Corners, counter-clockwise.
  [[nodiscard]] std::vector<Eigen::Vector2d> Footprint() const {
    std::vector<Eigen::Vector2d> corners;
    corners.reserve(footprint.size());
    for (const VertexConfig& v : footprint) corners.emplace_back(v.x_m, v.y_m);
    return corners;
  }

  /// Index into `sensors`; nothing when no sensor has that name.
  [[nodiscard]] std::optional<int> FindSensor(std::string_view name) const {
    for (std::size_t i = 0; i < sensors.size(); ++i) {
      if (sensors[i].name == name) return static_cast<int>(i);
    }
    return std::nullopt;
  }

  template <typename Self, typename Visitor>
  static void Visit(Self& self, Visitor& visitor) {
    visitor.Flag("stationary",
                 self.stationary,
                 "The sensor stands still: odom is the vehicle frame, nothing is deskewed and no "
                 "ODOMETRY is needed.");
    visitor.Number("max_forward_mps", self.max_forward_mps, 0.0, 20.0, "Top speed [m/s].");
    visitor.Number(
        "max_backward_mps", self.max_backward_mps, 0.0, 20.0, "Top reverse speed [m/s].");
    visitor.Number("max_turn_radps", self.max_turn_radps, 0.0, 20.0, "Top turn rate [rad/s].");
    visitor.Number("deceleration_mps2",
                   self.deceleration_mps2,
                   0.05,
                   20.0,
                   "Deceleration that is guaranteed, loaded and on the worst floor [m/s^2]. Too "
                   "high a value lets the robot hit what it sees.");
    visitor.Number("turn_deceleration_radps2",
                   self.turn_deceleration_radps2,
                   0.05,
                   50.0,
                   "The same for turning on the spot [rad/s^2].");
    visitor.Milliseconds("sensing_ms",
                         self.sensing_us,
                         0.0,
                         2000.0,
                         "Until the sensor's pattern has hit an obstacle often enough [ms].");
    visitor.Milliseconds(
        "processing_ms", self.processing_us, 0.0, 2000.0, "Driver and stop guard [ms].");
    visitor.Milliseconds("transport_ms",
                         self.transport_us,
                         0.0,
                         2000.0,
                         "Messages, and the wait for the next permit [ms].");
    visitor.Milliseconds("actuation_ms",
                         self.actuation_us,
                         0.0,
                         2000.0,
                         "From a permit's arrival at the base to the brakes' action [ms].");
    visitor.List("vertex",
                 self.footprint,
                 "Corner of the footprint, counter-clockwise; convex, 3 or more. Includes all that "
                 "sticks out.");
    visitor.List("body",
                 self.body,
                 "Box around a part of the robot that a sensor sees; returns inside are left out. "
                 "It must not stick out of the footprint, or it would hide obstacles.");
    visitor.List("sensor", self.sensors, "Every LiDAR on the robot.");
  }

  [[nodiscard]] std::vector<std::string> Validate() const {
    std::vector<std::string> broken;
    if (!IsConvexCounterClockwise()) {
      broken.emplace_back(
          "the vertex elements must form a convex polygon of 3 or more corners, counter-clockwise");
    } else {
      for (const BoxConfig& box : body) {
        if (!IsInsideFootprint(box)) broken.emplace_back("a body box sticks out of the footprint");
      }
    }
    if (std::none_of(sensors.begin(), sensors.end(), [](const SensorConfig& sensor) {
          return sensor.required;
        })) {
      broken.emplace_back("at least one sensor with required=\"true\" is needed");
    }
    for (std::size_t i = 0; i < sensors.size(); ++i) {
      if (FindSensor(sensors[i].name) != static_cast<int>(i)) {
        broken.push_back("the sensor name '" + sensors[i].name + "' is used twice");
      }
    }
    return broken;
  }

 private:
  // Every turn goes left, and all turns together go round once.
  [[nodiscard]] bool IsConvexCounterClockwise() const {
    const std::vector<Eigen::Vector2d> corners = Footprint();
    const std::size_t n = corners.size();
    if (n < 3) return false;
    double turned_rad = 0.0;
    for (std::size_t i = 0; i < n; ++i) {
      const Eigen::Vector2d a = corners[(i + 1) % n] - corners[i];
      const Eigen::Vector2d b = corners[(i + 2) % n] - corners[(i + 1) % n];
      const double cross = a.x() * b.y() - a.y() * b.x();
      if (!(cross > 0.0)) return false;
      turned_rad += std::atan2(cross, a.dot(b));
    }
    return turned_rad < 3.0 * std::numbers::pi;
  }

  [[nodiscard]] bool IsInsideFootprint(const BoxConfig& box) const {
    constexpr double kSlack_m = 1e-6;
    const std::vector<Eigen::Vector2d> corners = Footprint();
    for (std::size_t i = 0; i < corners.size(); ++i) {
      const Eigen::Vector2d edge = corners[(i + 1) % corners.size()] - corners[i];
      const Eigen::Vector2d inwards = Eigen::Vector2d(-edge.y(), edge.x()).normalized();
      for (const double x : {box.x_min_m, box.x_max_m}) {
        for (const double y : {box.y_min_m, box.y_max_m}) {
          if (inwards.dot(Eigen::Vector2d(x, y) - corners[i]) < -kSlack_m) return false;
        }
      }
    }
    return true;
  }
};

}  // namespace clearway::core
