// SPDX-License-Identifier: BSD-3-Clause
#include "tools/plot/scan_messages.hpp"

#include <algorithm>

#include "common/core/scan/scan_assembler.hpp"

namespace clearway::plot {
namespace {

// Slices of one source: of a channel, or of one sensor on it.
template <typename Message, typename IsSameSource>
bool AddSlice(const Message& slice, IsSameSource is_same_source, std::vector<Message>& slices) {
  if (slices.size() >= static_cast<std::size_t>(core::kMaxSlices)) return false;
  const bool is_refused = std::any_of(slices.begin(), slices.end(), [&](const Message& other) {
    return is_same_source(other) &&
           (other.session != slice.session || other.slice_index == slice.slice_index);
  });
  if (!is_refused) slices.push_back(slice);
  return !is_refused;
}

template <typename Message>
bool AddSlice(const Message& slice, std::vector<Message>& slices) {
  return AddSlice(
      slice, [](const Message&) { return true; }, slices);
}

}  // namespace

void ScanMessages::Add(const lidar_points_t& slice) {
  const auto is_same_sensor = [&](const lidar_points_t& other) {
    return other.sensor == slice.sensor;
  };
  if (!AddSlice(slice, is_same_sensor, raw)) ++refused;
}

void ScanMessages::Add(const obstacle_points_t& slice) {
  if (!AddSlice(slice, obstacles)) ++refused;
}

void ScanMessages::Add(const removed_points_t& slice) {
  if (!AddSlice(slice, removed)) ++refused;
}

void ScanMessages::Add(const detections_t& slice) {
  if (!AddSlice(slice, detections)) ++refused;
}

void ScanMessages::Add(const drive_permit_t& message) {
  const bool is_repetition = permit && permit->slice_sensor == message.slice_sensor &&
                             permit->slice_index == message.slice_index;
  if (!is_repetition) permit = message;
}

ScanStamps StampsOf(const ScanMessages& scan) {
  if (!scan.raw.empty()) {
    const lidar_points_t& slice = scan.raw.front();
    return {slice.scan_id, slice.scan_utime, slice.scan_end_utime};
  }
  if (!scan.obstacles.empty()) {
    const obstacle_points_t& slice = scan.obstacles.front();
    return {slice.scan_id, slice.scan_utime, slice.utime};
  }
  if (!scan.detections.empty()) {
    const detections_t& slice = scan.detections.front();
    return {slice.scan_id, slice.scan_utime, slice.utime};
  }
  if (!scan.removed.empty()) {
    return {scan.removed.front().scan_id, std::nullopt, scan.removed.front().utime};
  }
  if (scan.floor) return {scan.floor->scan_id, std::nullopt, scan.floor->utime};
  return {};
}

}  // namespace clearway::plot
