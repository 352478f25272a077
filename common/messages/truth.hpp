// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <utility>
#include <vector>

#include <Eigen/Geometry>
#include <clearway/truth_t.hpp>

#include "common/core/simulation/scene_geometry.hpp"

namespace clearway::messages {

/// What sensors saw of one object.
struct RayCount {
  std::int32_t points = -1;          ///< Rays on it in a scan; -1: not known.
  std::int64_t first_ray_utime = 0;  ///< The first that ever met it; 0: none yet [us].
};

/// What is true at the end of a scan.
struct Truth {
  std::int64_t utime = 0;  ///< [us since the epoch]
  std::int64_t scan_id = -1;
  Eigen::Isometry3d T_map_vehicle = Eigen::Isometry3d::Identity();
  std::vector<core::TruthBox> boxes;
  std::vector<RayCount> rays;  ///< By object; one that has none here is not known.
};

/// A TRUTH message; session and sequence are left to the caller. O(boxes).
[[nodiscard]] inline truth_t ToTruth(const Truth& truth) {
  truth_t message{};
  message.utime = truth.utime;
  message.scan_id = truth.scan_id;
  const Eigen::Quaterniond orientation(truth.T_map_vehicle.linear());
  for (int i = 0; i < 3; ++i) message.pos[i] = truth.T_map_vehicle.translation()[i];
  message.orientation[0] = orientation.w();
  message.orientation[1] = orientation.x();
  message.orientation[2] = orientation.y();
  message.orientation[3] = orientation.z();
  for (const core::TruthBox& box : truth.boxes) {
    const auto index = static_cast<std::size_t>(box.object);
    const RayCount rays = index < truth.rays.size() ? truth.rays[index] : RayCount{};
    truth_object_t object{};
    object.id = box.object;
    object.name = box.name;
    object.kind = core::KindName(box.kind);
    for (int i = 0; i < 3; ++i) object.center[i] = box.center[i];
    object.length_m = box.length_m;
    object.width_m = box.width_m;
    object.height_m = box.height_m;
    object.yaw_rad = box.yaw_rad;
    for (int i = 0; i < 2; ++i) object.velocity[i] = box.velocity_mps[i];
    object.points = rays.points;
    object.first_ray_utime = rays.first_ray_utime;
    object.on_map = box.on_map;
    message.objects.push_back(std::move(object));
  }
  message.n = static_cast<std::int32_t>(message.objects.size());
  return message;
}

}  // namespace clearway::messages
