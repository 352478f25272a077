// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <span>

#include <Eigen/Core>

namespace clearway::core {

/// A rectangle in the xy plane.
struct Rectangle {
  Eigen::Vector2f center = Eigen::Vector2f::Zero();  ///< [m]
  float length_m = 0.0F;                             ///< Along yaw; the longer side.
  float width_m = 0.0F;                              ///< Across yaw.
  float yaw_rad = 0.0F;  ///< Direction of the longer side, in (-pi/2, pi/2].
};

/// The rectangle of least area around the points among the 90 whose sides lie at a whole number of
/// degrees; the lowest angle wins a tie. Centre and extents are those of the points in the turned
/// frame, so the rectangle encloses all points up to float rounding (about 1e-6 of their distance).
/// No points give a default Rectangle, one point gives one of no size there.
/// The area exceeds the exact minimum L x W by (L^2 + W^2) sin(0.5 deg) at most (to first order).
/// O(90 n). Thread safety: stateless.
/// @pre All points are finite.
/// Source: the published chain, which turns the object about its centre in steps and takes the
/// least projected rectangle; here with a step of 1 degree over the quarter turn that suffices.
[[nodiscard]] Rectangle SweepLeastRectangle(std::span<const Eigen::Vector2f> points);

}  // namespace clearway::core
