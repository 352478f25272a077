// SPDX-License-Identifier: BSD-3-Clause
#include "common/core/guard/free_speed.hpp"

#include <cmath>

namespace clearway::core {

double StoppingDistance(double speed, const Braking& braking) {
  return speed * braking.reaction_time_s + speed * speed / (2.0 * braking.deceleration);
}

double FreeSpeed(double distance, const Braking& braking) {
  const double way = distance - braking.margin;
  if (!(way > 0.0)) return 0.0;
  const double a = braking.deceleration;
  const double t = braking.reaction_time_s;
  // a (sqrt(t^2 + 2 way / a) - t) without the cancellation of two nearly equal terms.
  if (std::isinf(way)) return way;
  return 2.0 * way / (std::sqrt(t * t + 2.0 * way / a) + t);
}

}  // namespace clearway::core
