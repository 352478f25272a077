// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include <clearway/detections_t.hpp>
#include <clearway/obstacle_points_t.hpp>
#include <clearway/pose_t.hpp>
#include <clearway/removed_points_t.hpp>

#include "common/core/cloud.hpp"
#include "common/core/geometry/pose.hpp"
#include "common/core/perception/detection/detection.hpp"

namespace clearway::evaluate {

/// What the graph made of one scan, in the vehicle frame.
struct LoggedScan {
  std::int64_t scan_utime = 0;  ///< Start of the scan [us since the epoch].
  std::int64_t utime = 0;       ///< End of the scan [us since the epoch].
  bool is_complete = false;     ///< All of LIDAR_POINTS had come.
  bool is_filtered = false;     ///< The map filter had a map and a pose.
  core::PointCloud points;      ///< OBSTACLE_POINTS.
  /// Off the floor, and not in `points` because the map explains them. Nothing when the scan's
  /// REMOVED_POINTS are not there, or not whole.
  std::optional<core::PointCloud> removed_by_map;
  std::vector<core::Detection> detections;
};

/// The scans of a log.
struct LoggedScans {
  std::vector<LoggedScan> scans;     ///< Those that are there whole, in order of time.
  std::size_t missing_slices = 0;    ///< Scans of which DETECTIONS or OBSTACLE_POINTS is not whole.
  std::size_t not_wanted = 0;        ///< Scans that were not asked for, whole or not.
  std::size_t invalid_messages = 0;  ///< Messages that do not decode, or contradict others.
  bool has_removed_points = false;   ///< There is a REMOVED_POINTS message, of whatever scan.
  std::vector<core::StampedPose> poses;  ///< POSE: T_map_vehicle in order of time.
};

/// The slices of one channel, put together scan by scan. Message: detections_t or
/// obstacle_points_t, whose scans go by scan_utime, or removed_points_t, which tells the end of the
/// scan only: those go by utime.
template <typename Message>
class SliceCollector {
 public:
  /// Takes a slice; one that came before is passed over. False when the slice contradicts itself or
  /// those of its scan: its index is not below the count, or the count changed.
  bool Add(Message slice);

  /// All slices of the scan in order; nothing when some are missing. Throws io::ReadError when two
  /// sessions published all of it: two graphs are in the log, and it is not said which one is
  /// meant.
  [[nodiscard]] std::vector<Message> SlicesOf(std::int64_t utime) const;

 private:
  struct Scan {
    std::int32_t slice_count = 0;
    std::map<std::int32_t, Message> slices;  // By index.
  };

  std::map<std::int64_t, std::map<std::int64_t, Scan>> scans_;  // By time, then session.
};

/// Puts the scans of a log together from DETECTIONS, OBSTACLE_POINTS and, where there are any,
/// REMOVED_POINTS. Slices may come in any order and more than once.
class ScanCollector {
 public:
  /// `is_wanted` is asked once for each scan_utime; the other scans are counted only.
  explicit ScanCollector(std::function<bool(std::int64_t scan_utime)> is_wanted);

  void Add(obstacle_points_t slice);
  void Add(detections_t slice);
  void Add(removed_points_t slice);
  /// The last one counts of those with one stamp; a pose that is not finite is an invalid message.
  void Add(const pose_t& pose);
  /// A message that did not decode.
  void AddInvalid() { ++invalid_messages_; }

  /// All scans up to now. Throws io::ReadError; see SliceCollector::SlicesOf().
  [[nodiscard]] LoggedScans Collect() const;

 private:
  bool IsWanted(std::int64_t scan_utime);

  std::function<bool(std::int64_t)> is_wanted_;
  std::map<std::int64_t, bool> wanted_;  // By scan_utime: the answers.
  SliceCollector<obstacle_points_t> points_;
  SliceCollector<detections_t> detections_;
  SliceCollector<removed_points_t> removed_;
  bool has_removed_points_ = false;
  std::map<std::int64_t, Eigen::Isometry3d> poses_;  // By utime.
  std::size_t invalid_messages_ = 0;
};

/// The scans of an LCM log. Memory: that of the wanted ones, of all REMOVED_POINTS and of all POSE.
/// Throws io::ReadError.
[[nodiscard]] LoggedScans ReadLog(const std::filesystem::path& log,
                                  const std::string& channel_prefix,
                                  std::function<bool(std::int64_t scan_utime)> is_wanted);

}  // namespace clearway::evaluate
