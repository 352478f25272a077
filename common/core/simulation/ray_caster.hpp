// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include <Eigen/Core>

#include "common/core/simulation/scene_geometry.hpp"

namespace clearway::core {

/// The first surface that a ray meets.
struct RayHit {
  double range_m = 0.0;
  double incidence_cos = 0.0;  ///< Of the angle between the ray and the surface's normal, 0..1.
  double reflectivity = 0.0;
  std::int32_t object = kNoObject;  ///< Index of the object, or kFloorObject.
  Material material = Material::kDiffuse;
};

/// What a sensor can see at all: a cone.
struct ViewCone {
  Eigen::Vector3d axis_map = Eigen::Vector3d::UnitX();  ///< Unit vector.
  double half_angle_rad = 0.0;                          ///< At most pi / 2.
};

/// Exact intersections of rays that start in one point with the solids of a scene.
/// Brute force over the solids; the cone around each solid, seen from the origin, rejects most of
/// them with one dot product. A solid that holds the origin is seen from within.
/// Thread safety: stateless after construction.
class RayCaster {
 public:
  /// Sees nothing until Aim().
  RayCaster() = default;
  /// O(solids). Takes what it needs from `geometry`, which need not outlive it.
  RayCaster(const SceneGeometry& geometry, const Eigen::Vector3d& origin_map) {
    Aim(geometry, origin_map);
  }

  /// The same for another place or another scene. With a cone, only rays within it may be cast.
  /// Allocates nothing once sizes have settled.
  void Aim(const SceneGeometry& geometry,
           const Eigen::Vector3d& origin_map,
           const std::optional<ViewCone>& cone = std::nullopt);

  /// Nearest hit along a unit vector, nothing where the ray meets nothing. Ties go to the floor,
  /// then to the solid that stands first. `glass_too`: glass counts. O(solids).
  [[nodiscard]] std::optional<RayHit> Cast(const Eigen::Vector3d& direction_map,
                                           bool glass_too = true) const;

 private:
  struct Solid {
    Primitive primitive;
    Eigen::Matrix3d R_local_map;
    Eigen::Vector3d origin_local;
  };
  // A ray that meets the solid is at least this well aligned with the axis.
  struct Cone {
    double x, y, z;
    double min_cos;
  };

  [[nodiscard]] std::optional<RayHit> CastToFloor(const Eigen::Vector3d& direction_map) const;
  static Solid Prepare(const Primitive& primitive, const Eigen::Vector3d& origin_map);
  static Cone ConeOf(const Primitive& primitive, const Eigen::Vector3d& origin_map);

  SceneFloor floor_;
  Eigen::Vector3d origin_map_ = Eigen::Vector3d::Zero();
  std::vector<Cone> cones_;  // Of the solids.
  std::vector<Solid> solids_;
  std::vector<Solid> pits_;
};

}  // namespace clearway::core
