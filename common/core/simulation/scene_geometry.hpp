// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include <Eigen/Geometry>

#include "common/core/simulation/scene.hpp"

namespace clearway::core {

/// What an object of a scene is.
enum class ObjectKind : std::int8_t {
  kRoom,
  kWall,
  kBox,
  kCylinder,
  kShelf,
  kTable,
  kCable,
  kRamp,
  kHole,
  kPerson
};

/// The name of the kind's XML element.
[[nodiscard]] const char* KindName(ObjectKind kind);

/// Object index of a shot that returned nothing.
inline constexpr std::int32_t kNoObject = -1;

/// Object index of a return from the floor.
inline constexpr std::int32_t kFloorObject = -2;

/// Object index of a return from a wall of the map.
inline constexpr std::int32_t kMapObject = -3;

/// Object index of a return from dust.
inline constexpr std::int32_t kDustObject = -4;

/// What does not change with time. An object's index is its place in DescribeObjects().
struct ObjectInfo {
  std::string name;
  ObjectKind kind = ObjectKind::kBox;
  bool on_map = false;
};

/// All objects of the scene, present or not, in the order of the lists of SceneConfig.
[[nodiscard]] std::vector<ObjectInfo> DescribeObjects(const SceneConfig& scene);

/// A solid that a ray can meet. Its local frame sits in its centre.
struct Primitive {
  enum class Shape : std::int8_t {
    kBox,
    kWedge,    ///< The half of the box with z / half_extents.z <= x / half_extents.x.
    kCylinder  ///< Axis = local z; half_extents = (radius, radius, half height).
  };

  Shape shape = Shape::kBox;
  Eigen::Isometry3d T_map_local = Eigen::Isometry3d::Identity();
  Eigen::Vector3d half_extents = Eigen::Vector3d::Zero();  ///< [m]
  double reflectivity = 0.0;
  std::int32_t object = kNoObject;
  Material material = Material::kDiffuse;
};

/// A cuboid cut out of the floor; its upper face lies in z = 0.
struct Pit {
  Eigen::Isometry3d T_map_local = Eigen::Isometry3d::Identity();  ///< Centre of the cuboid.
  Eigen::Vector3d half_extents = Eigen::Vector3d::Zero();         ///< [m]
  double reflectivity = 0.0;
  std::int32_t object = kNoObject;
};

/// A scene at one moment, as solids.
struct SceneGeometry {
  SceneFloor floor;
  std::vector<Primitive> primitives;
  std::vector<Pit> pits;
};

/// The scene `time_us` after its start. O(objects).
[[nodiscard]] SceneGeometry GeometryAt(const SceneConfig& scene, std::int64_t time_us);

/// Whether the solids of an object change with time.
[[nodiscard]] bool ChangesWithTime(const SceneObject& object);
/// Whether those of any object do.
[[nodiscard]] bool ChangesWithTime(const SceneConfig& scene);

/// The upright box around an object that is present, in the map frame: ground truth.
struct TruthBox {
  std::int32_t object = kNoObject;
  std::string name;
  ObjectKind kind = ObjectKind::kBox;
  bool on_map = false;
  Eigen::Vector3d center = Eigen::Vector3d::Zero();  ///< [m]
  double yaw_rad = 0.0;                              ///< Direction of the length.
  double length_m = 0.0;
  double width_m = 0.0;
  double height_m = 0.0;
  Eigen::Vector2d velocity_mps = Eigen::Vector2d::Zero();
};

/// Boxes of all objects that are present `time_us` after the scene's start, in the order of their
/// indices. Rooms have none: they surround.
[[nodiscard]] std::vector<TruthBox> TruthBoxesAt(const SceneConfig& scene, std::int64_t time_us);

}  // namespace clearway::core
