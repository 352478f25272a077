// SPDX-License-Identifier: BSD-3-Clause
#include "common/core/simulation/scene_geometry.hpp"

#include <cmath>
#include <numbers>
#include <type_traits>
#include <utility>

#include "common/core/simulation/scene_visit.hpp"

namespace clearway::core {

namespace {

using Eigen::Isometry3d;
using Eigen::Vector3d;

constexpr double kRoomWall_m = 0.1;  // Thickness, outwards.

// Frame of an object: origin on its underside, x along yaw.
Isometry3d FrameOf(const SceneMotion& motion, double z_m) {
  Isometry3d T = Isometry3d::Identity();
  T.translation() = Vector3d(motion.x_m, motion.y_m, z_m);
  T.linear() = Eigen::AngleAxisd(motion.yaw_rad, Vector3d::UnitZ()).toRotationMatrix();
  return T;
}

// Collects the solids of one object after another.
class Builder {
 public:
  explicit Builder(double time_s) : time_s_(time_s) {}

  SceneGeometry Take() { return std::move(geometry_); }

  void Begin(std::int32_t object,
             double reflectivity,
             Material material,
             const Isometry3d& T_map_object) {
    object_ = object;
    reflectivity_ = reflectivity;
    material_ = material;
    T_map_object_ = T_map_object;
  }

  // A box with its lowest point at `bottom` (centre of the underside) in the object's frame.
  void AddBox(const Vector3d& bottom, const Vector3d& size) {
    AddSolid(Primitive::Shape::kBox, bottom, size);
  }
  void AddUpright(const Vector3d& bottom, double radius_m, double height_m) {
    AddSolid(
        Primitive::Shape::kCylinder, bottom, Vector3d(2.0 * radius_m, 2.0 * radius_m, height_m));
  }

  void Add(const SceneRoom& room);
  void Add(const SceneWall& wall);
  void Add(const SceneBox& box) {
    AddBox(Vector3d::Zero(), Vector3d(box.length_m, box.width_m, box.height_m));
  }
  void Add(const SceneCylinder& cylinder) {
    AddUpright(Vector3d::Zero(), cylinder.radius_m, cylinder.height_m);
  }
  void Add(const SceneShelf& shelf);
  void Add(const SceneTable& table);
  void Add(const SceneCable& cable);
  void Add(const SceneRamp& ramp) {
    AddSolid(Primitive::Shape::kWedge,
             Vector3d::Zero(),
             Vector3d(ramp.length_m, ramp.width_m, ramp.height_m));
  }
  void Add(const SceneHole& hole);
  void Add(const ScenePerson& person);

  void AddFloor(const SceneFloor& floor) { geometry_.floor = floor; }

 private:
  void AddSolid(Primitive::Shape shape, const Vector3d& bottom, const Vector3d& size) {
    Isometry3d T_map_local = T_map_object_;
    T_map_local.translate(bottom + Vector3d(0.0, 0.0, 0.5 * size.z()));
    geometry_.primitives.push_back(
        {shape, T_map_local, 0.5 * size, reflectivity_, object_, material_});
  }

  double time_s_;
  std::int32_t object_ = kNoObject;
  double reflectivity_ = 0.0;
  Material material_ = Material::kDiffuse;
  Isometry3d T_map_object_ = Isometry3d::Identity();
  SceneGeometry geometry_;
};

void Builder::Add(const SceneRoom& room) {
  const double length_m = room.x_max_m - room.x_min_m;
  const double width_m = room.y_max_m - room.y_min_m;
  const double x_m = 0.5 * (room.x_min_m + room.x_max_m);
  const double y_m = 0.5 * (room.y_min_m + room.y_max_m);
  const double half_m = 0.5 * kRoomWall_m;
  const Vector3d along_y(kRoomWall_m, width_m + 2.0 * kRoomWall_m, room.height_m);
  const Vector3d along_x(length_m, kRoomWall_m, room.height_m);
  AddBox(Vector3d(room.x_min_m - half_m, y_m, 0.0), along_y);
  AddBox(Vector3d(room.x_max_m + half_m, y_m, 0.0), along_y);
  AddBox(Vector3d(x_m, room.y_min_m - half_m, 0.0), along_x);
  AddBox(Vector3d(x_m, room.y_max_m + half_m, 0.0), along_x);
  if (!room.ceiling) return;
  AddBox(Vector3d(x_m, y_m, room.height_m),
         Vector3d(length_m + 2.0 * kRoomWall_m, width_m + 2.0 * kRoomWall_m, kRoomWall_m));
}

void Builder::Add(const SceneWall& wall) {
  const double length_m = std::hypot(wall.x2_m - wall.x1_m, wall.y2_m - wall.y1_m);
  AddBox(Vector3d::Zero(), Vector3d(length_m, wall.thickness_m, wall.height_m));
}

void Builder::Add(const SceneShelf& shelf) {
  const double post_m = shelf.post_width_m;
  const double x_m = 0.5 * (shelf.length_m - post_m);
  const double y_m = 0.5 * (shelf.width_m - post_m);
  for (const double sx : {-1.0, 1.0}) {
    for (const double sy : {-1.0, 1.0}) {
      AddBox(Vector3d(sx * x_m, sy * y_m, 0.0), Vector3d(post_m, post_m, shelf.height_m));
    }
  }
  const double highest_m = shelf.height_m - shelf.board_thickness_m;
  const int gaps = shelf.num_boards - 1;
  for (int i = 0; i < shelf.num_boards; ++i) {
    const double z_m = gaps == 0
                           ? highest_m
                           : shelf.lowest_board_m + (highest_m - shelf.lowest_board_m) * i / gaps;
    AddBox(Vector3d(0.0, 0.0, z_m),
           Vector3d(shelf.length_m, shelf.width_m, shelf.board_thickness_m));
  }
}

void Builder::Add(const SceneTable& table) {
  const double radius_m = 0.5 * table.leg_diameter_m;
  const double under_m = table.height_m - table.top_thickness_m;
  const double x_m = 0.5 * table.length_m - table.overhang_m - radius_m;
  const double y_m = 0.5 * table.width_m - table.overhang_m - radius_m;
  for (const double sx : {-1.0, 1.0}) {
    for (const double sy : {-1.0, 1.0}) {
      AddUpright(Vector3d(sx * x_m, sy * y_m, 0.0), radius_m, under_m);
    }
  }
  AddBox(Vector3d(0.0, 0.0, under_m),
         Vector3d(table.length_m, table.width_m, table.top_thickness_m));
}

void Builder::Add(const SceneCable& cable) {
  Isometry3d T_map_local = T_map_object_;
  T_map_local.translate(Vector3d(0.0, 0.0, 0.5 * cable.diameter_m));
  T_map_local.rotate(Eigen::AngleAxisd(0.5 * std::numbers::pi, Vector3d::UnitY()));
  const double radius_m = 0.5 * cable.diameter_m;
  geometry_.primitives.push_back({Primitive::Shape::kCylinder,
                                  T_map_local,
                                  Vector3d(radius_m, radius_m, 0.5 * cable.length_m),
                                  reflectivity_,
                                  object_,
                                  material_});
}

void Builder::Add(const SceneHole& hole) {
  Isometry3d T_map_local = T_map_object_;
  T_map_local.translate(Vector3d(0.0, 0.0, -0.5 * hole.depth_m));
  geometry_.pits.push_back({T_map_local,
                            0.5 * Vector3d(hole.length_m, hole.width_m, hole.depth_m),
                            reflectivity_,
                            object_});
}

void Builder::Add(const ScenePerson& person) {
  // Proportions of an adult; the legs swing once forth and back in two steps, and at the end of a
  // swing they still lie within the trunk's radius.
  constexpr double kStep_m = 0.7;
  const double radius_m = person.radius_m;
  const double height_m = person.height_m;
  const double hip_m = 0.48 * height_m;
  const double shoulder_m = 0.83 * height_m;
  const double walked_m = MotionAt(person.object, time_s_).distance_m;
  const double swing_m = 0.6 * radius_m * std::sin(std::numbers::pi * walked_m / kStep_m);
  AddUpright(Vector3d(swing_m, 0.35 * radius_m, 0.0), 0.28 * radius_m, hip_m);
  AddUpright(Vector3d(-swing_m, -0.35 * radius_m, 0.0), 0.28 * radius_m, hip_m);
  AddUpright(Vector3d(0.0, 0.0, hip_m), radius_m, shoulder_m - hip_m);
  AddUpright(Vector3d(0.0, 0.0, shoulder_m), 0.4 * radius_m, height_m - shoulder_m);
}

}  // namespace

const char* KindName(ObjectKind kind) {
  switch (kind) {
    case ObjectKind::kRoom:
      return "room";
    case ObjectKind::kWall:
      return "wall";
    case ObjectKind::kBox:
      return "box";
    case ObjectKind::kCylinder:
      return "cylinder";
    case ObjectKind::kShelf:
      return "shelf";
    case ObjectKind::kTable:
      return "table";
    case ObjectKind::kCable:
      return "cable";
    case ObjectKind::kRamp:
      return "ramp";
    case ObjectKind::kHole:
      return "hole";
    case ObjectKind::kPerson:
      return "person";
  }
  return "object";
}

std::vector<ObjectInfo> DescribeObjects(const SceneConfig& scene) {
  std::vector<ObjectInfo> infos;
  ForEachObject(scene, [&](const auto& element, ObjectKind kind, std::int32_t) {
    if constexpr (Placed<std::decay_t<decltype(element)>>) {
      infos.push_back({element.object.name, kind, element.object.on_map});
    } else {
      infos.push_back({element.name, kind, element.on_map});
    }
  });
  return infos;
}

SceneGeometry GeometryAt(const SceneConfig& scene, std::int64_t time_us) {
  const double time_s = static_cast<double>(time_us) * 1e-6;
  Builder builder(time_s);
  builder.AddFloor(scene.floor);
  ForEachObject(scene, [&](const auto& element, ObjectKind, std::int32_t index) {
    using Element = std::decay_t<decltype(element)>;
    if constexpr (Placed<Element>) {
      if (!IsPresent(element.object, time_s)) return;
      builder.Begin(index,
                    element.object.reflectivity,
                    element.object.material,
                    FrameOf(MotionAt(element.object, time_s), element.object.z_m));
    } else if constexpr (std::is_same_v<Element, SceneWall>) {
      builder.Begin(index, element.reflectivity, element.material, FrameOf(MiddleOf(element), 0.0));
    } else {
      builder.Begin(index, element.reflectivity, element.material, Isometry3d::Identity());
    }
    builder.Add(element);
  });
  return builder.Take();
}

bool ChangesWithTime(const SceneObject& object) {
  const bool moves = object.speed_mps > 0.0 && !object.waypoints.empty();
  return moves || object.appear_s >= 0.0 || object.vanish_s >= 0.0;
}

bool ChangesWithTime(const SceneConfig& scene) {
  bool changes = false;
  ForEachObject(scene, [&](const auto& element, ObjectKind, std::int32_t) {
    if constexpr (Placed<std::decay_t<decltype(element)>>) {
      changes = changes || ChangesWithTime(element.object);
    }
  });
  return changes;
}

}  // namespace clearway::core
