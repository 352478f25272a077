// SPDX-License-Identifier: BSD-3-Clause
#pragma once

namespace clearway::core {

/// How something brakes, along a line (m) or about an axis (rad).
struct Braking {
  double deceleration = 1.0;     ///< a > 0: guaranteed, not nominal [m/s^2 or rad/s^2].
  double reaction_time_s = 0.0;  ///< t_r >= 0: from the event to the brakes' action.
  double margin = 0.0;           ///< m >= 0: what must be left when standing [m or rad].
};

/// Way used until standing still: v t_r + v^2 / (2 a), without the margin. @pre speed >= 0.
[[nodiscard]] double StoppingDistance(double speed, const Braking& braking);

/// The highest speed from which the vehicle still stands before `distance` is used up:
/// v_max(d) = a (sqrt(t_r^2 + 2 (d - m) / a) - t_r), and 0 for d <= m; the inverse of
/// StoppingDistance(v) = d - m. Infinite distance gives infinity, NaN gives 0.
[[nodiscard]] double FreeSpeed(double distance, const Braking& braking);

}  // namespace clearway::core
