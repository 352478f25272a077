// SPDX-License-Identifier: BSD-3-Clause
#include "tools/plot/scan_from_messages.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>

#include "common/core/geometry/plane.hpp"
#include "common/core/guard/free_speed.hpp"
#include "common/messages/map_state.hpp"

namespace clearway::plot {
namespace {

// Drawn length of the corridor while nothing stands in it.
constexpr std::size_t kMaxLabels = 10;

std::string Format(const char* format, double value) {
  std::array<char, 96> text{};
  std::snprintf(text.data(), text.size(), format, value);
  return text.data();
}

// What every message that carries points has in common.
template <typename Message>
std::size_t NumPoints(const Message& slice) {
  return std::min({slice.x.size(), slice.y.size(), slice.z.size()});
}

void AddRawPoints(const ScanMessages& scan,
                  const core::VehicleConfig& vehicle,
                  ScanPicture& picture) {
  for (const lidar_points_t& slice : scan.raw) {
    const std::optional<int> sensor = vehicle.FindSensor(slice.sensor);
    if (!sensor) continue;
    const Eigen::Isometry3f T_vehicle_sensor =
        vehicle.sensors[static_cast<std::size_t>(*sensor)].T_vehicle_sensor().cast<float>();
    for (std::size_t i = 0; i < NumPoints(slice); ++i) {
      picture.raw_points.emplace_back(T_vehicle_sensor *
                                      Eigen::Vector3f(slice.x[i], slice.y[i], slice.z[i]));
    }
  }
  if (picture.raw_points.empty() && scan.raw.empty()) picture.missing.Add(Layer::kRaw);
}

// Without REMOVED_POINTS: the raw points near the plane.
void AddFloorFromRaw(const ScanMessages& scan, double threshold_m, ScanPicture& picture) {
  if (!scan.floor || scan.raw.empty()) {
    picture.missing.Add(Layer::kFloor);
    return;
  }
  core::Plane plane;
  for (int i = 0; i < 3; ++i) plane.normal[i] = static_cast<float>(scan.floor->normal[i]);
  plane.offset_m = static_cast<float>(scan.floor->offset_m);
  for (const Eigen::Vector3f& point : picture.raw_points) {
    if (std::abs(plane.SignedDistance(point)) <= threshold_m) picture.floor_points.push_back(point);
  }
}

// The header tells when the map filter took nothing out.
bool MayHaveUsedMap(const ScanMessages& scan) {
  if (scan.obstacles.empty()) return true;
  const std::int8_t state = scan.obstacles.front().map_state;
  return messages::IsFiltered(state);
}

void AddRemoved(const ScanMessages& scan, double floor_threshold_m, ScanPicture& picture) {
  if (scan.removed.empty()) {
    AddFloorFromRaw(scan, floor_threshold_m, picture);
    picture.missing.Add(Layer::kOutliers);
    if (MayHaveUsedMap(scan)) picture.missing.Add(Layer::kRemovedByMap);
    return;
  }
  for (const removed_points_t& slice : scan.removed) {
    for (std::size_t i = 0; i < std::min(NumPoints(slice), slice.reason.size()); ++i) {
      std::vector<Eigen::Vector3f>* list = nullptr;
      if (slice.reason[i] == removed_points_t::REASON_FLOOR) list = &picture.floor_points;
      if (slice.reason[i] == removed_points_t::REASON_MAP) list = &picture.map_points;
      if (slice.reason[i] == removed_points_t::REASON_OUTLIER) list = &picture.outlier_points;
      if (list != nullptr) list->emplace_back(slice.x[i], slice.y[i], slice.z[i]);
    }
  }
}

void AddObstacles(const ScanMessages& scan, ScanPicture& picture) {
  if (scan.obstacles.empty()) picture.missing.Add(Layer::kObstacles);
  for (const obstacle_points_t& slice : scan.obstacles) {
    for (std::size_t i = 0; i < std::min(NumPoints(slice), slice.flags.size()); ++i) {
      const bool below = (slice.flags[i] & obstacle_points_t::POINT_BELOW_FLOOR) != 0;
      (below ? picture.below_floor_points : picture.obstacle_points)
          .emplace_back(slice.x[i], slice.y[i], slice.z[i]);
    }
  }
}

PictureDetection ToPicture(const detection_t& detection) {
  PictureDetection drawn;
  const std::size_t vertices = std::min(detection.hull_x.size(), detection.hull_y.size());
  for (std::size_t i = 0; i < vertices; ++i) {
    drawn.hull.emplace_back(detection.hull_x[i], detection.hull_y[i]);
  }
  drawn.center = {detection.center[0], detection.center[1]};
  drawn.length_m = detection.length_m;
  drawn.width_m = detection.width_m;
  drawn.yaw_rad = detection.yaw_rad;
  drawn.centroid = {detection.centroid[0], detection.centroid[1], detection.centroid[2]};
  drawn.z_min_m = detection.z_min;
  drawn.z_max_m = detection.z_max;
  return drawn;
}

double DistanceOf(const detection_t& detection) {
  return std::hypot(static_cast<double>(detection.nearest[0]),
                    static_cast<double>(detection.nearest[1]));
}

// All detections are drawn; only the nearest ones are named, so that the names can be read.
void AddDetections(const ScanMessages& scan, ScanPicture& picture) {
  if (scan.detections.empty()) picture.missing.Add(Layer::kDetections);
  std::vector<const detection_t*> nearest_first;
  for (const detections_t& slice : scan.detections) {
    for (const detection_t& detection : slice.detections) nearest_first.push_back(&detection);
  }
  std::stable_sort(
      nearest_first.begin(), nearest_first.end(), [](const detection_t* a, const detection_t* b) {
        return DistanceOf(*a) < DistanceOf(*b);
      });
  for (const detection_t* detection : nearest_first) {
    picture.detections.push_back(ToPicture(*detection));
    if (picture.detections.size() > kMaxLabels) continue;
    picture.detections.back().label =
        "#" + std::to_string(detection->id) + Format(" %.1f m", DistanceOf(*detection));
  }
}

void AddCorridor(const drive_permit_t& permit,
                 const core::VehicleConfig& vehicle,
                 ScanPicture& picture) {
  float front = 0.0F;
  float left = 0.0F;
  float right = 0.0F;
  for (const Eigen::Vector2f& corner : picture.footprint) {
    front = std::max(front, corner.x());
    left = std::max(left, corner.y());
    right = std::min(right, corner.y());
  }
  // To what is in the way; where nothing is within the guard's reach, what the permit vouches for:
  // the way to a stand.
  const core::Braking braking{vehicle.deceleration_mps2, vehicle.ReactionTime(), 0.0};
  const auto length_m =
      static_cast<float>(permit.free_distance_m < 0.0
                             ? core::StoppingDistance(std::max(permit.forward_mps, 0.0), braking)
                             : permit.free_distance_m);
  PictureCorridor corridor;
  corridor.polygon = {
      {front, right}, {front + length_m, right}, {front + length_m, left}, {front, left}};
  corridor.state = CorridorState::kLimited;
  if (permit.forward_mps <= 0.0) corridor.state = CorridorState::kStop;
  if (permit.forward_mps >= vehicle.max_forward_mps) corridor.state = CorridorState::kFree;
  corridor.label = Format("%.2f m/s", permit.forward_mps);
  picture.corridors.push_back(corridor);
}

void AddMap(const ScanMessages& scan, const ScanContext& context, ScanPicture& picture) {
  if (context.map.grid && scan.T_map_vehicle) {
    picture.map = PictureMap{context.map.grid, *scan.T_map_vehicle};
  } else {
    picture.missing.Add(Layer::kMap);
  }
}

}  // namespace

ScanPicture MakePicture(const ScanMessages& scan, const ScanContext& context) {
  ScanPicture picture;
  picture.title = context.title;
  AddRawPoints(scan, context.vehicle, picture);
  AddRemoved(scan, context.floor_threshold_m, picture);
  AddObstacles(scan, picture);
  AddDetections(scan, picture);
  AddMap(scan, context, picture);
  for (const Eigen::Vector2d& corner : context.vehicle.Footprint()) {
    picture.footprint.push_back(corner.cast<float>());
  }
  picture.sensor_origin =
      context.vehicle.sensors.front().T_vehicle_sensor().translation().cast<float>();
  if (scan.permit) {
    AddCorridor(*scan.permit, context.vehicle, picture);
  } else {
    picture.missing.Add(Layer::kCorridor);
  }
  picture.text_lines = DescribeScan(scan, context);
  return picture;
}

}  // namespace clearway::plot
