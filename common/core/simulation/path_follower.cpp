// SPDX-License-Identifier: BSD-3-Clause
#include "common/core/simulation/path_follower.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace clearway::core {
namespace {

constexpr double kTurnOnTheSpot_rad = std::numbers::pi / 3.0;
constexpr double kTurnGain_hz = 2.0;
constexpr double kArrived_m = 0.01;

}  // namespace

PathFollower::PathFollower(const PathLimits& limits,
                           const PlanarPose& start,
                           const std::vector<RobotWaypoint>& waypoints,
                           bool loop)
    : limits_(limits), loop_(loop) {
  corners_.emplace_back(start.x_m, start.y_m);
  for (const RobotWaypoint& waypoint : waypoints) {
    corners_.emplace_back(waypoint.x_m, waypoint.y_m);
  }
}

// The start is a corner once; a loop goes on among the waypoints.
const Eigen::Vector2d& PathFollower::Corner(std::size_t i) const {
  if (i < corners_.size()) return corners_[i];
  return corners_[1 + (i - 1) % (corners_.size() - 1)];
}

bool PathFollower::IsLast(std::size_t segment) const {
  return !loop_ && segment + 2 >= corners_.size();
}

double PathFollower::Along(const Eigen::Vector2d& position) const {
  const Eigen::Vector2d way = Corner(segment_ + 1) - Corner(segment_);
  const double length_m = way.norm();
  return length_m > 0.0 ? (position - Corner(segment_)).dot(way) / length_m : 0.0;
}

// The last segment goes on beyond its end, so that the heading stays steady there.
Eigen::Vector2d PathFollower::PointAhead(double along_m) const {
  double left_m = std::max(0.0, along_m) + limits_.lookahead_m;
  std::size_t segment = segment_;
  for (;; ++segment) {
    const double length_m = (Corner(segment + 1) - Corner(segment)).norm();
    if (left_m <= length_m || IsLast(segment)) break;
    left_m -= length_m;
  }
  const Eigen::Vector2d way = Corner(segment + 1) - Corner(segment);
  return way.norm() > 0.0 ? Eigen::Vector2d(Corner(segment) + left_m * way.normalized())
                          : Corner(segment);
}

double PathFollower::LeftToDrive(double along_m) const {
  if (loop_) return std::numeric_limits<double>::infinity();
  double left_m = -along_m;
  for (std::size_t segment = segment_; segment + 1 < corners_.size(); ++segment) {
    left_m += (corners_[segment + 1] - corners_[segment]).norm();
  }
  return left_m;
}

BaseMotion PathFollower::Wish(const PlanarPose& pose) {
  if (has_arrived_) return {};
  const Eigen::Vector2d position(pose.x_m, pose.y_m);
  for (std::size_t i = 0; i < corners_.size() && !IsLast(segment_); ++i) {
    const double length_m = (Corner(segment_ + 1) - Corner(segment_)).norm();
    if (Along(position) < length_m - kArrived_m) break;
    ++segment_;
  }
  const double along_m = Along(position);
  const double left_m = LeftToDrive(along_m);
  if (left_m < kArrived_m) {
    has_arrived_ = true;
    return {};
  }
  const Eigen::Vector2d ahead = PointAhead(along_m) - position;
  const double aside_rad =
      std::remainder(std::atan2(ahead.y(), ahead.x()) - pose.yaw_rad, 2.0 * std::numbers::pi);
  const double most = limits_.max_turn_radps;
  if (std::abs(aside_rad) > kTurnOnTheSpot_rad) {
    return {0.0, std::clamp(kTurnGain_hz * aside_rad, -most, most)};
  }
  const double curvature = 2.0 * std::sin(aside_rad) / ahead.norm();
  // The way that braking takes, the delay's included: v delay + v^2 / 2 a <= left.
  const double a = limits_.braking_mps2;
  const double stop_mps =
      a * (std::sqrt(limits_.delay_s * limits_.delay_s + 2.0 * left_m / a) - limits_.delay_s);
  double v_mps = std::min(limits_.speed_mps, stop_mps);
  if (std::abs(curvature) * v_mps > most) v_mps = most / std::abs(curvature);
  return {v_mps, curvature * v_mps};
}

}  // namespace clearway::core
