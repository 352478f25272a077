// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "common/core/cloud.hpp"
#include "common/core/perception/detection/detection.hpp"
#include "tools/evaluate/box.hpp"

namespace clearway::evaluate {

/// Objects farther away than this are left out [m].
inline constexpr double kMaxRange_m = 60.0;
/// A detection stands for a box when at least this share of its points lies in it.
inline constexpr double kSeparatedShare = 0.5;
/// A detection merges two boxes when at least this share of its points lies in each of them.
inline constexpr double kMergedShare = 0.1;

/// What counts as found.
struct ScoreRules {
  std::int64_t min_points = 10;  ///< Boxes with fewer returns are left out, and counted.
  double radius_m = 0.3;         ///< A centroid this near to a box's centre finds it.
  double tolerance_m = 0.1;      ///< Boxes are grown by this much on each side.
};

/// One scan with its truth; all in the vehicle frame, at the same time.
struct Scene {
  core::PointCloud points;                  ///< Obstacle points that were clustered.
  std::vector<core::Detection> detections;  ///< What was made of them.
  std::vector<Box> boxes;                   ///< What was there; not everything is labelled.
};

/// How one labelled object came out. The match is the detection with the most points in the grown
/// box (then the lowest index).
struct ObjectScore {
  double range_m = 0.0;        ///< From the origin to the box's centre, horizontally.
  bool any_evidence = false;   ///< A detection has a point in the box.
  bool separated = false;      ///< kSeparatedShare of the match's points lie in the box.
  bool within_radius = false;  ///< A detection's centroid is near the box's centre, horizontally.
  std::size_t splits = 0;      ///< Other detections with kSeparatedShare of their points in it.

  // Of the match; nothing without one.
  std::optional<double> centre_error_m;   ///< From its centroid to the box's centre, horizontally.
  std::optional<double> nearest_error_m;  ///< Between its nearest point's distance and the box's.
  std::optional<double> yaw_error_rad;    ///< Modulo a quarter turn; cars, vans and trucks only.
};

/// How one scan came out.
struct SceneScore {
  std::vector<ObjectScore> objects;  ///< Of the boxes that count, in their order.
  std::size_t detections = 0;        ///< All of them, labelled or not.
  std::size_t merges = 0;            ///< Detections with kMergedShare of their points in each of
                                     ///< two or more boxes that count.
  std::size_t few_points = 0;        ///< Boxes with fewer points than the rules ask for.
  std::size_t out_of_range = 0;      ///< Other boxes at or beyond kMaxRange_m.
};

/// Scores one scan. Which point is whose: see DetectionsOfPoints(); a detection without points
/// there has no share in anything, but its centroid may find a box. Labels cover some objects only,
/// so detections without a box are not held against anybody. A point in the overlap of two grown
/// boxes is in both. Pure. O(points x (detections + boxes)).
/// Source: any evidence and separation as in class-agnostic LiDAR instance benchmarks.
[[nodiscard]] SceneScore ScoreScene(const Scene& scene, const ScoreRules& rules);

}  // namespace clearway::evaluate
