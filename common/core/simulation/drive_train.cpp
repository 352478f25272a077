// SPDX-License-Identifier: BSD-3-Clause
#include "common/core/simulation/drive_train.hpp"

#include <algorithm>
#include <cmath>

namespace clearway::core {
namespace {

constexpr double kStep_s = 1e-6 * static_cast<double>(DriveTrain::kStep_us);

struct Rates {
  double speeding_up;
  double braking;
};

// The speed a step later. What goes the other way brakes to standstill first.
double Approach(double speed, double target, const Rates& rates) {
  const bool is_braking = speed * target < 0.0 || std::abs(target) < std::abs(speed);
  const double goal = speed * target < 0.0 ? 0.0 : target;
  const double change = (is_braking ? rates.braking : rates.speeding_up) * kStep_s;
  return speed + std::clamp(goal - speed, -change, change);
}

}  // namespace

DriveTrain::DriveTrain(const RobotConfig& robot, const VehicleConfig& vehicle)
    : robot_(robot),
      max_forward_mps_(vehicle.max_forward_mps),
      max_backward_mps_(vehicle.max_backward_mps),
      max_turn_radps_(vehicle.max_turn_radps),
      braking_mps2_(robot.braking_share * vehicle.deceleration_mps2),
      turn_braking_radps2_(robot.braking_share * vehicle.turn_deceleration_radps2),
      delayed_(1 + static_cast<std::size_t>(
                       std::llround(robot.delay_share * static_cast<double>(vehicle.actuation_us) /
                                    static_cast<double>(kStep_us)))) {}

BaseMotion DriveTrain::Delayed(const BaseMotion& set_point) {
  delayed_[next_] = set_point;
  next_ = (next_ + 1) % delayed_.size();
  return delayed_[next_];
}

BaseMotion DriveTrain::OverTheFloor(const BaseMotion& wheels, std::int64_t time_us) const {
  const double half_m = 0.5 * robot_.wheel_track_m;
  double left_mps = wheels.v_mps - half_m * wheels.w_radps;
  double right_mps = wheels.v_mps + half_m * wheels.w_radps;
  bool does_slip = false;
  for (const WheelSlipConfig& slip : robot_.wheel_slips) {
    if (!slip.times.Hold(time_us)) continue;
    left_mps *= 1.0 - slip.left;
    right_mps *= 1.0 - slip.right;
    does_slip = true;
  }
  if (!does_slip) return wheels;
  return {0.5 * (left_mps + right_mps), (right_mps - left_mps) / robot_.wheel_track_m};
}

RobotState DriveTrain::Step(const RobotState& before,
                            const BaseMotion& set_point,
                            std::int64_t time_us) {
  const BaseMotion target = Delayed(set_point);
  RobotState after = before;
  after.wheel_v_mps = Approach(before.wheel_v_mps,
                               std::clamp(target.v_mps, -max_backward_mps_, max_forward_mps_),
                               {robot_.acceleration_mps2, braking_mps2_});
  after.wheel_w_radps = Approach(before.wheel_w_radps,
                                 std::clamp(target.w_radps, -max_turn_radps_, max_turn_radps_),
                                 {robot_.turn_acceleration_radps2, turn_braking_radps2_});
  const BaseMotion wheels{0.5 * (before.wheel_v_mps + after.wheel_v_mps),
                          0.5 * (before.wheel_w_radps + after.wheel_w_radps)};
  const BaseMotion floor = OverTheFloor(wheels, time_us);
  after.in_odom = before.in_odom.Moved(wheels.v_mps * kStep_s, wheels.w_radps * kStep_s);
  after.in_map = before.in_map.Moved(floor.v_mps * kStep_s, floor.w_radps * kStep_s);
  after.driven_m += std::abs(floor.v_mps) * kStep_s;

  const BaseMotion floor_after =
      OverTheFloor({after.wheel_v_mps, after.wheel_w_radps}, time_us + kStep_us);
  after.a_mps2 = (floor_after.v_mps - before.v_mps) / kStep_s;
  after.v_mps = floor_after.v_mps;
  after.w_radps = floor_after.w_radps;
  const double share =
      -std::expm1(-static_cast<double>(kStep_us) / static_cast<double>(robot_.dive_lag_us));
  after.pitch_rad += share * (-robot_.dive_rad_per_mps2 * after.a_mps2 - before.pitch_rad);
  return after;
}

}  // namespace clearway::core
