// SPDX-License-Identifier: BSD-3-Clause
#include "common/core/guard/stop_guard.hpp"

#include <algorithm>
#include <cmath>

namespace clearway::core {

namespace {

// A vehicle that measures more than this above its top speed is not believed: the hits would be
// carried past it.
constexpr double kSpeedFactor = 1.5;
constexpr double kSpeedSlack = 0.5;  // [m/s or rad/s]

constexpr bool IsPossible(double speed, double top_speed) {
  return std::abs(speed) <= kSpeedFactor * top_speed + kSpeedSlack;
}

constexpr std::size_t Index(Direction d) {
  return static_cast<std::size_t>(d);
}

constexpr bool IsTurn(Direction d) {
  return d == Direction::kTurnLeft || d == Direction::kTurnRight;
}

// Farther hits limit nothing: the way for a stop from top speed, for the longest time without
// odometry, and something for the motion between two slices.
double Reach(const StopGuardConfig& config, const VehicleConfig& vehicle) {
  const double top_mps = std::max(vehicle.max_forward_mps, vehicle.max_backward_mps);
  const Braking braking{vehicle.deceleration_mps2, vehicle.ReactionTime(), config.front_margin_m};
  return StoppingDistance(top_mps, braking) + config.front_margin_m +
         top_mps * 1e-6 * static_cast<double>(config.odometry_stop_us) + 0.3;
}

// End of the slice's measurement; slices cut a scan evenly in time.
std::int64_t SliceEnd(const Slice& slice) {
  const std::int64_t duration_us = slice.scan_end_utime - slice.scan_utime;
  return slice.scan_utime + duration_us * (slice.slice_index + 1) / slice.slice_count;
}

PermitReason ReasonOf(SensorState state) {
  switch (state) {
    case SensorState::kSilent:
      return PermitReason::kSensorSilent;
    case SensorState::kLate:
      return PermitReason::kSlicesLate;
    case SensorState::kTwoPublishers:
      return PermitReason::kTwoPublishers;
    case SensorState::kNoReturns:
      return PermitReason::kNoReturns;
    case SensorState::kGood:
    case SensorState::kNotHeard:
      break;
  }
  return PermitReason::kStarting;
}

bool IsSeen(Direction d, const Sectors& seen) {
  switch (d) {
    case Direction::kForward:  // The sectors on both sides of 0 deg.
      return seen[seen.size() / 2 - 1] && seen[seen.size() / 2];
    case Direction::kBackward:
      return seen[0] && seen[seen.size() - 1];
    case Direction::kTurnLeft:
    case Direction::kTurnRight:
      break;
  }
  return seen.all();
}

}  // namespace

StopGuard::StopGuard(const StopGuardConfig& config, const VehicleConfig& vehicle)
    : config_(config),
      vehicle_(vehicle),
      footprint_(vehicle.Footprint(), config.side_margin_m),
      hits_(footprint_, Reach(config, vehicle), config.min_points),
      top_speed_{vehicle.max_forward_mps,
                 vehicle.max_backward_mps,
                 vehicle.max_turn_radps,
                 vehicle.max_turn_radps} {
  for (const SensorConfig& sensor : vehicle.sensors) {
    const Eigen::Isometry3d T_vehicle_sensor = sensor.T_vehicle_sensor();
    sensors_.push_back({SensorWatch(config),
                        sensor.required,
                        FieldOfView(sensor),
                        T_vehicle_sensor.linear().cast<float>(),
                        T_vehicle_sensor.translation().cast<float>(),
                        static_cast<float>(sensor.min_range_m * sensor.min_range_m),
                        static_cast<float>(sensor.max_range_m * sensor.max_range_m)});
  }
}

void StopGuard::AdvanceTo(std::int64_t now_us) {
  if (now_us <= time_us_) return;
  const std::int64_t from_us =
      time_us_ == std::numeric_limits<std::int64_t>::min() ? now_us : time_us_;
  time_us_ = now_us;
  std::int64_t until_us = now_us;
  if (!vehicle_.stationary) {
    // The last speeds are believed until odometry counts as missing.
    until_us =
        odometry_heard_ ? std::min(now_us, odometry_us_ + config_.odometry_timeout_us) : from_us;
  }
  if (until_us <= from_us) return;
  hit_clock_us_ += until_us - from_us;
  const double seconds = 1e-6 * static_cast<double>(until_us - from_us);
  hits_.Move(forward_mps_ * seconds, turn_radps_ * seconds);
}

void StopGuard::OnSlice(const Slice& slice, std::int64_t now_us) {
  ++counts_.slices;
  AdvanceTo(now_us);
  if (slice.sensor < 0 || static_cast<std::size_t>(slice.sensor) >= sensors_.size()) {
    ++counts_.unknown_sensor;
    return;
  }
  if (!IsValid(slice)) {
    ++counts_.invalid_slices;
    return;
  }
  Sensor& sensor = sensors_[static_cast<std::size_t>(slice.sensor)];
  // Hits count whoever sent them; only the newest slice of the owner makes the sensor fresh.
  const bool is_news = sensor.watch.OnSlice(slice.session, slice.sequence, SliceEnd(slice), now_us);
  std::int64_t num_returns = 0;
  for (std::size_t i = 0; i < slice.cloud_sensor.size(); ++i) {
    num_returns += TakePoint(sensor, slice.cloud_sensor.Point(i)) ? 1 : 0;
  }
  counts_.returns += num_returns;
  if (is_news) sensor.watch.OnReturns(num_returns, now_us);
}

bool StopGuard::TakePoint(const Sensor& sensor, const Eigen::Vector3f& point_sensor) {
  const float range2_m2 = point_sensor.squaredNorm();
  // Written so that NaN and infinity fail; zero returns fail even where min_range_m is 0.
  if (!(range2_m2 >= sensor.min_range2_m2 && range2_m2 <= sensor.max_range2_m2)) return false;
  if (range2_m2 == 0.0F) return false;
  const Eigen::Vector3f point = sensor.R_vehicle_sensor * point_sensor + sensor.t_vehicle_sensor;
  for (const BoxConfig& box : vehicle_.body) {
    if (box.Contains(point)) return false;
  }
  if (point.z() >= config_.min_height_m && point.z() <= config_.max_height_m) {
    ++counts_.obstacle_points;
    hits_.Add(point, hit_clock_us_);
  } else if (config_.hole_depth_m > 0.0 && point.z() < -config_.hole_depth_m &&
             sensor.t_vehicle_sensor.z() > 0.0F) {
    ++counts_.hole_points;
    const Eigen::Vector3f& origin = sensor.t_vehicle_sensor;
    hits_.Add(origin + (point - origin) * (origin.z() / (origin.z() - point.z())), hit_clock_us_);
  }
  return true;
}

void StopGuard::OnDetections(std::int64_t stamp_us, std::int64_t now_us) {
  AdvanceTo(now_us);
  detections_.OnArrival(now_us, stamp_us);
}

void StopGuard::OnOdometry(double forward_mps, double turn_radps, std::int64_t now_us) {
  AdvanceTo(now_us);
  const double top_mps = std::max(vehicle_.max_forward_mps, vehicle_.max_backward_mps);
  if (!IsPossible(forward_mps, top_mps) || !IsPossible(turn_radps, vehicle_.max_turn_radps)) {
    ++counts_.invalid_odometry;
    return;
  }
  odometry_heard_ = true;
  odometry_us_ = now_us;
  forward_mps_ = forward_mps;
  turn_radps_ = turn_radps;
}

bool StopGuard::IsOdometryMissing(std::int64_t now_us) const {
  if (vehicle_.stationary) return false;
  return !odometry_heard_ || now_us - odometry_us_ > config_.odometry_timeout_us;
}

bool StopGuard::AreDetectionsMissing(std::int64_t now_us) const {
  const FreshnessWatch::State state = detections_.Query(now_us);
  return !state.has_arrived || state.age_us > config_.detections_timeout_us ||
         state.lateness_us > config_.detections_timeout_us;
}

Permit StopGuard::PermitAt(std::int64_t now_us) {
  AdvanceTo(now_us);
  Permit permit;
  permit.detections_missing = AreDetectionsMissing(now_us);
  permit.odometry_missing = IsOdometryMissing(now_us);
  if (Close(now_us, permit)) {
    for (DirectionPermit& direction : permit.directions) direction.reason = permit.reason;
    return permit;
  }
  Open(now_us, permit);
  return permit;
}

bool StopGuard::Close(std::int64_t now_us, Permit& permit) const {
  for (std::size_t s = 0; s < sensors_.size(); ++s) {
    const SensorState state = sensors_[s].watch.State(now_us);
    if (!sensors_[s].required || state == SensorState::kGood) continue;
    permit.sensor = static_cast<int>(s);
    permit.reason = ReasonOf(state);
    return true;
  }
  if (vehicle_.stationary) return false;
  if (!odometry_heard_ || now_us - odometry_us_ > config_.odometry_stop_us) {
    permit.reason = PermitReason::kNoOdometry;
    return true;
  }
  return false;
}

Sectors StopGuard::SeenSectors(std::int64_t now_us) const {
  Sectors seen;
  for (const Sensor& sensor : sensors_) {
    if (sensor.watch.State(now_us) == SensorState::kGood) seen |= sensor.sectors;
  }
  return seen;
}

void StopGuard::Open(std::int64_t now_us, Permit& permit) {
  const std::array<NearestHit, kNumDirections> nearest =
      hits_.Nearest(hit_clock_us_, config_.hold_us);
  const Sectors seen = SeenSectors(now_us);
  for (std::size_t i = 0; i < kNumDirections; ++i) {
    const auto d = static_cast<Direction>(i);
    DirectionPermit& out = permit.directions[i];
    const double per_mps = IsTurn(d) ? 1.0 / footprint_.turn_radius_m() : 1.0;
    out.limit = top_speed_[i];
    out.reason = PermitReason::kFree;
    if (!IsSeen(d, seen) && config_.unseen_speed_mps * per_mps < out.limit) {
      out.limit = config_.unseen_speed_mps * per_mps;
      out.reason = PermitReason::kUnseen;
    }
    if (permit.detections_missing && config_.degraded_speed_mps * per_mps < out.limit) {
      out.limit = config_.degraded_speed_mps * per_mps;
      out.reason = PermitReason::kNoDetections;
    }
    Limit(d, nearest[i], now_us, out);
  }
  const auto first_blocked = std::find_if(
      permit.directions.begin(), permit.directions.end(), [](const DirectionPermit& direction) {
        return direction.reason == PermitReason::kObstacle;
      });
  if (first_blocked != permit.directions.end()) {
    permit.cause_direction = static_cast<Direction>(first_blocked - permit.directions.begin());
  }
  permit.reason = permit[permit.cause_direction].reason;
}

void StopGuard::Limit(Direction d,
                      const NearestHit& hit,
                      std::int64_t now_us,
                      DirectionPermit& out) const {
  if (std::isinf(hit.way)) return;
  double way = hit.way;
  if (IsOdometryMissing(now_us)) {
    // It may have come nearer at top speed ever since the last message.
    way -= top_speed_[Index(d)] * 1e-6 * static_cast<double>(now_us - odometry_us_);
  }
  out.free_way = std::max(0.0, way);
  out.has_cause = true;
  out.cause_vehicle = hit.point_vehicle;
  const Braking braking{IsTurn(d) ? vehicle_.turn_deceleration_radps2 : vehicle_.deceleration_mps2,
                        vehicle_.ReactionTime(),
                        IsTurn(d) ? 0.0 : config_.front_margin_m};
  const double speed = FreeSpeed(out.free_way, braking);
  if (speed >= out.limit) return;
  out.limit = speed;
  out.reason = PermitReason::kObstacle;
}

}  // namespace clearway::core
