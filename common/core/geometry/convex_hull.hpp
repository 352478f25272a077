// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <span>
#include <vector>

#include <Eigen/Core>

namespace clearway::core {

/// The convex hull of points in the plane [m]: its corners counter-clockwise, not closed, starting
/// at the one with the least x (then least y). No corner lies on the segment between its
/// neighbours. Degenerate input gives fewer than three corners: all points at one place give 1, all
/// on a line give its 2 ends, none gives none. Points that are not finite are ignored. O(n log n).
/// The order of the points does not matter. Thread safety: stateless. Source: A. M. Andrew, Another
/// efficient algorithm for convex hulls in two dimensions, Information Processing Letters 9(5),
/// 1979 (monotone chain). Orientations are evaluated in double from float coordinates, so they are
/// exact for coordinates of comparable magnitude.
[[nodiscard]] std::vector<Eigen::Vector2f> ConvexHull(std::span<const Eigen::Vector2f> points);

/// The point of a hull nearest to the origin [m]; the origin itself when the hull contains it. An
/// empty hull gives the origin. O(n).
/// @pre `hull` is convex and counter-clockwise, as ConvexHull() gives it.
[[nodiscard]] Eigen::Vector2f NearestToOrigin(std::span<const Eigen::Vector2f> hull);

}  // namespace clearway::core
