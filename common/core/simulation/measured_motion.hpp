// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "common/core/guard/base_gate.hpp"
#include "common/core/simulation/injected_errors.hpp"
#include "common/core/simulation/robot_state.hpp"

namespace clearway::core {

/// What a localization makes of a true pose.
struct MeasuredPose {
  PlanarPose in_map;
  PoseClaim claim = PoseClaim::kGood;  ///< The worst of all errors that act.
  std::int64_t delay_us = 0;
  bool is_lost = false;  ///< The message, on its way.
};

/// POSE with its errors, added up over all that act. Random numbers depend on seed and time only:
/// no state, any order. Thread safety: const.
class PoseErrors {
 public:
  PoseErrors(const std::vector<PoseErrorConfig>& errors, std::uint64_t seed)
      : errors_(errors), seed_(seed) {}

  /// `time_us` since the world's start. O(errors).
  [[nodiscard]] MeasuredPose Measure(const PlanarPose& in_map, std::int64_t time_us) const;

 private:
  std::vector<PoseErrorConfig> errors_;
  std::uint64_t seed_;
};

/// What a base makes of the motion of its wheels.
struct MeasuredOdometry {
  PlanarPose in_odom;
  BaseMotion speed;
  std::int64_t delay_us = 0;
  bool is_lost = false;  ///< The message, on its way.
};

/// ODOMETRY with its errors: each step of the wheels is scaled and gets its noise, and what came
/// out is summed up. Thread safety: none.
class OdometryErrors {
 public:
  OdometryErrors(const std::vector<OdometryErrorConfig>& errors, std::uint64_t seed)
      : errors_(errors), seed_(seed) {}

  /// The measurement at `time_us` since the world's start. @pre later than in earlier calls.
  /// O(errors).
  [[nodiscard]] MeasuredOdometry Measure(const RobotState& state, std::int64_t time_us);

 private:
  struct Sample {
    PlanarPose wheels;
    std::int64_t time_us = 0;
  };

  std::vector<OdometryErrorConfig> errors_;
  std::uint64_t seed_;
  std::optional<Sample> before_;
  PlanarPose in_odom_;
};

}  // namespace clearway::core
