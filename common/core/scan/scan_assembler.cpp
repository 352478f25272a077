// SPDX-License-Identifier: BSD-3-Clause
#include "common/core/scan/scan_assembler.hpp"

#include <algorithm>
#include <stdexcept>
#include <utility>

namespace clearway::core {

namespace {

constexpr std::int64_t kMaxUtime = std::int64_t{1} << 60;
constexpr std::int64_t kMaxShots = 1'000'000'000;

bool HasEqualArrays(const PointCloud& cloud) {
  const std::size_t n = cloud.x.size();
  return cloud.y.size() == n && cloud.z.size() == n && cloud.intensity.size() == n &&
         cloud.tag.size() == n && cloud.time_offset_us.size() == n;
}

}  // namespace

bool IsValid(const Slice& slice) {
  return slice.scan_id >= 0 && slice.scan_utime >= 0 && slice.scan_utime <= kMaxUtime &&
         slice.scan_end_utime >= slice.scan_utime && slice.scan_end_utime <= kMaxUtime &&
         slice.scan_end_utime - slice.scan_utime <= kMaxScan_us && slice.slice_count >= 1 &&
         slice.slice_count <= kMaxSlices && slice.slice_index >= 0 &&
         slice.slice_index < slice.slice_count && slice.shots >= 0 && slice.shots <= kMaxShots &&
         slice.zero_returns >= 0 && slice.zero_returns <= kMaxShots &&
         HasEqualArrays(slice.cloud_sensor);
}

ScanAssembler::ScanAssembler(const ScanAssemblerConfig& config, int num_sensors) : config_(config) {
  if (num_sensors < 1) throw std::invalid_argument("ScanAssembler needs at least one sensor");
  trackers_.resize(static_cast<std::size_t>(num_sensors));
  missed_in_row_.resize(static_cast<std::size_t>(num_sensors), 0);
  stream_ids_.resize(static_cast<std::size_t>(num_sensors), kNoId);
}

SliceOutcome ScanAssembler::Add(Slice slice, std::int64_t now_us) {
  const SliceOutcome outcome = Judge(slice, now_us);
  ++counts_[static_cast<std::size_t>(outcome)];
  while (in_flight_.size() > static_cast<std::size_t>(std::max(1, config_.max_in_flight))) {
    EmitFront();
  }
  return outcome;
}

SliceOutcome ScanAssembler::Judge(Slice& slice, std::int64_t now_us) {
  if (slice.sensor < 0 || static_cast<std::size_t>(slice.sensor) >= trackers_.size()) {
    return SliceOutcome::kUnknownSensor;
  }
  if (!IsValid(slice)) return SliceOutcome::kInvalid;
  SequenceTracker& tracker = trackers_[static_cast<std::size_t>(slice.sensor)];
  const std::int64_t session_before = tracker.session();
  std::int64_t& stream_id = stream_ids_[static_cast<std::size_t>(slice.sensor)];
  const SequenceVerdict verdict = tracker.Observe(slice.session, slice.sequence, now_us);
  if (verdict == SequenceVerdict::kInvalid) return SliceOutcome::kInvalid;
  if (verdict == SequenceVerdict::kForeign) return SliceOutcome::kForeign;
  if (slice.session == ended_session_) {
    if (verdict != SequenceVerdict::kRestart) return SliceOutcome::kForeign;
    ended_session_.reset();
  }
  const bool restarts = verdict == SequenceVerdict::kRestart;
  const bool rejoins = restarts && session_before == slice.session;
  const bool in_order = verdict == SequenceVerdict::kNext || verdict == SequenceVerdict::kGap;
  const bool went_back = in_order && slice.scan_id < stream_id;
  if (has_emitted_ && slice.scan_id <= last_id_) {
    const bool new_session = restarts && (rejoins || slice.session != begun_by_session_);
    if (!new_session && !went_back && !Contradicts(slice)) return SliceOutcome::kLate;
    if (restarts && !rejoins) ended_session_ = session_before;
    Restart();
  }
  if (restarts) begun_by_session_ = slice.session;
  if (restarts || in_order || verdict == SequenceVerdict::kFirst) stream_id = slice.scan_id;
  return Store(slice, now_us);
}

bool ScanAssembler::Contradicts(const Slice& slice) const {
  const bool back_in_time = slice.scan_end_utime < last_utime_start_ - config_.restart_us;
  const bool later_than_its_id = slice.scan_utime >= last_utime_end_;
  return back_in_time || later_than_its_id;
}

void ScanAssembler::Restart() {
  while (!in_flight_.empty()) EmitFront();
  has_emitted_ = false;
  std::fill(stream_ids_.begin(), stream_ids_.end(), kNoId);
  ++restarts_;
}

SliceOutcome ScanAssembler::Store(Slice& slice, std::int64_t now_us) {
  const auto pending = FindOrOpen(slice.scan_id);
  Part& part = pending->parts[static_cast<std::size_t>(slice.sensor)];
  const auto index = static_cast<std::size_t>(slice.slice_index);
  PointCloud cloud = std::move(slice.cloud_sensor);
  slice.cloud_sensor = {};
  if (!part.present()) {
    part.head = slice;
    part.clouds.resize(static_cast<std::size_t>(slice.slice_count));
    part.received.resize(static_cast<std::size_t>(slice.slice_count), 0);
  } else if (part.head.session != slice.session || part.head.slice_count != slice.slice_count ||
             part.head.scan_utime != slice.scan_utime ||
             part.head.scan_end_utime != slice.scan_end_utime) {
    return SliceOutcome::kInconsistent;
  } else if (part.received[index] != 0) {
    return SliceOutcome::kDuplicate;
  }
  part.clouds[index] = std::move(cloud);
  part.received[index] = 1;
  ++part.num_received;
  pending->shots += slice.shots;
  pending->zero_returns += slice.zero_returns;
  pending->last_new_us = now_us;
  missed_in_row_[static_cast<std::size_t>(slice.sensor)] = 0;
  if (IsDone(*pending)) {
    for (auto older = in_flight_.begin(); older != pending; ++older) {
      older->due_cap_us = std::min(older->due_cap_us, now_us + config_.grace_us);
    }
  }
  return SliceOutcome::kAccepted;
}

std::deque<ScanAssembler::Pending>::iterator ScanAssembler::FindOrOpen(std::int64_t scan_id) {
  const auto at = std::lower_bound(
      in_flight_.begin(), in_flight_.end(), scan_id, [](const Pending& pending, std::int64_t id) {
        return pending.scan_id < id;
      });
  if (at != in_flight_.end() && at->scan_id == scan_id) return at;
  Pending pending;
  pending.scan_id = scan_id;
  pending.parts.resize(trackers_.size());
  return in_flight_.insert(at, std::move(pending));
}

bool ScanAssembler::IsDone(const Pending& pending) const {
  for (std::size_t s = 0; s < pending.parts.size(); ++s) {
    const Part& part = pending.parts[s];
    const bool is_absent = !part.present() && missed_in_row_[s] >= kAbsentScans;
    if (!part.complete() && !is_absent) return false;
  }
  return true;
}

std::int64_t ScanAssembler::DueAt(const Pending& pending) const {
  return std::min(pending.last_new_us + config_.grace_us, pending.due_cap_us);
}

std::vector<AssembledScan> ScanAssembler::Poll(std::int64_t now_us) {
  while (!in_flight_.empty() &&
         (IsDone(in_flight_.front()) || DueAt(in_flight_.front()) <= now_us)) {
    EmitFront();
  }
  return std::exchange(ready_, {});
}

std::optional<std::int64_t> ScanAssembler::NextDeadline() const {
  if (in_flight_.empty()) return std::nullopt;
  return DueAt(in_flight_.front());
}

void ScanAssembler::EmitFront() {
  AssembledScan scan = Finish(in_flight_.front());
  in_flight_.pop_front();
  for (std::size_t s = 0; s < scan.sensors.size(); ++s) {
    missed_in_row_[s] = scan.sensors[s].present ? 0 : missed_in_row_[s] + 1;
  }
  has_emitted_ = true;
  last_id_ = scan.scan_id;
  last_utime_start_ = scan.utime_start;
  last_utime_end_ = scan.utime_end;
  ready_.push_back(std::move(scan));
}

AssembledScan ScanAssembler::Finish(const Pending& pending) {
  AssembledScan scan;
  scan.scan_id = pending.scan_id;
  scan.shots = pending.shots;
  scan.zero_returns = pending.zero_returns;
  scan.utime_start = kMaxUtime;
  scan.sensors.resize(pending.parts.size());
  for (std::size_t s = 0; s < pending.parts.size(); ++s) {
    const Part& part = pending.parts[s];
    if (!part.present()) {
      scan.missing_sensors.push_back(static_cast<int>(s));
      continue;
    }
    SensorScan& sensor = scan.sensors[s];
    sensor.present = true;
    sensor.utime_start = part.head.scan_utime;
    sensor.utime_end = part.head.scan_end_utime;
    sensor.slice_count = part.head.slice_count;
    sensor.missing_slices = part.head.slice_count - part.num_received;
    for (const PointCloud& cloud : part.clouds) sensor.cloud_sensor.Append(cloud);
    scan.missing_slices += sensor.missing_slices;
    scan.utime_start = std::min(scan.utime_start, sensor.utime_start);
    scan.utime_end = std::max(scan.utime_end, sensor.utime_end);
  }
  scan.complete = scan.missing_slices == 0 && scan.missing_sensors.empty();
  return scan;
}

}  // namespace clearway::core
