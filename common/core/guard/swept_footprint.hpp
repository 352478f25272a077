// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include <Eigen/Core>

namespace clearway::core {

/// The elementary motions that are permitted or not. The values are those of the wire.
enum class Direction : std::int8_t { kForward = 0, kBackward = 1, kTurnLeft = 2, kTurnRight = 3 };
inline constexpr std::size_t kNumDirections = 4;

/// For each Direction, how far the footprint can move until it meets a point: [m] forward and
/// backward, [rad] turning on the spot about the vehicle's origin. Infinity when it never does.
using FreeWay = std::array<double, kNumDirections>;

/// The area that a convex footprint covers when it moves straight or turns on the spot.
///
/// Straight: the footprint widened by `margin_m` to both sides moves along +-x; the way counts from
/// the widened footprint's edge. A point beside the robot, nearer than the margin but not in front
/// of or behind any part of the footprint, does not hinder straight motion: that comes no nearer.
/// Turning: the footprint grown by `margin_m` on all sides (corners mitred, so rather too large)
/// turns about the origin; exact, by the crossings of the point's circle with the edges.
/// A point inside the footprint itself leaves no way in any direction.
/// O(corners) a point, no allocation. Thread safety: const.
class SweptFootprint {
 public:
  /// @pre `footprint` is convex, counter-clockwise, of 3 or more corners; margin_m >= 0.
  SweptFootprint(const std::vector<Eigen::Vector2d>& footprint, double margin_m);

  [[nodiscard]] FreeWay WayTo(const Eigen::Vector2d& point_vehicle) const;

  /// Radius of the disc that turning on the spot may touch, margin included [m].
  [[nodiscard]] double turn_radius_m() const { return turn_radius_m_; }
  /// Largest distance of the footprint from the origin along x, ahead or behind [m].
  [[nodiscard]] double half_length_m() const { return half_length_m_; }

 private:
  void StraightWay(const Eigen::Vector2d& point, FreeWay& way) const;
  void TurningWay(const Eigen::Vector2d& point, FreeWay& way) const;

  std::vector<Eigen::Vector2d> footprint_;
  std::vector<Eigen::Vector2d> widened_;
  std::vector<Eigen::Vector2d> grown_;
  double turn_radius_m_ = 0.0;
  double half_length_m_ = 0.0;
};

/// True when the point lies in the polygon or on its edge. @pre convex and counter-clockwise.
[[nodiscard]] bool IsInside(const std::vector<Eigen::Vector2d>& polygon,
                            const Eigen::Vector2d& point);

}  // namespace clearway::core
