// SPDX-License-Identifier: BSD-3-Clause
#include "common/messages/obstacle_points.hpp"

#include <algorithm>

namespace clearway::messages {
namespace {

constexpr std::size_t kHeaderBytes = 256;
constexpr std::size_t kBytesPerPoint = 3 * sizeof(float) + 2;

std::int32_t Int32(std::size_t value) {
  return static_cast<std::int32_t>(value);
}

// All that the slices of a scan have in common.
obstacle_points_t HeaderOf(const core::PreprocessedScan& scan, std::int64_t processing_us) {
  const core::PointCounts& counts = scan.counts;
  obstacle_points_t message{};
  message.utime = scan.utime;
  message.scan_id = scan.scan_id;
  message.scan_utime = scan.utime_start;
  message.scan_state =
      scan.complete ? obstacle_points_t::SCAN_COMPLETE : obstacle_points_t::SCAN_INCOMPLETE;
  message.missing_slices = scan.missing_slices;
  message.motion_state = static_cast<std::int8_t>(scan.deskew);
  message.floor_state = static_cast<std::int8_t>(scan.floor.state);
  message.map_state = static_cast<std::int8_t>(scan.map_state);
  message.map_epoch = scan.map_version.epoch;
  message.points_in = Int32(counts.in - counts.zero);
  message.points_masked = Int32(counts.in - counts.zero - counts.kept);
  message.points_voxel = Int32(counts.voxels);
  message.points_floor = Int32(counts.above + counts.below);
  message.points_map = message.points_floor - Int32(counts.OfMap(core::MapVerdict::kExplained));
  message.processing_us = static_cast<std::int32_t>(processing_us);
  return message;
}

template <typename T>
std::vector<T> Part(const std::vector<T>& all, std::size_t first, std::size_t last) {
  return {all.begin() + static_cast<std::ptrdiff_t>(first),
          all.begin() + static_cast<std::ptrdiff_t>(last)};
}

}  // namespace

std::vector<obstacle_points_t> ToObstaclePoints(const core::PreprocessedScan& scan,
                                                std::int64_t processing_us,
                                                std::size_t max_message_bytes) {
  const core::PointCloud& cloud = scan.obstacles_vehicle;
  const std::size_t capacity = (max_message_bytes - kHeaderBytes) / kBytesPerPoint;
  const std::size_t count = std::max<std::size_t>(1, (cloud.size() + capacity - 1) / capacity);
  std::vector<obstacle_points_t> slices(count, HeaderOf(scan, processing_us));
  for (std::size_t k = 0; k < count; ++k) {
    const std::size_t first = cloud.size() * k / count;
    const std::size_t last = cloud.size() * (k + 1) / count;
    obstacle_points_t& slice = slices[k];
    slice.slice_index = Int32(k);
    slice.slice_count = Int32(count);
    slice.n = Int32(last - first);
    slice.x = Part(cloud.x, first, last);
    slice.y = Part(cloud.y, first, last);
    slice.z = Part(cloud.z, first, last);
    slice.intensity = Part(cloud.intensity, first, last);
    slice.flags = Part(scan.flags, first, last);
  }
  return slices;
}

floor_t ToFloor(const core::PreprocessedScan& scan) {
  const core::FloorEstimate& floor = scan.floor;
  floor_t message{};
  message.utime = scan.utime;
  message.scan_id = scan.scan_id;
  message.state = static_cast<std::int8_t>(floor.state);
  for (int i = 0; i < 3; ++i) {
    message.normal[i] = static_cast<double>(floor.fit.plane_vehicle.normal[i]);
  }
  message.offset_m = static_cast<double>(floor.fit.plane_vehicle.offset_m);
  message.tilt_rad = floor.fit.tilt_rad;
  message.age_us = floor.age_us;
  message.inliers = Int32(floor.fit.num_inliers);
  message.candidates = Int32(floor.fit.num_candidates);
  message.rms_m = floor.state == core::FloorState::kConfigured ? -1.0 : floor.fit.rms_m;
  message.below_points = Int32(scan.counts.below);
  return message;
}

std::vector<removed_points_t> ToRemovedPoints(const core::PreprocessedScan& scan,
                                              std::size_t max_message_bytes) {
  const core::PointCloud& cloud = scan.removed_vehicle;
  const std::size_t capacity = (max_message_bytes - kHeaderBytes) / kBytesPerPoint;
  const std::size_t count = std::max<std::size_t>(1, (cloud.size() + capacity - 1) / capacity);
  std::vector<removed_points_t> slices(count);
  for (std::size_t k = 0; k < count; ++k) {
    const std::size_t first = cloud.size() * k / count;
    const std::size_t last = cloud.size() * (k + 1) / count;
    removed_points_t& slice = slices[k];
    slice.utime = scan.utime;
    slice.scan_id = scan.scan_id;
    slice.slice_index = Int32(k);
    slice.slice_count = Int32(count);
    slice.n = Int32(last - first);
    slice.x = Part(cloud.x, first, last);
    slice.y = Part(cloud.y, first, last);
    slice.z = Part(cloud.z, first, last);
    for (std::size_t i = first; i < last; ++i) {
      slice.reason.push_back(static_cast<std::int8_t>(scan.removal_reasons[i]));
    }
  }
  return slices;
}

core::Slice FromLcm(const obstacle_points_t& message) {
  core::Slice slice;
  slice.sensor = 0;
  slice.session = message.session;
  slice.sequence = message.sequence;
  slice.scan_id = message.scan_id;
  slice.scan_utime = message.scan_utime;
  slice.scan_end_utime = message.utime;
  slice.slice_index = message.slice_index;
  slice.slice_count = message.slice_count;
  slice.cloud_sensor.x = message.x;
  slice.cloud_sensor.y = message.y;
  slice.cloud_sensor.z = message.z;
  slice.cloud_sensor.intensity = message.intensity;
  slice.cloud_sensor.tag = message.flags;
  slice.cloud_sensor.time_offset_us.assign(message.x.size(), 0);
  return slice;
}

}  // namespace clearway::messages
