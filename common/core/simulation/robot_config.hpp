// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "common/core/guard/base_gate.hpp"
#include "common/core/simulation/injected_errors.hpp"

namespace clearway::core {

/// What the simulated robot does.
enum class DriveMode : std::int8_t {
  kStill,     ///< It stands.
  kStraight,  ///< Ahead at speed_mps, for ever.
  kPath,      ///< From waypoint to waypoint.
  kRequest,   ///< As DRIVE_REQUEST says.
  kCommand,   ///< As DRIVE_COMMAND says.
};
inline constexpr std::array<std::pair<const char*, DriveMode>, 5> kDriveModeNames{
    {{"still", DriveMode::kStill},
     {"straight", DriveMode::kStraight},
     {"path", DriveMode::kPath},
     {"request", DriveMode::kRequest},
     {"command", DriveMode::kCommand}}};

/// A place that the robot drives to. XML element: <simulator><robot><waypoint>.
struct RobotWaypoint {
  double x_m = 0.0;
  double y_m = 0.0;

  template <typename Self, typename Visitor>
  static void Visit(Self& self, Visitor& visitor) {
    visitor.Number("x_m", self.x_m, -1000.0, 1000.0, "In map [m].");
    visitor.Number("y_m", self.y_m, -1000.0, 1000.0, "In map [m].");
  }
};

/// The simulated robot: a differential drive. Its outline, limits and sensors are those of
/// <vehicle>. XML element: <simulator><robot>.
struct RobotConfig {
  DriveMode drive = DriveMode::kStill;
  double speed_mps = 0.5;
  double start_s = 0.0;
  double lookahead_m = 0.4;
  bool loop = false;
  bool obey_permit = true;
  double acceleration_mps2 = 0.8;
  double turn_acceleration_radps2 = 3.0;
  double braking_share = 1.0;
  double delay_share = 1.0;
  double wheel_track_m = 0.4;
  double dive_rad_per_mps2 = 0.0087266462599716477;  // 0.5 deg
  std::int64_t dive_lag_us = 100'000;
  double height_m = 0.6;
  double clearance_m = 0.03;
  bool publish_pose = true;
  double pose_rate_hz = 20.0;
  double pose_sigma_m = 0.02;
  double pose_sigma_rad = 0.0087266462599716477;  // 0.5 deg
  BaseGateConfig gate;
  std::vector<RobotWaypoint> waypoints;
  std::vector<WheelSlipConfig> wheel_slips;
  std::vector<OdometryErrorConfig> odometry_errors;
  std::vector<PoseErrorConfig> pose_errors;

  template <typename Self, typename Visitor>
  static void Visit(Self& self, Visitor& visitor) {
    VisitDrive(self, visitor);
    VisitBody(self, visitor);
    VisitPose(self, visitor);
    visitor.Group("gate", self.gate, "How the base judges permits and commands.");
    visitor.List("waypoint", self.waypoints, "Where drive=\"path\" goes, in this order.");
    visitor.List("wheel_slip", self.wheel_slips, "Wheels that lose their grip.");
    visitor.List("odometry_error", self.odometry_errors, "What is wrong with ODOMETRY.");
    visitor.List("pose_error", self.pose_errors, "What is wrong with POSE.");
  }

  [[nodiscard]] std::vector<std::string> Validate() const {
    std::vector<std::string> broken;
    if (drive == DriveMode::kPath && waypoints.empty()) {
      broken.emplace_back("drive=\"path\" needs a waypoint");
    }
    if (loop && waypoints.size() == 1) {
      broken.emplace_back("loop=\"true\" needs two waypoints or more");
    }
    for (std::size_t i = 1; i < waypoints.size(); ++i) {
      if (waypoints[i].x_m == waypoints[i - 1].x_m && waypoints[i].y_m == waypoints[i - 1].y_m) {
        broken.push_back("waypoint " + std::to_string(i + 1) + " stands where the one before does");
      }
    }
    return broken;
  }

 private:
  template <typename Self, typename Visitor>
  static void VisitDrive(Self& self, Visitor& visitor) {
    visitor.Choice("drive",
                   self.drive,
                   kDriveModeNames,
                   "\"still\": it stands. \"straight\": ahead at speed_mps. \"path\": along the "
                   "waypoint elements. \"request\", \"command\": as DRIVE_REQUEST or DRIVE_COMMAND "
                   "says.");
    visitor.Number(
        "speed_mps", self.speed_mps, 0.0, 20.0, "Wish when straight or on a path [m/s].");
    visitor.Number("start_s", self.start_s, 0.0, 86400.0, "When it sets off, likewise [s].");
    visitor.Number("lookahead_m",
                   self.lookahead_m,
                   0.05,
                   10.0,
                   "On a path it steers for the point so far ahead [m]. More is smoother and cuts "
                   "corners.");
    visitor.Flag("loop", self.loop, "After the last waypoint the first follows.");
    visitor.Flag("obey_permit",
                 self.obey_permit,
                 "As a base must. Without, it drives into whatever is in its way.");
  }

  template <typename Self, typename Visitor>
  static void VisitBody(Self& self, Visitor& visitor) {
    visitor.Number(
        "acceleration_mps2", self.acceleration_mps2, 0.01, 20.0, "Of the drives [m/s^2].");
    visitor.Number("turn_acceleration_radps2",
                   self.turn_acceleration_radps2,
                   0.01,
                   50.0,
                   "Of the drives [rad/s^2].");
    visitor.Number("braking_share",
                   self.braking_share,
                   0.05,
                   10.0,
                   "Real deceleration over that which <vehicle> promises; below 1 it breaks the "
                   "promise.");
    visitor.Number("delay_share",
                   self.delay_share,
                   0.0,
                   10.0,
                   "Real delay of the actuation over vehicle.actuation_ms; above 1 it breaks the "
                   "promise.");
    visitor.Number("wheel_track_m", self.wheel_track_m, 0.02, 10.0, "Between the two wheels [m].");
    visitor.Degrees(
        "dive_deg_per_mps2",
        self.dive_rad_per_mps2,
        0.0,
        20.0,
        "The body pitches forward by this for each m/s^2 of deceleration, and back when "
        "accelerating, about the vehicle's origin; sensors go along [deg].");
    visitor.Milliseconds("dive_lag_ms",
                         self.dive_lag_us,
                         1.0,
                         10000.0,
                         "Time constant of the pitch (first order) [ms].");
    visitor.Number("height_m",
                   self.height_m,
                   0.01,
                   10.0,
                   "Of the body, above its footprint [m]; what hangs higher is not touched.");
    visitor.Number("clearance_m",
                   self.clearance_m,
                   0.0,
                   1.0,
                   "What is not higher, or not deeper as a hole, is driven over [m].");
  }

  template <typename Self, typename Visitor>
  static void VisitPose(Self& self, Visitor& visitor) {
    visitor.Flag("publish_pose",
                 self.publish_pose,
                 "POSE and POSE_STATUS, as a localization would; off where pose_source or another "
                 "publishes them.");
    visitor.Number("pose_rate_hz", self.pose_rate_hz, 1.0, 200.0, "Of POSE [1/s].");
    visitor.Number("pose_sigma_m",
                   self.pose_sigma_m,
                   0.0,
                   10.0,
                   "Standard deviation of x and y that POSE_STATUS tells, whatever is true [m].");
    visitor.Degrees("pose_sigma_deg", self.pose_sigma_rad, 0.0, 180.0, "That of the yaw [deg].");
  }
};

}  // namespace clearway::core
