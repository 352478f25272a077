// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>
#include <cstdint>

#include "common/core/simulation/scene.hpp"
#include "common/core/simulation/scene_geometry.hpp"

namespace clearway::core {

/// Calls visit(element, kind, index) for every object of the scene, in the order of the indices.
template <typename Function>
void ForEachObject(const SceneConfig& scene, Function visit) {
  std::int32_t index = 0;
  const auto each = [&](const auto& list, ObjectKind kind) {
    for (const auto& element : list) visit(element, kind, index++);
  };
  each(scene.rooms, ObjectKind::kRoom);
  each(scene.walls, ObjectKind::kWall);
  each(scene.boxes, ObjectKind::kBox);
  each(scene.cylinders, ObjectKind::kCylinder);
  each(scene.shelves, ObjectKind::kShelf);
  each(scene.tables, ObjectKind::kTable);
  each(scene.cables, ObjectKind::kCable);
  each(scene.ramps, ObjectKind::kRamp);
  each(scene.holes, ObjectKind::kHole);
  each(scene.persons, ObjectKind::kPerson);
}

/// Elements with a SceneObject: all but rooms and walls.
template <typename Element>
concept Placed = requires(const Element& element) {
  element.object.name;
};

/// The middle of a wall, and its direction.
[[nodiscard]] inline SceneMotion MiddleOf(const SceneWall& wall) {
  return {.x_m = 0.5 * (wall.x1_m + wall.x2_m),
          .y_m = 0.5 * (wall.y1_m + wall.y2_m),
          .yaw_rad = std::atan2(wall.y2_m - wall.y1_m, wall.x2_m - wall.x1_m)};
}

}  // namespace clearway::core
