// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <utility>

#include <Eigen/Geometry>

#include "common/core/geometry/pose.hpp"

namespace clearway::core {

/// Where POSE comes from when there is no localization.
enum class PoseSourceMode : std::int8_t {
  kOff,            ///< Somebody else publishes POSE, or nobody.
  kFixed,          ///< The vehicle stands where the configuration says.
  kDeadReckoning,  ///< Start pose and ODOMETRY; drifts.
};
inline constexpr std::array<std::pair<const char*, PoseSourceMode>, 3> kPoseSourceModeNames{
    {{"off", PoseSourceMode::kOff},
     {"fixed", PoseSourceMode::kFixed},
     {"dead_reckoning", PoseSourceMode::kDeadReckoning}}};

/// Settings of the pose source. XML element: <pose_source>.
struct PoseSourceConfig {
  PoseSourceMode mode = PoseSourceMode::kOff;
  double x_m = 0.0;
  double y_m = 0.0;
  double yaw_rad = 0.0;
  double position_sigma_m = 0.02;
  double yaw_sigma_rad = 0.0087266462599716477;  // 0.5 deg
  double position_drift = 0.02;
  double yaw_drift_rad_per_m = 0.017453292519943295;  // 1 deg/m

  /// T_map_vehicle as configured.
  [[nodiscard]] Eigen::Isometry3d Start() const {
    return FromRpy({x_m, y_m, 0.0}, {0.0, 0.0, yaw_rad});
  }

  template <typename Self, typename Visitor>
  static void Visit(Self& self, Visitor& visitor) {
    visitor.Choice("mode",
                   self.mode,
                   kPoseSourceModeNames,
                   "\"fixed\": the vehicle stands at x_m, y_m, yaw_deg. \"dead_reckoning\": it "
                   "starts there and ODOMETRY moves it. \"off\": a localization publishes POSE.");
    visitor.Number("x_m", self.x_m, -1e6, 1e6, "Start, in map [m].");
    visitor.Number("y_m", self.y_m, -1e6, 1e6, "Start, in map [m].");
    visitor.Degrees("yaw_deg", self.yaw_rad, -180.0, 180.0, "Start, about z of map [deg].");
    visitor.Number("position_sigma_m",
                   self.position_sigma_m,
                   0.0,
                   10.0,
                   "Standard deviation of the start's x and y, as POSE_STATUS tells [m].");
    visitor.Degrees("yaw_sigma_deg",
                    self.yaw_sigma_rad,
                    0.0,
                    180.0,
                    "Standard deviation of the start's yaw [deg].");
    visitor.Number("position_drift",
                   self.position_drift,
                   0.0,
                   1.0,
                   "Dead reckoning: standard deviation of the position grows by this share of the "
                   "way driven.");
    visitor.Degrees("yaw_drift_deg_per_m",
                    self.yaw_drift_rad_per_m,
                    0.0,
                    90.0,
                    "Dead reckoning: that of the yaw grows by this for each metre driven [deg/m].");
  }
};

/// How far a pose may be off.
struct PoseUncertainty {
  double position_sigma_m = 0.0;  ///< Of x and of y.
  double yaw_sigma_rad = 0.0;
};

/// Carries a start pose on by odometry: T_map_vehicle = T_map_start T_odom_start^-1 T_odom_vehicle,
/// where T_odom_start is the first odometry pose. Its uncertainty grows with the way driven; how
/// much is the configuration's word, not measured. O(1). Thread safety: none.
class DeadReckoning {
 public:
  /// @pre config has been validated.
  explicit DeadReckoning(const PoseSourceConfig& config) : config_(config) {}

  /// T_map_vehicle for an odometry pose. @pre finite. One that follows no earlier one is the start.
  [[nodiscard]] Eigen::Isometry3d Update(const Eigen::Isometry3d& T_odom_vehicle);

  /// The next odometry pose lies in a new odom frame (the base started anew): the vehicle has not
  /// moved meanwhile, as far as anybody can tell.
  void OdometryRestarted() { T_map_odom_.reset(); }

  [[nodiscard]] PoseUncertainty uncertainty() const;

 private:
  PoseSourceConfig config_;
  std::optional<Eigen::Isometry3d> T_map_odom_;
  std::optional<Eigen::Isometry3d> T_map_vehicle_;
  double driven_m_ = 0.0;
};

}  // namespace clearway::core
