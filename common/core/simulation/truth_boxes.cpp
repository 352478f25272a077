// SPDX-License-Identifier: BSD-3-Clause
#include <cmath>
#include <type_traits>

#include "common/core/simulation/scene_geometry.hpp"
#include "common/core/simulation/scene_visit.hpp"

namespace clearway::core {

namespace {

using Eigen::Vector3d;

Vector3d SizeOf(const SceneWall& wall) {
  return {
      std::hypot(wall.x2_m - wall.x1_m, wall.y2_m - wall.y1_m), wall.thickness_m, wall.height_m};
}

// Length, width and height of the box around an object.
template <typename Element>
Vector3d SizeOf(const Element& element) {
  if constexpr (requires { element.depth_m; }) {
    return {element.length_m, element.width_m, element.depth_m};
  } else if constexpr (requires { element.diameter_m; }) {
    return {element.length_m, element.diameter_m, element.diameter_m};
  } else if constexpr (requires { element.radius_m; }) {
    return {2.0 * element.radius_m, 2.0 * element.radius_m, element.height_m};
  } else {
    return {element.length_m, element.width_m, element.height_m};
  }
}

TruthBox MakeTruthBox(const Vector3d& size, const SceneMotion& motion, double z_m) {
  TruthBox box;
  box.center = Vector3d(motion.x_m, motion.y_m, z_m + 0.5 * size.z());
  box.yaw_rad = motion.yaw_rad;
  box.length_m = size.x();
  box.width_m = size.y();
  box.height_m = size.z();
  box.velocity_mps = Eigen::Vector2d(motion.vx_mps, motion.vy_mps);
  return box;
}

}  // namespace

std::vector<TruthBox> TruthBoxesAt(const SceneConfig& scene, std::int64_t time_us) {
  const double time_s = static_cast<double>(time_us) * 1e-6;
  const std::vector<ObjectInfo> infos = DescribeObjects(scene);
  std::vector<TruthBox> boxes;
  ForEachObject(scene, [&](const auto& element, ObjectKind kind, std::int32_t index) {
    using Element = std::decay_t<decltype(element)>;
    TruthBox box;
    if constexpr (Placed<Element>) {
      if (!IsPresent(element.object, time_s)) return;
      const Vector3d size = SizeOf(element);
      const double z_m = kind == ObjectKind::kHole ? -size.z() : element.object.z_m;
      box = MakeTruthBox(size, MotionAt(element.object, time_s), z_m);
    } else if constexpr (std::is_same_v<Element, SceneWall>) {
      box = MakeTruthBox(SizeOf(element), MiddleOf(element), 0.0);
    } else {
      return;
    }
    const ObjectInfo& info = infos[static_cast<std::size_t>(index)];
    box.object = index;
    box.name = info.name;
    box.kind = kind;
    box.on_map = info.on_map;
    boxes.push_back(box);
  });
  return boxes;
}

}  // namespace clearway::core
