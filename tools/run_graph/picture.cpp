// SPDX-License-Identifier: BSD-3-Clause
#include "tools/run_graph/picture.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <string>

#include "common/core/geometry/plane.hpp"

namespace clearway::run_graph {
namespace {

// Drawn length of the corridor while nothing stands in it.
constexpr double kFreeCorridor_m = 4.0;
constexpr std::size_t kMaxLabels = 15;

std::string Format(const char* format, double value) {
  std::array<char, 96> text{};
  std::snprintf(text.data(), text.size(), format, value);
  return text.data();
}

core::Plane FloorOf(const ScanRecord& scan) {
  core::Plane plane;
  if (scan.floor) {
    for (int i = 0; i < 3; ++i) plane.normal[i] = static_cast<float>(scan.floor->normal[i]);
    plane.offset_m = static_cast<float>(scan.floor->offset_m);
  }
  return plane;
}

void AddRawPoints(const ScanRecord& scan,
                  const core::VehicleConfig& vehicle,
                  double floor_threshold_m,
                  plot::ScanPicture& picture) {
  const core::Plane floor = FloorOf(scan);
  for (const lidar_points_t& slice : scan.raw) {
    const std::optional<int> sensor = vehicle.FindSensor(slice.sensor);
    if (!sensor) continue;
    const Eigen::Isometry3f T_vehicle_sensor =
        vehicle.sensors[static_cast<std::size_t>(*sensor)].T_vehicle_sensor().cast<float>();
    for (std::size_t i = 0; i < slice.x.size(); ++i) {
      const Eigen::Vector3f point =
          T_vehicle_sensor * Eigen::Vector3f(slice.x[i], slice.y[i], slice.z[i]);
      picture.raw_points.push_back(point);
      if (std::abs(floor.SignedDistance(point)) <= floor_threshold_m) {
        picture.floor_points.push_back(point);
      }
    }
  }
}

void AddObstacles(const ScanRecord& scan, plot::ScanPicture& picture) {
  for (const obstacle_points_t& slice : scan.obstacles) {
    for (std::size_t i = 0; i < slice.x.size(); ++i) {
      const bool below = (slice.flags[i] & obstacle_points_t::POINT_BELOW_FLOOR) != 0;
      (below ? picture.below_floor_points : picture.obstacle_points)
          .emplace_back(slice.x[i], slice.y[i], slice.z[i]);
    }
  }
}

plot::PictureDetection ToPicture(const detection_t& detection) {
  plot::PictureDetection drawn;
  for (std::size_t i = 0; i < detection.hull_x.size(); ++i) {
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
void AddDetections(const ScanRecord& scan, plot::ScanPicture& picture) {
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
        std::to_string(detection->id) + Format(" %.1f m", DistanceOf(*detection));
  }
}

void AddCorridor(const drive_permit_t& permit,
                 const core::VehicleConfig& vehicle,
                 plot::ScanPicture& picture) {
  float front = 0.0F;
  float left = 0.0F;
  float right = 0.0F;
  for (const Eigen::Vector2f& corner : picture.footprint) {
    front = std::max(front, corner.x());
    left = std::max(left, corner.y());
    right = std::min(right, corner.y());
  }
  const auto length_m = static_cast<float>(permit.free_distance_m < 0.0
                                               ? kFreeCorridor_m
                                               : std::min(permit.free_distance_m, kFreeCorridor_m));
  plot::PictureCorridor corridor;
  corridor.polygon = {
      {front, right}, {front + length_m, right}, {front + length_m, left}, {front, left}};
  corridor.state = plot::CorridorState::kLimited;
  if (permit.forward_mps <= 0.0) corridor.state = plot::CorridorState::kStop;
  if (permit.forward_mps >= vehicle.max_forward_mps) corridor.state = plot::CorridorState::kFree;
  corridor.label = Format("%.2f m/s", permit.forward_mps);
  picture.corridors.push_back(corridor);
}

void AddText(const ScanRecord& scan, plot::ScanPicture& picture) {
  const obstacle_points_t& header = scan.obstacles.front();
  picture.text_lines.push_back(
      "scan " + std::to_string(header.scan_id) +
      (header.scan_state == obstacle_points_t::SCAN_COMPLETE ? ", complete" : ", INCOMPLETE"));
  if (scan.floor) {
    constexpr const char* kStates[] = {"found", "held from an earlier scan", "not found: z = 0"};
    picture.text_lines.push_back(
        std::string("floor: ") +
        kStates[static_cast<std::size_t>(std::clamp<int>(scan.floor->state, 0, 2))] +
        Format(", tilt %.1f deg", scan.floor->tilt_rad * 180.0 / 3.14159265358979));
  }
}

}  // namespace

plot::ScanPicture MakePicture(const ScanRecord& scan,
                              const std::optional<drive_permit_t>& permit,
                              const core::VehicleConfig& vehicle,
                              double floor_threshold_m) {
  plot::ScanPicture picture;
  picture.title = "clearway: last scan of the run";
  AddRawPoints(scan, vehicle, floor_threshold_m, picture);
  AddObstacles(scan, picture);
  AddDetections(scan, picture);
  for (const Eigen::Vector2d& corner : vehicle.Footprint()) {
    picture.footprint.push_back(corner.cast<float>());
  }
  picture.sensor_origin = vehicle.sensors.front().T_vehicle_sensor().translation().cast<float>();
  if (!scan.obstacles.empty()) AddText(scan, picture);
  if (permit) {
    AddCorridor(*permit, vehicle, picture);
    picture.text_lines.push_back(Format("permit: forward %.2f m/s, ", permit->forward_mps) +
                                 permit->text);
  }
  return picture;
}

}  // namespace clearway::run_graph
