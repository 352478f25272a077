// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>

#include "common/core/perception/floor/floor_finder.hpp"

namespace clearway::core {

/// RANSAC for a plane perpendicular to z (pcl::SACSegmentation, SACMODEL_PERPENDICULAR_PLANE) with
/// refinement on the inliers, over the points that a permitted floor could contain: a plane with a
/// tilt of at most T that passes the origin at most H high or low has, at the horizontal distance
/// r, |z| <= H + r tan T, to which the inlier's distance d adds d / cos T. A plane that fails the
/// check of tilt and height afterwards (a table top within that band) gives its points up and the
/// search goes on without them, three times at most. Tilts of at most 0.001 rad, which PCL's float
/// angles cannot tell from 0, are answered by a level plane: the height with most points within d
/// of it. O(max_hypotheses n), O(n log n) for the level plane. Random numbers have a fixed seed.
/// Makes PCL's console silent for the whole program: PCL prints an error for each scan without a
/// plane.
/// Source: M. A. Fischler, R. C. Bolles, Random sample consensus, Comm. ACM 24(6), 1981.
[[nodiscard]] std::unique_ptr<FloorFinder> MakeTextbookFloorFinder(const FloorConfig& config);

}  // namespace clearway::core
