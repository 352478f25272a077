// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

namespace clearway::core {

/// When an error acts, in seconds of the simulated world. Its fields are attributes of the error's
/// own element.
struct ErrorTimes {
  double from_s = 0.0;
  double to_s = -1.0;

  /// True from from_s on until before to_s. `time_us` counts from the world's start.
  [[nodiscard]] bool Hold(std::int64_t time_us) const {
    const double time_s = 1e-6 * static_cast<double>(time_us);
    return time_s >= from_s && (to_s < 0.0 || time_s < to_s);
  }

  /// Since the error began to act [s].
  [[nodiscard]] double Since(std::int64_t time_us) const {
    return 1e-6 * static_cast<double>(time_us) - from_s;
  }

  template <typename Self, typename Visitor>
  static void Visit(Self& self, Visitor& visitor) {
    visitor.Number(
        "from_s", self.from_s, 0.0, 86400.0, "When it begins, after the simulator's start [s].");
    visitor.Number("to_s", self.to_s, -1.0, 86400.0, "When it ends, likewise [s]; -1: never.");
  }

  [[nodiscard]] std::vector<std::string> Validate() const {
    if (to_s < 0.0 || to_s > from_s) return {};
    return {"to_s must be greater than from_s, or -1"};
  }
};

/// Wheels that slip. XML element: <simulator><robot><wheel_slip>.
struct WheelSlipConfig {
  ErrorTimes times;
  double left = 0.0;
  double right = 0.0;

  template <typename Self, typename Visitor>
  static void Visit(Self& self, Visitor& visitor) {
    ErrorTimes::Visit(self.times, visitor);
    visitor.Number("left",
                   self.left,
                   -1.0,
                   1.0,
                   "Share of the left wheel's motion that the floor does not get: 1 spins on the "
                   "spot; below 0 the floor gets more, as when sliding.");
    visitor.Number("right", self.right, -1.0, 1.0, "That of the right wheel.");
  }
  [[nodiscard]] std::vector<std::string> Validate() const { return times.Validate(); }
};

/// What is wrong with ODOMETRY. XML element: <simulator><robot><odometry_error>.
struct OdometryErrorConfig {
  ErrorTimes times;
  double scale = 1.0;
  double turn_scale = 1.0;
  double noise_mps = 0.0;
  double noise_radps = 0.0;
  std::int64_t delay_us = 0;
  double loss = 0.0;

  template <typename Self, typename Visitor>
  static void Visit(Self& self, Visitor& visitor) {
    ErrorTimes::Visit(self.times, visitor);
    visitor.Number("scale", self.scale, -10.0, 10.0, "Measured way over way of the wheels.");
    visitor.Number("turn_scale", self.turn_scale, -10.0, 10.0, "The same for turning.");
    visitor.Number("noise_mps",
                   self.noise_mps,
                   0.0,
                   10.0,
                   "Standard deviation of the speed of each message [m/s]; it goes into the pose.");
    visitor.Degrees("noise_degps", self.noise_radps, 0.0, 360.0, "That of the turn rate [deg/s].");
    visitor.Milliseconds(
        "delay_ms", self.delay_us, 0.0, 60000.0, "Messages leave later; stamps stay [ms].");
    visitor.Number("loss", self.loss, 0.0, 1.0, "Share of the messages that is not sent.");
  }
  [[nodiscard]] std::vector<std::string> Validate() const { return times.Validate(); }
};

/// What a localization says of itself: POSE_STATUS.
enum class PoseClaim : std::int8_t { kLost, kUncertain, kGood };
inline constexpr std::array<std::pair<const char*, PoseClaim>, 3> kPoseClaimNames{
    {{"lost", PoseClaim::kLost}, {"uncertain", PoseClaim::kUncertain}, {"good", PoseClaim::kGood}}};

/// What is wrong with POSE. XML element: <simulator><robot><pose_error>.
struct PoseErrorConfig {
  ErrorTimes times;
  double bias_x_m = 0.0;
  double bias_y_m = 0.0;
  double bias_yaw_rad = 0.0;
  double noise_m = 0.0;
  double noise_rad = 0.0;
  double drift_mps = 0.0;
  double drift_toward_rad = 0.0;
  double drift_radps = 0.0;
  double jump_m = 0.0;
  double jump_rad = 0.0;
  double jump_every_s = 10.0;
  std::int64_t delay_us = 0;
  double loss = 0.0;
  PoseClaim claim = PoseClaim::kGood;

  template <typename Self, typename Visitor>
  static void Visit(Self& self, Visitor& visitor) {
    ErrorTimes::Visit(self.times, visitor);
    VisitOffsets(self, visitor);
    visitor.Milliseconds(
        "delay_ms", self.delay_us, 0.0, 60000.0, "Messages leave later; stamps stay [ms].");
    visitor.Number("loss", self.loss, 0.0, 1.0, "Share of the messages that is not sent.");
    visitor.Choice("claim",
                   self.claim,
                   kPoseClaimNames,
                   "What POSE_STATUS says meanwhile: \"good\" is an error that nobody notices.");
  }
  [[nodiscard]] std::vector<std::string> Validate() const { return times.Validate(); }

 private:
  template <typename Self, typename Visitor>
  static void VisitOffsets(Self& self, Visitor& visitor) {
    visitor.Number("bias_x_m", self.bias_x_m, -1000.0, 1000.0, "Added, along x of map [m].");
    visitor.Number("bias_y_m", self.bias_y_m, -1000.0, 1000.0, "Added, along y of map [m].");
    visitor.Degrees("bias_yaw_deg", self.bias_yaw_rad, -180.0, 180.0, "Added [deg].");
    visitor.Number("noise_m",
                   self.noise_m,
                   0.0,
                   100.0,
                   "Standard deviation of x and of y, new in each message [m].");
    visitor.Degrees("noise_deg", self.noise_rad, 0.0, 180.0, "That of the yaw [deg].");
    visitor.Number("drift_mps", self.drift_mps, -10.0, 10.0, "Grows from from_s on [m/s].");
    visitor.Degrees("drift_toward_deg",
                    self.drift_toward_rad,
                    -180.0,
                    180.0,
                    "Direction of the drift, from x of map [deg].");
    visitor.Degrees(
        "drift_degps", self.drift_radps, -180.0, 180.0, "The yaw grows by this [deg/s].");
    visitor.Number("jump_m",
                   self.jump_m,
                   0.0,
                   1000.0,
                   "Every jump_every_s, first at from_s, x and y take another offset of this "
                   "standard deviation [m].");
    visitor.Degrees("jump_deg", self.jump_rad, 0.0, 180.0, "So does the yaw [deg].");
    visitor.Number("jump_every_s", self.jump_every_s, 0.01, 86400.0, "Between two jumps [s].");
  }
};

}  // namespace clearway::core
