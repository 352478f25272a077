// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <vector>

#include <Eigen/Core>

#include "common/core/guard/base_gate.hpp"
#include "common/core/simulation/robot_config.hpp"
#include "common/core/simulation/robot_state.hpp"

namespace clearway::core {

/// What a path follower must know of the drive.
struct PathLimits {
  double speed_mps = 0.5;     ///< Wish on straight parts.
  double lookahead_m = 0.4;   ///< Distance of the point that it steers for.
  double braking_mps2 = 1.0;  ///< It brakes with this before the end.
  double delay_s = 0.1;       ///< From a wish to its effect.
  double max_turn_radps = 1.5;
};

/// Drives along straight lines from waypoint to waypoint. It turns on the spot when what it steers
/// for lies more than 60 deg aside, and stands on the last waypoint, unless the path is a loop.
/// Source: R. C. Coulter, Implementation of the pure pursuit path tracking algorithm, 1992.
/// Thread safety: none.
class PathFollower {
 public:
  /// The path starts at `start` and leads to the first waypoint. @pre waypoints are not empty.
  PathFollower(const PathLimits& limits,
               const PlanarPose& start,
               const std::vector<RobotWaypoint>& waypoints,
               bool loop);

  /// What to drive now. O(1) but for segments shorter than the lookahead.
  [[nodiscard]] BaseMotion Wish(const PlanarPose& pose);

  /// It stands on the last waypoint.
  [[nodiscard]] bool has_arrived() const { return has_arrived_; }
  /// The waypoint that it is driving to; counted on in a loop.
  [[nodiscard]] std::size_t next_waypoint() const { return segment_; }

 private:
  [[nodiscard]] const Eigen::Vector2d& Corner(std::size_t i) const;
  [[nodiscard]] bool IsLast(std::size_t segment) const;
  /// Along the segment, of the point nearest to `position` [m].
  [[nodiscard]] double Along(const Eigen::Vector2d& position) const;
  [[nodiscard]] Eigen::Vector2d PointAhead(double along_m) const;
  [[nodiscard]] double LeftToDrive(double along_m) const;

  PathLimits limits_;
  std::vector<Eigen::Vector2d> corners_;  // Start, then the waypoints.
  bool loop_;
  std::size_t segment_ = 0;  // From corner `segment_` to the next.
  bool has_arrived_ = false;
};

}  // namespace clearway::core
