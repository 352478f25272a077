// SPDX-License-Identifier: BSD-3-Clause
#include "tools/evaluate/map_filter_score.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace clearway::evaluate {
namespace {

bool IsInAny(std::span<const Box> boxes, const Eigen::Vector3d& point, double margin_m) {
  return std::any_of(
      boxes.begin(), boxes.end(), [&](const Box& box) { return Contains(box, point, margin_m); });
}

bool IsInObject(std::span<const Box> boxes, const Eigen::Vector3d& point, std::int64_t min_points) {
  return std::any_of(boxes.begin(), boxes.end(), [&](const Box& box) {
    return box.points >= min_points && Contains(box, point, 0.0);
  });
}

// The points of one fate: all removed, or all kept.
MapFilterCounts CountPoints(const core::PointCloud& cloud,
                            bool is_removed,
                            std::span<const Box> boxes,
                            const MapFilterRules& rules) {
  MapFilterCounts counts;
  const auto count = [is_removed](RemovedShare& share) {
    ++share.points;
    if (is_removed) ++share.removed;
  };
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    const Eigen::Vector3d point = cloud.Point(i).cast<double>();
    if (!IsInAny(boxes, point, rules.tolerance_m)) {
      count(counts.statics);
      if (point.z() >= rules.z_min_m && point.z() <= rules.z_max_m) count(counts.statics_in_band);
    } else if (IsInObject(boxes, point, rules.min_points)) {
      count(counts.objects);
    }
  }
  return counts;
}

double Yaw(const Eigen::Isometry3d& pose) {
  return std::atan2(pose.linear()(1, 0), pose.linear()(0, 0));
}

}  // namespace

RemovedShare& RemovedShare::operator+=(const RemovedShare& other) {
  points += other.points;
  removed += other.removed;
  return *this;
}

std::optional<double> RemovedShare::Value() const {
  if (points == 0) return std::nullopt;
  return static_cast<double>(removed) / static_cast<double>(points);
}

MapFilterCounts& MapFilterCounts::operator+=(const MapFilterCounts& other) {
  statics += other.statics;
  statics_in_band += other.statics_in_band;
  objects += other.objects;
  return *this;
}

MapFilterCounts CountMapFilter(const core::PointCloud& kept,
                               const core::PointCloud& removed_by_map,
                               std::span<const Box> boxes,
                               const MapFilterRules& rules) {
  MapFilterCounts counts = CountPoints(kept, false, boxes, rules);
  counts += CountPoints(removed_by_map, true, boxes, rules);
  return counts;
}

PoseDifference Difference(const Eigen::Isometry3d& T_map_a, const Eigen::Isometry3d& T_map_b) {
  const Eigen::Vector3d offset = T_map_b.translation() - T_map_a.translation();
  return {.distance_m = offset.head<2>().norm(),
          .turn_rad = std::abs(std::remainder(Yaw(T_map_b) - Yaw(T_map_a), 2.0 * M_PI))};
}

std::optional<double> MapFilterSummary::LeakedPerScan() const {
  if (scans == 0) return std::nullopt;
  return static_cast<double>(counts.statics.points - counts.statics.removed) /
         static_cast<double>(scans);
}

MapFilterScorer::MapFilterScorer(const MapFilterRules& rules,
                                 const core::PoseBufferConfig& pose,
                                 std::vector<core::StampedPose> poses,
                                 std::optional<Eigen::Isometry3d> T_map_reference)
    : rules_(rules),
      pose_config_(pose),
      poses_(std::move(poses)),
      T_map_reference_(std::move(T_map_reference)) {}

void MapFilterScorer::Add(const LoggedScan& scan, std::span<const Box> boxes_vehicle) {
  if (!scan.is_complete) {
    ++summary_.scans_incomplete;
  } else if (!scan.is_filtered) {
    ++summary_.scans_not_filtered;
  } else if (!scan.removed_by_map) {
    ++summary_.scans_missing_removed;
  } else {
    ++summary_.scans;
    summary_.counts += CountMapFilter(scan.points, *scan.removed_by_map, boxes_vehicle, rules_);
    const auto T_map_vehicle = T_map_reference_ ? PoseAt(scan.utime) : std::nullopt;
    if (!T_map_vehicle) return;
    const PoseDifference error = Difference(*T_map_reference_, *T_map_vehicle);
    ++scans_with_pose_;
    sum_.distance_m += error.distance_m;
    sum_.turn_rad += error.turn_rad;
  }
}

MapFilterSummary MapFilterScorer::Summarise() const {
  MapFilterSummary summary = summary_;
  if (scans_with_pose_ == 0) return summary;
  const auto scans = static_cast<double>(scans_with_pose_);
  summary.pose_error = {.distance_m = sum_.distance_m / scans, .turn_rad = sum_.turn_rad / scans};
  return summary;
}

// Of the filter's own kind of buffer, filled with what it can need for this time.
std::optional<Eigen::Isometry3d> MapFilterScorer::PoseAt(std::int64_t utime) const {
  const std::int64_t reach_us = pose_config_.max_gap_us + pose_config_.max_extrapolation_us;
  const auto is_before = [](const core::StampedPose& pose, std::int64_t time) {
    return pose.utime < time;
  };
  core::PoseBuffer buffer(pose_config_);
  auto pose = std::lower_bound(poses_.begin(), poses_.end(), utime - reach_us, is_before);
  for (; pose != poses_.end(); ++pose) {
    buffer.Add(pose->utime, pose->T_fixed_vehicle);
    if (pose->utime >= utime) break;
  }
  return buffer.Lookup(utime);
}

}  // namespace clearway::evaluate
