// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "common/core/guard/base_gate.hpp"
#include "common/core/simulation/robot_config.hpp"
#include "common/core/simulation/robot_state.hpp"
#include "common/core/vehicle.hpp"

namespace clearway::core {

/// Two driven wheels: a set point acts after the delay of the actuation, speeds change no faster
/// than the drives can, wheels slip, the body dives. Steps of 1 ms with a constant change of speed,
/// on exact arcs: a stop from v takes the delay and v / a, within a step, and v^2 / 2 a of way.
/// Thread safety: none.
class DriveTrain {
 public:
  static constexpr std::int64_t kStep_us = 1000;

  DriveTrain(const RobotConfig& robot, const VehicleConfig& vehicle);

  /// The state a step after `before`; `time_us` is the time of `before` since the world's start.
  /// A set point beyond the vehicle's limits is cut to them. O(1) and the number of slips.
  RobotState Step(const RobotState& before, const BaseMotion& set_point, std::int64_t time_us);

  /// Deceleration that it really has [m/s^2].
  [[nodiscard]] double braking_mps2() const { return braking_mps2_; }
  /// From a set point to its effect [s].
  [[nodiscard]] double Delay() const {
    return 1e-6 * static_cast<double>(kStep_us) * static_cast<double>(delayed_.size() - 1);
  }

 private:
  [[nodiscard]] BaseMotion Delayed(const BaseMotion& set_point);
  [[nodiscard]] BaseMotion OverTheFloor(const BaseMotion& wheels, std::int64_t time_us) const;

  RobotConfig robot_;
  double max_forward_mps_;
  double max_backward_mps_;
  double max_turn_radps_;
  double braking_mps2_;
  double turn_braking_radps2_;
  std::vector<BaseMotion> delayed_;  // A ring: one more than the steps of delay.
  std::size_t next_ = 0;
};

}  // namespace clearway::core
