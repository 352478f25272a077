// SPDX-License-Identifier: BSD-3-Clause
#include "common/core/guard/sensor_watch.hpp"

#include <cmath>
#include <numbers>

namespace clearway::core {

Sectors FieldOfView(const SensorConfig& sensor) {
  constexpr double kSector_rad = 2.0 * std::numbers::pi / 72.0;
  constexpr double kRounding_rad = 1e-9;
  Sectors sectors;
  const Eigen::Vector3d axis_vehicle =
      sensor.T_vehicle_sensor().linear() * Eigen::Vector3d::UnitX();
  if (std::abs(axis_vehicle.z()) > std::numbers::sqrt2 / 2.0) return sectors;
  if (sensor.field_of_view_rad >= 2.0 * std::numbers::pi - kRounding_rad) return sectors.set();
  const double bearing_rad = std::atan2(axis_vehicle.y(), axis_vehicle.x());
  for (std::size_t k = 0; k < sectors.size(); ++k) {
    const double middle_rad = -std::numbers::pi + (static_cast<double>(k) + 0.5) * kSector_rad;
    const double off_rad =
        std::abs(std::remainder(middle_rad - bearing_rad, 2.0 * std::numbers::pi));
    sectors[k] = off_rad + 0.5 * kSector_rad <= 0.5 * sensor.field_of_view_rad + kRounding_rad;
  }
  return sectors;
}

bool SensorWatch::OnSlice(std::int64_t session,
                          std::int64_t sequence,
                          std::int64_t stamp_us,
                          std::int64_t now_us) {
  const std::int64_t session_before = tracker_.session();
  const SequenceVerdict verdict = tracker_.Observe(session, sequence, now_us);
  const bool restarts = verdict == SequenceVerdict::kRestart;
  // One sender starts anew with a new session, and not twice in a moment. A session that is heard
  // again from its beginning is a log that is played, not a sensor.
  const bool repeats = restarts && (session == session_before || RestartedLately(now_us));
  if (verdict == SequenceVerdict::kForeign || repeats) {
    foreign_heard_ = true;
    foreign_us_ = now_us;
  }
  if (!IsNewest(verdict)) return false;
  if (restarts) {
    freshness_.Reset();
    has_restarted_ = true;
    restart_us_ = now_us;
  }
  freshness_.OnArrival(now_us, stamp_us);
  return true;
}

bool SensorWatch::RestartedLately(std::int64_t now_us) const {
  return has_restarted_ && now_us - restart_us_ <= SequenceTracker::kForeign_us;
}

void SensorWatch::OnReturns(std::int64_t num_returns, std::int64_t now_us) {
  const std::int64_t half_us = config_.returns_window_us / 2;
  if (now_us - half_start_us_ >= half_us) {
    returns_before_ = now_us - half_start_us_ < 2 * half_us ? returns_now_ : 0;
    returns_now_ = 0;
    half_start_us_ = now_us;
  }
  returns_now_ += num_returns;
}

std::int64_t SensorWatch::ReturnsWithinWindow(std::int64_t now_us) const {
  return now_us - half_start_us_ > config_.returns_window_us ? 0 : returns_now_ + returns_before_;
}

SensorState SensorWatch::State(std::int64_t now_us) const {
  const FreshnessWatch::State freshness = freshness_.Query(now_us);
  if (!freshness.has_arrived) return SensorState::kNotHeard;
  if (freshness.age_us > config_.slice_timeout_us) return SensorState::kSilent;
  if (freshness.lateness_us > config_.max_lateness_us) return SensorState::kLate;
  if (foreign_heard_ && now_us - foreign_us_ <= SequenceTracker::kForeign_us) {
    return SensorState::kTwoPublishers;
  }
  if (ReturnsWithinWindow(now_us) < config_.min_returns) return SensorState::kNoReturns;
  return SensorState::kGood;
}

}  // namespace clearway::core
