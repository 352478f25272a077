// SPDX-License-Identifier: BSD-3-Clause
#include "common/core/simulation/measured_motion.hpp"

#include <algorithm>
#include <cmath>

#include "common/core/simulation/noise.hpp"

namespace clearway::core {
namespace {

// What a random number is for; each error of each kind has a row of its own.
enum class Use : std::uint64_t {
  kNoiseX,
  kNoiseY,
  kNoiseYaw,
  kJumpX,
  kJumpY,
  kJumpYaw,
  kPoseLoss,
  kSpeed,
  kTurnRate,
  kOdometryLoss
};

std::uint64_t Row(std::uint64_t seed, std::size_t error, Use use) {
  return SplitMix64(SplitMix64(seed) + 16 * error + static_cast<std::uint64_t>(use));
}

bool IsLost(std::uint64_t row, std::int64_t time_us, double share) {
  constexpr double kUnit = 0x1.0p-53;
  const std::uint64_t bits = SplitMix64(row ^ SplitMix64(static_cast<std::uint64_t>(time_us)));
  return static_cast<double>(bits >> 11U) * kUnit < share;
}

// What one error adds.
PlanarPose OffsetOf(const PoseErrorConfig& error,
                    std::uint64_t seed,
                    std::size_t index,
                    std::int64_t time_us) {
  const double since_s = error.times.Since(time_us);
  const auto message = static_cast<std::uint64_t>(time_us);
  const auto jump = static_cast<std::uint64_t>(since_s / error.jump_every_s);
  const auto random = [&](Use use, double sigma, std::uint64_t counter) {
    return sigma > 0.0 ? sigma * NormalNoise(Row(seed, index, use), counter) : 0.0;
  };
  const double drift_m = error.drift_mps * since_s;
  return {
      error.bias_x_m + drift_m * std::cos(error.drift_toward_rad) +
          random(Use::kNoiseX, error.noise_m, message) + random(Use::kJumpX, error.jump_m, jump),
      error.bias_y_m + drift_m * std::sin(error.drift_toward_rad) +
          random(Use::kNoiseY, error.noise_m, message) + random(Use::kJumpY, error.jump_m, jump),
      error.bias_yaw_rad + error.drift_radps * since_s +
          random(Use::kNoiseYaw, error.noise_rad, message) +
          random(Use::kJumpYaw, error.jump_rad, jump)};
}

}  // namespace

MeasuredPose PoseErrors::Measure(const PlanarPose& in_map, std::int64_t time_us) const {
  MeasuredPose measured;
  measured.in_map = in_map;
  for (std::size_t i = 0; i < errors_.size(); ++i) {
    const PoseErrorConfig& error = errors_[i];
    if (!error.times.Hold(time_us)) continue;
    const PlanarPose offset = OffsetOf(error, seed_, i, time_us);
    measured.in_map.x_m += offset.x_m;
    measured.in_map.y_m += offset.y_m;
    measured.in_map.yaw_rad += offset.yaw_rad;
    measured.claim = std::min(measured.claim, error.claim);
    measured.delay_us += error.delay_us;
    measured.is_lost =
        measured.is_lost || IsLost(Row(seed_, i, Use::kPoseLoss), time_us, error.loss);
  }
  return measured;
}

MeasuredOdometry OdometryErrors::Measure(const RobotState& state, std::int64_t time_us) {
  const Sample now{state.in_odom, time_us};
  const Sample before = before_.value_or(now);
  before_ = now;
  // The way of a step is its chord's, with the sign of the motion along the middle heading.
  const double turn_rad = now.wheels.yaw_rad - before.wheels.yaw_rad;
  const double heading_rad = before.wheels.yaw_rad + 0.5 * turn_rad;
  double way_m = (now.wheels.x_m - before.wheels.x_m) * std::cos(heading_rad) +
                 (now.wheels.y_m - before.wheels.y_m) * std::sin(heading_rad);
  double turned_rad = turn_rad;
  const double step_s = 1e-6 * static_cast<double>(now.time_us - before.time_us);
  MeasuredOdometry measured;
  measured.speed = {state.wheel_v_mps, state.wheel_w_radps};
  for (std::size_t i = 0; i < errors_.size(); ++i) {
    const OdometryErrorConfig& error = errors_[i];
    if (!error.times.Hold(time_us)) continue;
    const auto message = static_cast<std::uint64_t>(time_us);
    const double v_mps = error.noise_mps > 0.0
                             ? error.noise_mps * NormalNoise(Row(seed_, i, Use::kSpeed), message)
                             : 0.0;
    const double w_radps =
        error.noise_radps > 0.0
            ? error.noise_radps * NormalNoise(Row(seed_, i, Use::kTurnRate), message)
            : 0.0;
    way_m = error.scale * way_m + v_mps * step_s;
    turned_rad = error.turn_scale * turned_rad + w_radps * step_s;
    measured.speed.v_mps = error.scale * measured.speed.v_mps + v_mps;
    measured.speed.w_radps = error.turn_scale * measured.speed.w_radps + w_radps;
    measured.delay_us += error.delay_us;
    measured.is_lost =
        measured.is_lost || IsLost(Row(seed_, i, Use::kOdometryLoss), time_us, error.loss);
  }
  const double middle_rad = in_odom_.yaw_rad + 0.5 * turned_rad;
  in_odom_ = {in_odom_.x_m + way_m * std::cos(middle_rad),
              in_odom_.y_m + way_m * std::sin(middle_rad),
              in_odom_.yaw_rad + turned_rad};
  measured.in_odom = in_odom_;
  return measured;
}

}  // namespace clearway::core
