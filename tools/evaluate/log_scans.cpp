// SPDX-License-Identifier: BSD-3-Clause
#include "tools/evaluate/log_scans.hpp"

#include <optional>
#include <utility>

#include "common/io/lcm_log.hpp"
#include "common/io/read_error.hpp"
#include "common/messages/channels.hpp"
#include "common/messages/detections.hpp"
#include "common/messages/encoding.hpp"
#include "common/messages/obstacle_points.hpp"
#include "common/messages/pose.hpp"

namespace clearway::evaluate {
namespace {

using messages::channels::kDetections;
using messages::channels::kObstaclePoints;
using messages::channels::kPose;
using messages::channels::kRemovedPoints;

template <typename Message>
std::int64_t TimeOfScan(const Message& slice) {
  return slice.scan_utime;
}

std::int64_t TimeOfScan(const removed_points_t& slice) {
  return slice.utime;
}

// What the map filter did with a scan, besides its OBSTACLE_POINTS.
std::optional<core::PointCloud> RemovedByMap(const std::vector<removed_points_t>& slices) {
  if (slices.empty()) return std::nullopt;
  core::PointCloud removed;
  for (const removed_points_t& slice : slices) {
    for (std::size_t i = 0; i < slice.reason.size(); ++i) {
      if (slice.reason[i] != removed_points_t::REASON_MAP) continue;
      removed.Add({slice.x[i], slice.y[i], slice.z[i]});
    }
  }
  return removed;
}

bool IsFiltered(const obstacle_points_t& slice) {
  return slice.map_state == obstacle_points_t::MAP_FILTERED ||
         slice.map_state == obstacle_points_t::OUTSIDE_MAP;
}

LoggedScan Join(std::int64_t scan_utime,
                const std::vector<obstacle_points_t>& points,
                const std::vector<detections_t>& detections) {
  LoggedScan scan;
  scan.scan_utime = scan_utime;
  scan.utime = points.front().utime;
  scan.is_complete = points.front().scan_state == obstacle_points_t::SCAN_COMPLETE;
  scan.is_filtered = IsFiltered(points.front());
  for (const obstacle_points_t& slice : points) {
    scan.points.Append(messages::FromLcm(slice).cloud_sensor);
  }
  for (const detections_t& slice : detections) {
    for (const detection_t& detection : slice.detections) {
      scan.detections.push_back(messages::FromLcm(detection));
    }
  }
  return scan;
}

// Hands the message to the collector when it is one of `channel`.
template <typename Message>
void AddIfOn(const messages::Channel<Message>& channel,
             const std::string& channel_prefix,
             const io::LogEvent& event,
             ScanCollector& collector) {
  if (event.channel != channel_prefix + channel.name) return;
  std::optional<Message> message = messages::Decode<Message>(event.bytes);
  if (message) {
    collector.Add(*std::move(message));
  } else {
    collector.AddInvalid();
  }
}

}  // namespace

template <typename Message>
bool SliceCollector<Message>::Add(Message slice) {
  if (slice.slice_index < 0 || slice.slice_index >= slice.slice_count) return false;
  Scan& scan = scans_[TimeOfScan(slice)][slice.session];
  if (scan.slices.empty()) scan.slice_count = slice.slice_count;
  if (slice.slice_count != scan.slice_count) return false;
  scan.slices.try_emplace(slice.slice_index, std::move(slice));
  return true;
}

template <typename Message>
std::vector<Message> SliceCollector<Message>::SlicesOf(std::int64_t utime) const {
  std::vector<Message> slices;
  const auto sessions = scans_.find(utime);
  if (sessions == scans_.end()) return slices;
  for (const auto& [session, scan] : sessions->second) {
    if (scan.slices.size() != static_cast<std::size_t>(scan.slice_count)) continue;
    if (!slices.empty()) {
      throw io::ReadError("scan at " + std::to_string(utime) + " us: sessions " +
                          std::to_string(slices.front().session) + " and " +
                          std::to_string(session) + " of one " + Message::getTypeName() +
                          " channel both published it; expected the log of one run");
    }
    for (const auto& [index, slice] : scan.slices) slices.push_back(slice);
  }
  return slices;
}

template class SliceCollector<detections_t>;
template class SliceCollector<obstacle_points_t>;
template class SliceCollector<removed_points_t>;

ScanCollector::ScanCollector(std::function<bool(std::int64_t)> is_wanted)
    : is_wanted_(std::move(is_wanted)) {}

bool ScanCollector::IsWanted(std::int64_t scan_utime) {
  const auto known = wanted_.find(scan_utime);
  if (known != wanted_.end()) return known->second;
  return wanted_.emplace(scan_utime, is_wanted_(scan_utime)).first->second;
}

void ScanCollector::Add(obstacle_points_t slice) {
  if (IsWanted(slice.scan_utime) && !points_.Add(std::move(slice))) ++invalid_messages_;
}

void ScanCollector::Add(detections_t slice) {
  if (IsWanted(slice.scan_utime) && !detections_.Add(std::move(slice))) ++invalid_messages_;
}

void ScanCollector::Add(removed_points_t slice) {
  has_removed_points_ = true;
  if (!removed_.Add(std::move(slice))) ++invalid_messages_;
}

void ScanCollector::Add(const pose_t& pose) {
  const Eigen::Isometry3d T_map_vehicle = messages::T_map_vehicle(pose);
  if (core::IsFinite(T_map_vehicle)) {
    poses_[pose.utime] = T_map_vehicle;
  } else {
    ++invalid_messages_;
  }
}

LoggedScans ScanCollector::Collect() const {
  LoggedScans result;
  result.invalid_messages = invalid_messages_;
  result.has_removed_points = has_removed_points_;
  for (const auto& [utime, pose] : poses_) result.poses.push_back({utime, pose});
  for (const auto& [scan_utime, is_wanted] : wanted_) {
    if (!is_wanted) {
      ++result.not_wanted;
      continue;
    }
    const auto points = points_.SlicesOf(scan_utime);
    const auto detections = detections_.SlicesOf(scan_utime);
    if (points.empty() || detections.empty()) {
      ++result.missing_slices;
    } else {
      result.scans.push_back(Join(scan_utime, points, detections));
      LoggedScan& scan = result.scans.back();
      scan.removed_by_map = RemovedByMap(removed_.SlicesOf(scan.utime));
    }
  }
  return result;
}

LoggedScans ReadLog(const std::filesystem::path& log,
                    const std::string& channel_prefix,
                    std::function<bool(std::int64_t)> is_wanted) {
  ScanCollector collector(std::move(is_wanted));
  io::LcmLogReader reader(log);
  while (const std::optional<io::LogEvent> event = reader.Next()) {
    AddIfOn(kObstaclePoints, channel_prefix, *event, collector);
    AddIfOn(kDetections, channel_prefix, *event, collector);
    AddIfOn(kRemovedPoints, channel_prefix, *event, collector);
    AddIfOn(kPose, channel_prefix, *event, collector);
  }
  return collector.Collect();
}

}  // namespace clearway::evaluate
