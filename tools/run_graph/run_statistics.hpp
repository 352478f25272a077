// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <map>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include <clearway/detections_t.hpp>
#include <clearway/drive_permit_t.hpp>
#include <clearway/floor_t.hpp>
#include <clearway/lidar_points_t.hpp>
#include <clearway/map_tile_t.hpp>
#include <clearway/obstacle_points_t.hpp>
#include <clearway/pose_t.hpp>
#include <clearway/removed_points_t.hpp>
#include <clearway/status_t.hpp>

#include "common/core/geometry/pose_buffer.hpp"
#include "tools/plot/map_collector.hpp"
#include "tools/plot/scan_messages.hpp"

namespace clearway::run_graph {

/// Median and 99th percentile of a list; nothing for an empty one. The p-quantile of n values is
/// the one at rank ceil(p n).
struct Quantiles {
  double median = 0.0;
  double p99 = 0.0;
};
[[nodiscard]] std::optional<Quantiles> QuantilesOf(std::vector<double> values);

/// The messages of one scan, as far as they came.
using ScanRecord = plot::ScanMessages;

/// One process over the whole run.
struct StageSummary {
  std::size_t scans = 0;
  std::optional<Quantiles> processing_ms;
};

/// What a simulated robot did, as the simulator tells and as it was permitted.
struct DriveSummary {
  double driven_m = 0.0;
  std::optional<double> nearest_m;  ///< Least distance of its footprint from anything.
  std::int64_t contacts = 0;
  std::size_t obstacle_stops = 0;  ///< Times that an obstacle took the permit to drive on.
};

/// What a run came to. What was not measured is absent.
struct RunSummary {
  std::size_t scans_played = 0;      ///< Scans of which every slice of every sensor was seen.
  std::size_t scans_detected = 0;    ///< Of them, with all of their DETECTIONS.
  std::size_t scans_incomplete = 0;  ///< DETECTIONS that say that points were missing.
  std::int64_t messages_lost = 0;    ///< Gaps that the processes of the graph counted.
  std::map<std::string, StageSummary> stages;
  std::optional<double> points_in;  ///< Means per scan.
  std::optional<double> points_voxel;
  std::optional<double> points_floor;
  std::optional<double> points_map;  ///< Only of scans that were filtered.
  std::size_t map_scans = 0;         ///< Scans for which the map filter was on...
  std::size_t map_filtered = 0;      ///< ...and something could be filtered.
  std::string map_trouble;           ///< The newest reason why not; empty: none.
  std::optional<double> detections;
  std::optional<Quantiles> scan_to_detections_ms;
  std::optional<Quantiles> slice_to_permit_ms;
  std::optional<DriveSummary> drive;
};

/// In virtual time handlers take none: what would be a duration says nothing, and is left out.
[[nodiscard]] RunSummary WithoutDurations(RunSummary summary);

/// Listens to all messages of a graph and sums up. Arrival times are on one monotonic clock.
class RunStatistics {
 public:
  void OnLidarPoints(const lidar_points_t& message, std::int64_t arrival_us);
  void OnObstaclePoints(const obstacle_points_t& message);
  void OnRemovedPoints(const removed_points_t& message);
  void OnFloor(const floor_t& message);
  void OnPose(const pose_t& message);
  void OnMap(const map_tile_t& message) { map_.Add(message); }
  void OnDetections(const detections_t& message, std::int64_t arrival_us);
  void OnDrivePermit(const drive_permit_t& message, std::int64_t arrival_us);
  void OnStatus(const status_t& message);

  /// The same by the channel's name, without prefix; other channels, and what cannot be decoded,
  /// are left out.
  void OnMessage(const std::string& channel,
                 std::span<const std::byte> bytes,
                 std::int64_t arrival_us);

  [[nodiscard]] RunSummary Summarise() const;

  /// The newest scan with DETECTIONS, for a picture; nothing when there was none.
  [[nodiscard]] const ScanRecord* LastDetectedScan() const;

  /// The static map, as far as it came.
  [[nodiscard]] plot::CollectedMap map() const { return map_.Get(); }
  [[nodiscard]] const std::optional<drive_permit_t>& last_permit() const { return last_permit_; }

  /// The newest status of a process; null when there was none.
  [[nodiscard]] const status_t* StatusOf(const std::string& process) const;

  /// Number of scans with DETECTIONS, and of those seen on LIDAR_POINTS.
  [[nodiscard]] std::size_t num_detected() const { return detected_.size(); }
  [[nodiscard]] std::size_t num_played() const { return played_.size(); }

  /// When the last LIDAR_POINTS came; nothing before the first.
  [[nodiscard]] std::optional<std::int64_t> last_input_us() const { return last_input_us_; }

 private:
  // A sender that starts anew counts its scans from 0 again: a scan is known by its stamp.
  using ScanKey = std::int64_t;
  struct SensorSlices {
    std::set<std::int32_t> seen;
    std::int32_t count = 0;  // Of the whole scan.
  };
  struct Arrivals {
    std::map<std::string, SensorSlices> by_sensor;
    std::int64_t last_slice_us = 0;
  };
  struct WaitingSlice {
    std::string sensor;
    std::int64_t scan_id;
    std::int32_t slice_index;
    ScanKey scan;
    std::int64_t arrival_us;
  };

  struct DetectionSlices {
    int count = 0;
    std::int64_t detections = 0;
  };

  [[nodiscard]] static bool IsWhole(const Arrivals& arrivals);
  ScanRecord& Record(ScanKey key);
  ScanRecord* RecordThatEnds(std::int64_t end_utime);

  [[nodiscard]] std::optional<DriveSummary> SummariseDrive() const;

  std::map<ScanKey, Arrivals> arrivals_;
  std::map<ScanKey, ScanRecord> recent_;
  std::map<ScanKey, DetectionSlices> detection_slices_;
  std::set<ScanKey> played_;
  std::set<ScanKey> detected_;
  std::set<ScanKey> guarded_scans_;
  std::optional<ScanKey> last_detected_;
  std::deque<WaitingSlice> waiting_;
  std::map<std::string, status_t> statuses_;
  std::map<std::pair<std::string, std::int64_t>, std::int64_t> missing_;  // By process and session.
  std::map<std::string, std::vector<double>> processing_ms_;
  std::vector<double> scan_to_detections_ms_;
  std::vector<double> slice_to_permit_ms_;
  std::size_t obstacle_scans_ = 0;
  std::size_t obstacle_stops_ = 0;
  std::size_t map_scans_ = 0;
  std::size_t mapped_scans_ = 0;
  std::string map_trouble_;
  std::size_t incomplete_ = 0;
  double sum_in_ = 0.0;
  double sum_voxel_ = 0.0;
  double sum_floor_ = 0.0;
  double sum_map_ = 0.0;
  double sum_detections_ = 0.0;
  core::PoseBuffer poses_;
  plot::MapCollector map_;
  std::optional<drive_permit_t> last_permit_;
  std::optional<std::int64_t> last_input_us_;
};

}  // namespace clearway::run_graph
