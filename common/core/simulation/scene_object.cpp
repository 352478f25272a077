// SPDX-License-Identifier: BSD-3-Clause
#include "common/core/simulation/scene_object.hpp"

#include <algorithm>
#include <cmath>

namespace clearway::core {

namespace {

struct Leg {
  double from_x_m;
  double from_y_m;
  double to_x_m;
  double to_y_m;
  double length_m;
  double pause_s;  // After the leg.
};

std::vector<Leg> LegsOf(const SceneObject& object) {
  std::vector<SceneWaypoint> stops = object.waypoints;
  if (object.loop) stops.push_back({object.x_m, object.y_m, 0.0});
  std::vector<Leg> legs;
  double x_m = object.x_m;
  double y_m = object.y_m;
  for (const SceneWaypoint& stop : stops) {
    const double length_m = std::hypot(stop.x_m - x_m, stop.y_m - y_m);
    legs.push_back({x_m, y_m, stop.x_m, stop.y_m, length_m, stop.pause_s});
    x_m = stop.x_m;
    y_m = stop.y_m;
  }
  return legs;
}

// Follows the legs for `elapsed_s` from the state of an object that has not moved yet.
SceneMotion Follow(const std::vector<Leg>& legs,
                   double speed_mps,
                   double elapsed_s,
                   SceneMotion motion) {
  for (const Leg& leg : legs) {
    const double duration_s = leg.length_m / speed_mps;
    if (leg.length_m > 0.0) {
      motion.yaw_rad = std::atan2(leg.to_y_m - leg.from_y_m, leg.to_x_m - leg.from_x_m);
    }
    if (elapsed_s < duration_s) {
      const double share = elapsed_s / duration_s;
      motion.x_m = leg.from_x_m + share * (leg.to_x_m - leg.from_x_m);
      motion.y_m = leg.from_y_m + share * (leg.to_y_m - leg.from_y_m);
      motion.vx_mps = speed_mps * std::cos(motion.yaw_rad);
      motion.vy_mps = speed_mps * std::sin(motion.yaw_rad);
      motion.distance_m += speed_mps * elapsed_s;
      return motion;
    }
    motion.x_m = leg.to_x_m;
    motion.y_m = leg.to_y_m;
    motion.distance_m += leg.length_m;
    elapsed_s -= duration_s;
    if (elapsed_s < leg.pause_s) return motion;
    elapsed_s -= leg.pause_s;
  }
  return motion;
}

}  // namespace

std::vector<std::string> SceneObject::Validate(const std::string& kind) const {
  std::vector<std::string> problems;
  const std::string who = kind + " \"" + name + "\": ";
  if (appear_s >= 0.0 && vanish_s >= 0.0 && vanish_s <= appear_s) {
    problems.push_back(who + "vanish_s must be later than appear_s, or -1 for never.");
  }
  if (!waypoints.empty() && speed_mps <= 0.0) {
    problems.push_back(who + "it has waypoints, so speed_mps must be more than 0.");
  }
  if (waypoints.empty() && (speed_mps > 0.0 || loop)) {
    problems.push_back(who + "speed_mps and loop need at least one waypoint.");
  }
  return problems;
}

bool IsPresent(const SceneObject& object, double time_s) {
  const bool has_come = object.appear_s < 0.0 || time_s >= object.appear_s;
  const bool is_gone = object.vanish_s >= 0.0 && time_s >= object.vanish_s;
  return has_come && !is_gone;
}

SceneMotion MotionAt(const SceneObject& object, double time_s) {
  SceneMotion motion{.x_m = object.x_m, .y_m = object.y_m, .yaw_rad = object.yaw_rad};
  double elapsed_s = time_s - object.start_s;
  if (object.waypoints.empty() || !(object.speed_mps > 0.0) || elapsed_s < 0.0) return motion;

  const std::vector<Leg> legs = LegsOf(object);
  if (object.loop) {
    double round_m = 0.0;
    double round_s = 0.0;
    for (const Leg& leg : legs) {
      round_m += leg.length_m;
      round_s += leg.length_m / object.speed_mps + leg.pause_s;
    }
    if (!(round_s > 0.0)) return motion;
    const double rounds = std::floor(elapsed_s / round_s);
    elapsed_s = std::max(0.0, elapsed_s - rounds * round_s);
    motion.distance_m = rounds * round_m;
  }
  return Follow(legs, object.speed_mps, elapsed_s, motion);
}

}  // namespace clearway::core
