// SPDX-License-Identifier: BSD-3-Clause
#include "common/core/simulation/robot.hpp"

#include <algorithm>
#include <cmath>

namespace clearway::core {
namespace {

constexpr std::int64_t kStep_us = DriveTrain::kStep_us;
constexpr double kTouch_m = 1e-9;
constexpr double kLookRange_m = 5.0;

PlanarPose StartOf(const SceneConfig& scene) {
  return {scene.start.x_m, scene.start.y_m, scene.start.yaw_rad};
}

std::optional<PathFollower> MakeFollower(const RobotConfig& robot,
                                         const VehicleConfig& vehicle,
                                         const SceneConfig& scene,
                                         const DriveTrain& drive_train) {
  if (robot.drive != DriveMode::kPath || robot.waypoints.empty()) return std::nullopt;
  return PathFollower({.speed_mps = robot.speed_mps,
                       .lookahead_m = robot.lookahead_m,
                       .braking_mps2 = drive_train.braking_mps2(),
                       .delay_s = drive_train.Delay(),
                       .max_turn_radps = vehicle.max_turn_radps},
                      StartOf(scene),
                      robot.waypoints,
                      robot.loop);
}

}  // namespace

Robot::Robot(const RobotConfig& robot,
             const VehicleConfig& vehicle,
             const SceneConfig& scene,
             const std::optional<MapWalls>& walls)
    : config_(robot),
      floor_plan_(scene, walls, {vehicle.Footprint(), robot.clearance_m, robot.height_m}),
      drive_train_(robot, vehicle),
      follower_(MakeFollower(robot, vehicle, scene, drive_train_)),
      gate_(robot.gate),
      history_(kHistory) {
  history_[0].in_map = StartOf(scene);
  LookAround();
}

void Robot::AdvanceTo(std::int64_t time_us) {
  while ((steps_ + 1) * kStep_us <= time_us) Step();
}

RobotState Robot::StateAt(std::int64_t time_us) {
  AdvanceTo(time_us);
  const auto oldest = std::max<std::int64_t>(0, steps_ + 1 - static_cast<std::int64_t>(kHistory));
  const std::int64_t step = std::clamp(time_us / kStep_us, oldest, steps_);
  RobotState state = history_[static_cast<std::size_t>(step) % kHistory];
  // Within a step: speeds as at its beginning, which is off by a dt^2 / 2, half a micrometre.
  const std::int64_t within_us = std::clamp<std::int64_t>(time_us - step * kStep_us, 0, kStep_us);
  const double rest_s = 1e-6 * static_cast<double>(within_us);
  state.in_map = state.in_map.Moved(state.v_mps * rest_s, state.w_radps * rest_s);
  state.in_odom = state.in_odom.Moved(state.wheel_v_mps * rest_s, state.wheel_w_radps * rest_s);
  return state;
}

bool Robot::OnPermit(const BasePermit& permit, std::int64_t time_us) {
  AdvanceTo(time_us);
  return gate_.OnPermit(permit, time_us);
}

void Robot::OnOrder(const BaseCommand& order, std::int64_t time_us) {
  AdvanceTo(time_us);
  gate_.OnCommand(order, time_us);
}

BaseMotion Robot::Wish(std::int64_t time_us) {
  if (1e-6 * static_cast<double>(time_us) < config_.start_s) return {};
  switch (config_.drive) {
    case DriveMode::kStill:
      return {};
    case DriveMode::kStraight:
      return {config_.speed_mps, 0.0};
    case DriveMode::kPath:
      if (!follower_) return {};
      return follower_->Wish(history_[static_cast<std::size_t>(steps_) % kHistory].in_map);
    case DriveMode::kRequest:
    case DriveMode::kCommand:
      return gate_.Command(time_us);
  }
  return {};
}

void Robot::Step() {
  const std::int64_t time_us = steps_ * kStep_us;
  const RobotState& before = history_[static_cast<std::size_t>(steps_) % kHistory];
  wish_ = Wish(time_us);
  set_point_ = config_.obey_permit ? gate_.Clip(wish_, time_us) : wish_;
  // A path is kept when the permit slows the robot down: the curvature stays.
  if (follower_ && wish_.v_mps > 0.0 && set_point_.v_mps < wish_.v_mps) {
    const double kept = wish_.w_radps * set_point_.v_mps / wish_.v_mps;
    set_point_.w_radps = std::abs(kept) < std::abs(set_point_.w_radps) ? kept : set_point_.w_radps;
  }
  RobotState after = drive_train_.Step(before, set_point_, time_us);
  if (after.in_map != before.in_map) {
    if (const std::optional<std::int32_t> object = floor_plan_.Touched(after.in_map)) {
      NoteContact(*object, std::abs(before.v_mps));
      // It stands, wheels and all, where it last touched nothing.
      const double pitch_rad = after.pitch_rad;
      after = before;
      after.pitch_rad = pitch_rad;
      after.v_mps = after.w_radps = after.a_mps2 = 0.0;
      after.wheel_v_mps = after.wheel_w_radps = 0.0;
    }
  }
  ++steps_;
  history_[static_cast<std::size_t>(steps_) % kHistory] = after;
  if (steps_ * kStep_us % kLook_us == 0) LookAround();
}

// Objects move, too: what comes to the robot touches it just as well.
void Robot::LookAround() {
  const RobotState& state = history_[static_cast<std::size_t>(steps_) % kHistory];
  floor_plan_.MoveTo(steps_ * kStep_us);
  const double least_m = touched_ ? kContactEnd_m : kTouch_m;
  const double within_m = std::clamp(nearest_.distance_m, least_m, kLookRange_m);
  const FloorPlan::Neighbour now = floor_plan_.Nearest(state.in_map, within_m);
  if (now.distance_m < nearest_.distance_m) nearest_ = now;
  if (now.distance_m <= 0.0) {
    NoteContact(now.object, std::abs(state.v_mps));
  } else if (touched_ && now.distance_m >= kContactEnd_m) {
    touched_.reset();
  }
}

void Robot::NoteContact(std::int32_t object, double speed_mps) {
  nearest_ = {0.0, object};
  if (touched_ == object) return;
  touched_ = object;
  contacts_.push_back({steps_ * kStep_us, object, speed_mps});
}

}  // namespace clearway::core
