// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include <Eigen/Geometry>
#include <clearway/detections_t.hpp>
#include <clearway/drive_permit_t.hpp>
#include <clearway/floor_t.hpp>
#include <clearway/lidar_points_t.hpp>
#include <clearway/obstacle_points_t.hpp>
#include <clearway/removed_points_t.hpp>

namespace clearway::plot {

/// The messages of one scan, as far as they came. Whoever fills it knows which scan a message
/// belongs to.
struct ScanMessages {
  std::vector<lidar_points_t> raw;  ///< Of all sensors.
  std::vector<obstacle_points_t> obstacles;
  std::vector<removed_points_t> removed;
  std::vector<detections_t> detections;
  std::optional<floor_t> floor;
  std::optional<drive_permit_t> permit;
  std::optional<Eigen::Isometry3d> T_map_vehicle;  ///< At the end of the scan; nothing: no POSE.
  std::size_t refused = 0;  ///< Slices that came twice, or from a second publisher.

  /// Each slice is taken once, and from the publisher (the session) that came first. O(slices).
  void Add(const lidar_points_t& slice);
  void Add(const obstacle_points_t& slice);
  void Add(const removed_points_t& slice);
  void Add(const detections_t& slice);
  void Add(const floor_t& message) { floor = message; }

  /// Of the permits that answer a slice of the scan the last one stays, but not those that repeat
  /// the answer to the same slice: they tell of what came later.
  void Add(const drive_permit_t& message);
};

/// What the slices of a scan say about it.
struct ScanStamps {
  std::optional<std::int64_t> scan_id;
  std::optional<std::int64_t> start_utime;  ///< [us since the epoch]
  std::optional<std::int64_t> end_utime;
};
[[nodiscard]] ScanStamps StampsOf(const ScanMessages& scan);

}  // namespace clearway::plot
