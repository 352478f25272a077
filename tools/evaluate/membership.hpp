// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "common/core/cloud.hpp"
#include "common/core/perception/detection/detection.hpp"

namespace clearway::evaluate {

/// A hull is grown by this much before points are looked for in it: it was made of floats.
inline constexpr double kHullMargin_m = 0.001;

/// For each point the index of the detection that it belongs to: the one whose hull, grown by
/// kHullMargin_m, and closed range of z hold it. Of several such detections it is the one with the
/// smallest hull (then the lowest index): the hull of a wall round a corner also holds whatever
/// stands in front of the wall. DETECTIONS does not say which points are whose; where hulls
/// overlap, points of the larger one count for the smaller one.
/// Points that are not finite belong to none. O(points x detections).
/// @pre Points and detections are in the same frame; hulls are convex and counter-clockwise.
[[nodiscard]] std::vector<std::optional<std::size_t>> DetectionsOfPoints(
    const core::PointCloud& points,
    std::span<const core::Detection> detections);

/// The points of each detection, as indices, ascending.
[[nodiscard]] std::vector<std::vector<std::size_t>> PointsOfDetections(
    const core::PointCloud& points,
    std::span<const core::Detection> detections);

}  // namespace clearway::evaluate
