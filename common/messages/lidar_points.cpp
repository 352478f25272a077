// SPDX-License-Identifier: BSD-3-Clause
#include "common/messages/lidar_points.hpp"

namespace clearway::messages {

core::Slice FromLcm(const lidar_points_t& message, int sensor) {
  core::Slice slice;
  slice.sensor = sensor;
  slice.session = message.session;
  slice.sequence = message.sequence;
  slice.scan_id = message.scan_id;
  slice.scan_utime = message.scan_utime;
  slice.scan_end_utime = message.scan_end_utime;
  slice.slice_index = message.slice_index;
  slice.slice_count = message.slice_count;
  slice.shots = message.shots;
  slice.zero_returns = message.zero_returns;
  slice.cloud_sensor.x = message.x;
  slice.cloud_sensor.y = message.y;
  slice.cloud_sensor.z = message.z;
  slice.cloud_sensor.intensity = message.intensity;
  slice.cloud_sensor.tag = message.tag;
  slice.cloud_sensor.time_offset_us = message.time_offset_us;
  return slice;
}

lidar_points_t ToLcm(const core::Slice& slice, const std::string& sensor) {
  const std::int64_t period_us = slice.scan_end_utime - slice.scan_utime;
  lidar_points_t message{};
  message.utime = slice.scan_utime + period_us * slice.slice_index / slice.slice_count;
  message.sensor = sensor;
  message.scan_id = slice.scan_id;
  message.scan_utime = slice.scan_utime;
  message.scan_end_utime = slice.scan_end_utime;
  message.slice_index = slice.slice_index;
  message.slice_count = slice.slice_count;
  message.shots = static_cast<std::int32_t>(slice.shots);
  message.zero_returns = static_cast<std::int32_t>(slice.zero_returns);
  message.lost_packets = 0;
  message.return_mode = lidar_points_t::RETURN_UNKNOWN;
  message.time_source = lidar_points_t::TIME_RECORDED;
  message.n = static_cast<std::int32_t>(slice.cloud_sensor.size());
  message.x = slice.cloud_sensor.x;
  message.y = slice.cloud_sensor.y;
  message.z = slice.cloud_sensor.z;
  message.intensity = slice.cloud_sensor.intensity;
  message.tag = slice.cloud_sensor.tag;
  message.time_offset_us = slice.cloud_sensor.time_offset_us;
  return message;
}

}  // namespace clearway::messages
