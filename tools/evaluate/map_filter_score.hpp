// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include <Eigen/Geometry>

#include "common/core/cloud.hpp"
#include "common/core/geometry/pose.hpp"
#include "common/core/geometry/pose_buffer.hpp"
#include "tools/evaluate/box.hpp"
#include "tools/evaluate/log_scans.hpp"

namespace clearway::evaluate {

/// What the map filter had, and what of it it took out.
struct RemovedShare {
  std::size_t points = 0;
  std::size_t removed = 0;

  RemovedShare& operator+=(const RemovedShare& other);
  /// removed / points; nothing of no points.
  [[nodiscard]] std::optional<double> Value() const;
};

/// How the map filter is judged.
struct MapFilterRules {
  double tolerance_m = 0.1;      ///< Boxes are grown by this much on each side.
  double z_min_m = 0.0;          ///< Lower points the filter always keeps; frame vehicle.
  double z_max_m = 0.0;          ///< Higher points the filter always keeps; frame vehicle.
  std::int64_t min_points = 10;  ///< Boxes with fewer returns are no objects.
};

/// The map filter on one scan, or on many. Points are voxels off the floor, above and below it.
/// Static points lie outside every box, grown: walls and furniture, and whatever moves and is not
/// labelled. Object points lie inside a box that counts, not grown. Points between the two, and
/// those in boxes that do not count, are neither.
/// A box is taken as it is labelled. Where labels have a nominal size and an arbitrary yaw, limbs
/// that reach out of the grown box count as static: kept ones lower the removal, removed ones are
/// not noticed as swallowed. A wall or a chair that reaches into the box counts as object: removed,
/// it looks swallowed.
struct MapFilterCounts {
  RemovedShare statics;          ///< To be taken out.
  RemovedShare statics_in_band;  ///< Of them, between z_min_m and z_max_m, both included.
  RemovedShare objects;          ///< Never to be taken out.

  MapFilterCounts& operator+=(const MapFilterCounts& other);
};

/// Counts one scan. All in the vehicle frame. O(points x boxes).
[[nodiscard]] MapFilterCounts CountMapFilter(const core::PointCloud& kept,
                                             const core::PointCloud& removed_by_map,
                                             std::span<const Box> boxes,
                                             const MapFilterRules& rules);

/// From one pose of the vehicle to another, seen from above.
struct PoseDifference {
  double distance_m = 0.0;
  double turn_rad = 0.0;  ///< 0 .. pi
};

[[nodiscard]] PoseDifference Difference(const Eigen::Isometry3d& T_map_a,
                                        const Eigen::Isometry3d& T_map_b);

/// The map filter on the scans of a log, and the scans that say nothing about it. Those that say
/// something are complete, were filtered, and their REMOVED_POINTS are there whole.
struct MapFilterSummary {
  std::size_t scans = 0;
  std::size_t scans_incomplete = 0;               ///< Slices of LIDAR_POINTS were missing.
  std::size_t scans_not_filtered = 0;             ///< Complete, but no map or no pose for them.
  std::size_t scans_missing_removed = 0;          ///< Filtered, but REMOVED_POINTS not whole.
  MapFilterCounts counts = {};                    ///< Of `scans`.
  std::optional<PoseDifference> pose_error = {};  ///< Means over those of `scans` that have a POSE.

  /// Static points that survive, per scan; nothing without scans.
  [[nodiscard]] std::optional<double> LeakedPerScan() const;
};

/// Adds up scan by scan.
class MapFilterScorer {
 public:
  /// `poses`: POSE of the whole log in order of time, read as the filter reads them (`pose`).
  /// Without a reference pose there is no pose error.
  MapFilterScorer(const MapFilterRules& rules,
                  const core::PoseBufferConfig& pose,
                  std::vector<core::StampedPose> poses,
                  std::optional<Eigen::Isometry3d> T_map_reference);

  /// `boxes_vehicle`: those of this scan.
  void Add(const LoggedScan& scan, std::span<const Box> boxes_vehicle);

  [[nodiscard]] MapFilterSummary Summarise() const;

 private:
  [[nodiscard]] std::optional<Eigen::Isometry3d> PoseAt(std::int64_t utime) const;

  MapFilterRules rules_;
  core::PoseBufferConfig pose_config_;
  std::vector<core::StampedPose> poses_;
  std::optional<Eigen::Isometry3d> T_map_reference_;
  MapFilterSummary summary_;
  std::size_t scans_with_pose_ = 0;
  PoseDifference sum_;  // Over scans_with_pose_.
};

}  // namespace clearway::evaluate
