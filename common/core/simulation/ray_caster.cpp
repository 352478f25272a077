// SPDX-License-Identifier: BSD-3-Clause
#include "common/core/simulation/ray_caster.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

namespace clearway::core {

namespace {

using Eigen::Vector3d;

constexpr double kInfinity = std::numeric_limits<double>::infinity();

// The part of a line within a convex solid: entry and exit with the cosines at both faces.
struct Span {
  double enter = -kInfinity;
  double exit = kInfinity;
  double enter_cos = 0.0;
  double exit_cos = 0.0;

  [[nodiscard]] bool IsEmpty() const { return enter > exit; }

  void Clip(double from, double to, double cosine) {
    if (from > enter) {
      enter = from;
      enter_cos = cosine;
    }
    if (to < exit) {
      exit = to;
      exit_cos = cosine;
    }
  }
};

// Keeps the line's part with -half <= origin + t * direction <= half.
void ClipSlab(double origin, double direction, double half, Span& span) {
  if (direction == 0.0) {
    if (std::abs(origin) > half) span.exit = -kInfinity;
    return;
  }
  const double a = (-half - origin) / direction;
  const double b = (half - origin) / direction;
  span.Clip(std::min(a, b), std::max(a, b), std::abs(direction));
}

Span CrossBox(const Vector3d& origin, const Vector3d& direction, const Vector3d& half) {
  Span span;
  for (Eigen::Index axis = 0; axis < 3; ++axis) {
    ClipSlab(origin[axis], direction[axis], half[axis], span);
    if (span.IsEmpty()) break;
  }
  return span;
}

Span CrossWedge(const Vector3d& origin, const Vector3d& direction, const Vector3d& half) {
  Span span = CrossBox(origin, direction, half);
  if (span.IsEmpty()) return span;
  const Vector3d normal = Vector3d(-half.z(), 0.0, half.x()).normalized();
  const double height = normal.dot(origin);
  const double climb = normal.dot(direction);
  if (climb == 0.0) {
    if (height > 0.0) span.exit = -kInfinity;
  } else if (climb > 0.0) {
    span.Clip(-kInfinity, -height / climb, climb);
  } else {
    span.Clip(-height / climb, kInfinity, -climb);
  }
  return span;
}

Span CrossCylinder(const Vector3d& origin, const Vector3d& direction, const Vector3d& half) {
  Span span;
  ClipSlab(origin.z(), direction.z(), half.z(), span);
  const double radius = half.x();
  const double a = direction.x() * direction.x() + direction.y() * direction.y();
  const double b = origin.x() * direction.x() + origin.y() * direction.y();
  const double c = origin.x() * origin.x() + origin.y() * origin.y() - radius * radius;
  if (a == 0.0) {
    if (c > 0.0) span.exit = -kInfinity;
    return span;
  }
  // The distance of the line from the axis, without the cancellation of b * b - a * c.
  const double cross = origin.x() * direction.y() - origin.y() * direction.x();
  const double discriminant = a * radius * radius - cross * cross;
  if (discriminant < 0.0) {
    span.exit = -kInfinity;
    return span;
  }
  const double root = std::sqrt(discriminant);
  span.Clip((-b - root) / a, (-b + root) / a, root / radius);
  return span;
}

Span Cross(const Primitive& primitive, const Vector3d& origin, const Vector3d& direction) {
  switch (primitive.shape) {
    case Primitive::Shape::kWedge:
      return CrossWedge(origin, direction, primitive.half_extents);
    case Primitive::Shape::kCylinder:
      return CrossCylinder(origin, direction, primitive.half_extents);
    case Primitive::Shape::kBox:
      break;
  }
  return CrossBox(origin, direction, primitive.half_extents);
}

}  // namespace

RayCaster::Solid RayCaster::Prepare(const Primitive& primitive, const Vector3d& origin_map) {
  Solid solid;
  solid.primitive = primitive;
  solid.R_local_map = primitive.T_map_local.linear().transpose();
  solid.origin_local = solid.R_local_map * (origin_map - primitive.T_map_local.translation());
  return solid;
}

RayCaster::Cone RayCaster::ConeOf(const Primitive& primitive, const Vector3d& origin_map) {
  const Vector3d to_centre = primitive.T_map_local.translation() - origin_map;
  const double distance = to_centre.norm();
  const double radius = primitive.half_extents.norm();
  const Vector3d axis = distance > 0.0 ? Vector3d(to_centre / distance) : Vector3d::UnitX();
  // A hair wider than the bounding sphere's cone, so that rounding rejects nothing.
  const double sine = 1.0001 * radius / std::max(distance, 1e-12);
  const double min_cos = sine >= 1.0 ? -2.0 : std::sqrt(1.0 - sine * sine) - 1e-9;
  return {axis.x(), axis.y(), axis.z(), min_cos};
}

void RayCaster::Aim(const SceneGeometry& geometry,
                    const Vector3d& origin_map,
                    const std::optional<ViewCone>& cone) {
  floor_ = geometry.floor;
  origin_map_ = origin_map;
  cones_.clear();
  solids_.clear();
  pits_.clear();
  for (const Primitive& primitive : geometry.primitives) {
    const Cone one = ConeOf(primitive, origin_map);
    if (cone && one.min_cos > -1.0) {
      // Two cones that share no ray: their axes are further apart than both half angles.
      const double between = cone->axis_map.dot(Vector3d(one.x, one.y, one.z));
      const double reach_rad = cone->half_angle_rad + std::acos(std::min(one.min_cos, 1.0)) + 1e-6;
      if (reach_rad < std::numbers::pi && between < std::cos(reach_rad)) continue;
    }
    cones_.push_back(one);
    solids_.push_back(Prepare(primitive, origin_map));
  }
  for (const Pit& pit : geometry.pits) {
    const Primitive hollow{.shape = Primitive::Shape::kBox,
                           .T_map_local = pit.T_map_local,
                           .half_extents = pit.half_extents,
                           .reflectivity = pit.reflectivity,
                           .object = pit.object,
                           .material = Material::kDiffuse};
    pits_.push_back(Prepare(hollow, origin_map));
  }
}

std::optional<RayHit> RayCaster::CastToFloor(const Vector3d& direction_map) const {
  if (!floor_.present || direction_map.z() >= 0.0 || origin_map_.z() <= 0.0) return std::nullopt;
  const double range_m = -origin_map_.z() / direction_map.z();
  for (const Solid& pit : pits_) {
    const Vector3d direction = pit.R_local_map * direction_map;
    const Vector3d& half = pit.primitive.half_extents;
    const Vector3d entry = pit.origin_local + range_m * direction;
    if (std::abs(entry.x()) > half.x() || std::abs(entry.y()) > half.y()) continue;
    const Span span = CrossBox(pit.origin_local, direction, half);
    if (span.IsEmpty()) continue;
    return RayHit{span.exit,
                  span.exit_cos,
                  pit.primitive.reflectivity,
                  pit.primitive.object,
                  Material::kDiffuse};
  }
  return RayHit{range_m, -direction_map.z(), floor_.reflectivity, kFloorObject, floor_.material};
}

std::optional<RayHit> RayCaster::Cast(const Vector3d& direction_map, bool glass_too) const {
  std::optional<RayHit> best = CastToFloor(direction_map);
  double best_range_m = best ? best->range_m : kInfinity;
  for (std::size_t i = 0; i < cones_.size(); ++i) {
    const Cone& cone = cones_[i];
    const double cosine =
        cone.x * direction_map.x() + cone.y * direction_map.y() + cone.z * direction_map.z();
    if (cosine < cone.min_cos) continue;
    const Solid& solid = solids_[i];
    if (!glass_too && solid.primitive.material == Material::kGlass) continue;
    const Span span = Cross(solid.primitive, solid.origin_local, solid.R_local_map * direction_map);
    if (span.IsEmpty() || span.exit <= 0.0) continue;
    const bool is_within = span.enter <= 0.0;
    const double range_m = is_within ? span.exit : span.enter;
    if (range_m >= best_range_m) continue;
    best_range_m = range_m;
    best = RayHit{range_m,
                  is_within ? span.exit_cos : span.enter_cos,
                  solid.primitive.reflectivity,
                  solid.primitive.object,
                  solid.primitive.material};
  }
  return best;
}

}  // namespace clearway::core
