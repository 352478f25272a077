// SPDX-License-Identifier: BSD-3-Clause
#include "tools/run_graph/run_statistics.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "common/messages/map_state.hpp"
#include "common/messages/pose.hpp"

namespace clearway::run_graph {
namespace {

constexpr std::size_t kRecentScans = 8;
constexpr std::size_t kMaxWaitingSlices = 10000;

double Milliseconds(std::int64_t us) {
  return static_cast<double>(us) / 1000.0;
}

bool IsStoppedByObstacle(const drive_permit_t& permit) {
  return permit.reason == drive_permit_t::REASON_OBSTACLE && permit.forward_mps <= 0.0;
}

std::optional<double> Mean(double sum, std::size_t count) {
  if (count == 0) return std::nullopt;
  return sum / static_cast<double>(count);
}

}  // namespace

std::optional<Quantiles> QuantilesOf(std::vector<double> values) {
  if (values.empty()) return std::nullopt;
  std::sort(values.begin(), values.end());
  const auto at = [&values](double p) {
    const double rank = std::ceil(p * static_cast<double>(values.size()));
    return values[static_cast<std::size_t>(std::max(rank, 1.0)) - 1];
  };
  return Quantiles{at(0.5), at(0.99)};
}

RunSummary WithoutDurations(RunSummary summary) {
  for (auto& [name, stage] : summary.stages) stage.processing_ms.reset();
  summary.scan_to_detections_ms.reset();
  summary.slice_to_permit_ms.reset();
  return summary;
}

ScanRecord& RunStatistics::Record(ScanKey key) {
  ScanRecord& record = recent_[key];
  if (recent_.size() > kRecentScans && recent_.begin()->first != key) {
    recent_.erase(recent_.begin());
  }
  return record;
}

ScanRecord* RunStatistics::RecordThatEnds(std::int64_t end_utime) {
  const auto found = std::find_if(recent_.begin(), recent_.end(), [&](const auto& record) {
    return plot::StampsOf(record.second).end_utime == end_utime;
  });
  return found == recent_.end() ? nullptr : &found->second;
}

bool RunStatistics::IsWhole(const Arrivals& arrivals) {
  return std::all_of(arrivals.by_sensor.begin(), arrivals.by_sensor.end(), [](const auto& sensor) {
    return static_cast<std::int64_t>(sensor.second.seen.size()) == sensor.second.count;
  });
}

void RunStatistics::OnLidarPoints(const lidar_points_t& message, std::int64_t arrival_us) {
  last_input_us_ = arrival_us;
  Arrivals& arrivals = arrivals_[message.scan_utime];
  arrivals.last_slice_us = arrival_us;
  SensorSlices& slices = arrivals.by_sensor[message.sensor];
  slices.seen.insert(message.slice_index);
  slices.count = message.slice_count;
  if (IsWhole(arrivals)) {
    played_.insert(message.scan_utime);
  } else {
    played_.erase(message.scan_utime);
  }
  waiting_.push_back(
      {message.sensor, message.scan_id, message.slice_index, message.scan_utime, arrival_us});
  if (waiting_.size() > kMaxWaitingSlices) waiting_.pop_front();
  Record(message.scan_utime).Add(message);
}

void RunStatistics::OnObstaclePoints(const obstacle_points_t& message) {
  Record(message.scan_utime).Add(message);
  if (message.slice_index != 0) return;
  ++obstacle_scans_;
  processing_ms_["preprocessor"].push_back(Milliseconds(message.processing_us));
  sum_in_ += message.points_in;
  sum_voxel_ += message.points_voxel;
  sum_floor_ += message.points_floor;
  if (message.map_state != obstacle_points_t::MAP_OFF) ++map_scans_;
  if (messages::IsFiltered(message.map_state)) {
    ++mapped_scans_;
    sum_map_ += message.points_map;
  }
  if (message.map_state != obstacle_points_t::MAP_OFF &&
      message.map_state != obstacle_points_t::MAP_FILTERED) {
    map_trouble_ = messages::MapStateInWords(message.map_state);
  }
}

void RunStatistics::OnRemovedPoints(const removed_points_t& message) {
  if (ScanRecord* const record = RecordThatEnds(message.utime)) record->Add(message);
}

void RunStatistics::OnFloor(const floor_t& message) {
  if (ScanRecord* const record = RecordThatEnds(message.utime)) record->Add(message);
}

void RunStatistics::OnPose(const pose_t& message) {
  poses_.Add(message.utime, messages::T_map_vehicle(message));
}

void RunStatistics::OnDetections(const detections_t& message, std::int64_t arrival_us) {
  const ScanKey key = message.scan_utime;
  ScanRecord& record = Record(key);
  record.Add(message);
  // The pose that the preprocessor had, or a better one: this comes after the scan's end.
  if (!record.T_map_vehicle) record.T_map_vehicle = poses_.Lookup(message.utime);
  if (message.slice_index == 0) {
    processing_ms_["clusterer"].push_back(Milliseconds(message.processing_us));
    if (message.scan_state == detections_t::SCAN_INCOMPLETE) ++incomplete_;
  }
  DetectionSlices& slices = detection_slices_[key];
  slices.detections += message.n;
  if (++slices.count != message.slice_count) return;
  detected_.insert(key);
  sum_detections_ += static_cast<double>(slices.detections);
  last_detected_ = key;
  const auto arrivals = arrivals_.find(key);
  if (arrivals == arrivals_.end()) return;
  scan_to_detections_ms_.push_back(Milliseconds(arrival_us - arrivals->second.last_slice_us));
}

void RunStatistics::OnDrivePermit(const drive_permit_t& message, std::int64_t arrival_us) {
  const bool is_new = !last_permit_ || last_permit_->slice_sensor != message.slice_sensor ||
                      last_permit_->slice_scan_id != message.slice_scan_id ||
                      last_permit_->slice_index != message.slice_index;
  const bool was_stopped = last_permit_ && IsStoppedByObstacle(*last_permit_);
  if (!was_stopped && IsStoppedByObstacle(message)) ++obstacle_stops_;
  last_permit_ = message;
  if (!is_new || message.slice_scan_id < 0) return;
  processing_ms_["stop_guard"].push_back(Milliseconds(message.processing_us));
  // The permit answers this slice and all that came before it.
  const auto answered =
      std::find_if(waiting_.begin(), waiting_.end(), [&message](const WaitingSlice& slice) {
        return slice.sensor == message.slice_sensor && slice.scan_id == message.slice_scan_id &&
               slice.slice_index == message.slice_index;
      });
  if (answered == waiting_.end()) return;
  guarded_scans_.insert(answered->scan);
  const auto record = recent_.find(answered->scan);
  if (record != recent_.end()) record->second.Add(message);
  for (auto slice = waiting_.begin(); slice != std::next(answered); ++slice) {
    slice_to_permit_ms_.push_back(Milliseconds(arrival_us - slice->arrival_us));
  }
  waiting_.erase(waiting_.begin(), std::next(answered));
}

void RunStatistics::OnStatus(const status_t& message) {
  missing_[{message.process, message.session}] = message.missing;
  statuses_[message.process] = message;
}

const ScanRecord* RunStatistics::LastDetectedScan() const {
  if (!last_detected_) return nullptr;
  const auto found = recent_.find(*last_detected_);
  return found == recent_.end() ? nullptr : &found->second;
}

const status_t* RunStatistics::StatusOf(const std::string& process) const {
  const auto found = statuses_.find(process);
  return found == statuses_.end() ? nullptr : &found->second;
}

std::optional<DriveSummary> RunStatistics::SummariseDrive() const {
  const status_t* const status = StatusOf("simulator");
  if (status == nullptr) return std::nullopt;
  DriveSummary drive;
  drive.obstacle_stops = obstacle_stops_;
  for (const counter_t& counter : status->counters) {
    const double metres = static_cast<double>(counter.value) / 1000.0;
    if (counter.name == "driven_mm") drive.driven_m = metres;
    if (counter.name == "nearest_mm" && counter.value >= 0) drive.nearest_m = metres;
    if (counter.name == "contacts") drive.contacts = counter.value;
  }
  return drive;
}

RunSummary RunStatistics::Summarise() const {
  RunSummary summary;
  summary.scans_played = played_.size();
  summary.scans_detected = static_cast<std::size_t>(std::count_if(
      detected_.begin(), detected_.end(), [this](ScanKey key) { return played_.contains(key); }));
  summary.scans_incomplete = incomplete_;
  constexpr std::int64_t kMost = std::numeric_limits<std::int64_t>::max();
  for (const auto& [process, missing] : missing_) {
    summary.messages_lost =
        missing > kMost - summary.messages_lost ? kMost : summary.messages_lost + missing;
  }
  for (const auto& [process, times] : processing_ms_) {
    const std::size_t scans = process == "stop_guard" ? guarded_scans_.size() : times.size();
    summary.stages[process] = {scans, QuantilesOf(times)};
  }
  summary.points_in = Mean(sum_in_, obstacle_scans_);
  summary.points_voxel = Mean(sum_voxel_, obstacle_scans_);
  summary.points_floor = Mean(sum_floor_, obstacle_scans_);
  summary.points_map = Mean(sum_map_, mapped_scans_);
  summary.map_scans = map_scans_;
  summary.map_filtered = mapped_scans_;
  summary.map_trouble = map_trouble_;
  summary.detections = Mean(sum_detections_, detected_.size());
  summary.scan_to_detections_ms = QuantilesOf(scan_to_detections_ms_);
  summary.slice_to_permit_ms = QuantilesOf(slice_to_permit_ms_);
  summary.drive = SummariseDrive();
  return summary;
}

}  // namespace clearway::run_graph
