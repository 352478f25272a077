// SPDX-License-Identifier: BSD-3-Clause
#include "common/messages/detections.hpp"

#include <algorithm>

namespace clearway::messages {
namespace {

constexpr std::size_t kHeaderBytes = 128;
// A detection without its hull, and one vertex of that.
constexpr std::size_t kDetectionBytes = 128;
constexpr std::size_t kVertexBytes = 2 * sizeof(float);

detections_t HeaderOf(const obstacle_points_t& source) {
  detections_t message{};
  message.utime = source.utime;
  message.scan_id = source.scan_id;
  message.scan_utime = source.scan_utime;
  message.scan_state = source.scan_state;
  message.floor_state = source.floor_state;
  message.map_state = source.map_state;
  message.map_epoch = source.map_epoch;
  return message;
}

}  // namespace

detection_t ToLcm(const core::Detection& detection, std::int32_t id, std::int32_t below_floor) {
  detection_t message{};
  message.id = id;
  message.points = static_cast<std::int32_t>(detection.num_points);
  message.points_below_floor = below_floor;
  for (int i = 0; i < 3; ++i) message.centroid[i] = detection.centroid[i];
  for (int i = 0; i < 2; ++i) message.nearest[i] = detection.nearest[i];
  message.z_min = detection.z_min_m;
  message.z_max = detection.z_max_m;
  for (int i = 0; i < 2; ++i) message.center[i] = detection.rectangle.center[i];
  message.length_m = detection.rectangle.length_m;
  message.width_m = detection.rectangle.width_m;
  message.yaw_rad = detection.rectangle.yaw_rad;
  message.yaw_confidence = -1.0F;
  message.velocity_variance = -1.0F;
  message.kind = detection_t::KIND_UNKNOWN;
  message.hull_n = static_cast<std::int32_t>(detection.hull.size());
  for (const Eigen::Vector2f& vertex : detection.hull) {
    message.hull_x.push_back(vertex.x());
    message.hull_y.push_back(vertex.y());
  }
  return message;
}

core::Detection FromLcm(const detection_t& message) {
  core::Detection detection;
  detection.num_points = static_cast<std::uint32_t>(std::max(message.points, 0));
  detection.centroid = {message.centroid[0], message.centroid[1], message.centroid[2]};
  detection.nearest = {message.nearest[0], message.nearest[1]};
  detection.z_min_m = message.z_min;
  detection.z_max_m = message.z_max;
  detection.rectangle = {.center = {message.center[0], message.center[1]},
                         .length_m = message.length_m,
                         .width_m = message.width_m,
                         .yaw_rad = message.yaw_rad};
  for (std::size_t i = 0; i < message.hull_x.size(); ++i) {
    detection.hull.emplace_back(message.hull_x[i], message.hull_y[i]);
  }
  return detection;
}

std::vector<detections_t> ToDetections(const obstacle_points_t& source,
                                       std::span<const detection_t> detections,
                                       std::size_t max_message_bytes) {
  std::vector<detections_t> slices(1, HeaderOf(source));
  std::size_t bytes = kHeaderBytes;
  for (const detection_t& detection : detections) {
    const std::size_t more = kDetectionBytes + kVertexBytes * detection.hull_x.size();
    if (bytes + more > max_message_bytes && !slices.back().detections.empty()) {
      slices.push_back(HeaderOf(source));
      bytes = kHeaderBytes;
    }
    slices.back().detections.push_back(detection);
    bytes += more;
  }
  for (std::size_t k = 0; k < slices.size(); ++k) {
    slices[k].slice_index = static_cast<std::int32_t>(k);
    slices[k].slice_count = static_cast<std::int32_t>(slices.size());
    slices[k].n = static_cast<std::int32_t>(slices[k].detections.size());
  }
  return slices;
}

}  // namespace clearway::messages
