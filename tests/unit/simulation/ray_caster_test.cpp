// SPDX-License-Identifier: BSD-3-Clause
#include "common/core/simulation/ray_caster.hpp"

#include <cmath>
#include <cstdint>
#include <numbers>

#include <gtest/gtest.h>

#include "common/core/simulation/noise.hpp"
#include "common/core/simulation/scene_geometry.hpp"

namespace clearway::core {
namespace {

using Eigen::Vector3d;

// The oracle: whether a point is within something solid, from the elements themselves and not
// from the primitives that the caster uses. Index of the object, kFloorObject or kNoObject.
class Solidity {
 public:
  explicit Solidity(const SceneConfig& scene) : scene_(scene) {}

  std::int32_t At(const Vector3d& p) const {
    std::int32_t index = 0;
    for (const SceneRoom& room : scene_.rooms) {
      if (IsInRoomShell(room, p)) return index;
      ++index;
    }
    for (const SceneBox& box : scene_.boxes) {
      if (IsInBox(Local(box.object, p), box.length_m, box.width_m, box.height_m)) return index;
      ++index;
    }
    for (const SceneCylinder& c : scene_.cylinders) {
      const Vector3d q = Local(c.object, p);
      if (std::hypot(q.x(), q.y()) <= c.radius_m && q.z() >= 0 && q.z() <= c.height_m) return index;
      ++index;
    }
    for (const SceneCable& c : scene_.cables) {
      const Vector3d q = Local(c.object, p);
      const double radius_m = 0.5 * c.diameter_m;
      if (std::abs(q.x()) <= 0.5 * c.length_m && std::hypot(q.y(), q.z() - radius_m) <= radius_m) {
        return index;
      }
      ++index;
    }
    for (const SceneRamp& r : scene_.ramps) {
      const Vector3d q = Local(r.object, p);
      const double rise_m = r.height_m * (q.x() / r.length_m + 0.5);
      if (IsInBox(q, r.length_m, r.width_m, r.height_m) && q.z() <= rise_m) return index;
      ++index;
    }
    if (p.z() > 0.0) return kNoObject;
    for (const SceneHole& h : scene_.holes) {
      const Vector3d q = Local(h.object, p);
      const bool is_under =
          std::abs(q.x()) <= 0.5 * h.length_m && std::abs(q.y()) <= 0.5 * h.width_m;
      if (is_under && q.z() > -h.depth_m) return kNoObject;
    }
    return kFloorObject;
  }

 private:
  static Vector3d Local(const SceneObject& object, const Vector3d& p) {
    const double c = std::cos(object.yaw_rad);
    const double s = std::sin(object.yaw_rad);
    const double dx = p.x() - object.x_m;
    const double dy = p.y() - object.y_m;
    return {c * dx + s * dy, -s * dx + c * dy, p.z() - object.z_m};
  }
  static bool IsInBox(const Vector3d& q, double length_m, double width_m, double height_m) {
    return std::abs(q.x()) <= 0.5 * length_m && std::abs(q.y()) <= 0.5 * width_m && q.z() >= 0.0 &&
           q.z() <= height_m;
  }
  static bool IsInRoomShell(const SceneRoom& room, const Vector3d& p) {
    const bool is_inside = p.x() > room.x_min_m && p.x() < room.x_max_m && p.y() > room.y_min_m &&
                           p.y() < room.y_max_m && p.z() < room.height_m;
    return !is_inside && p.z() >= 0.0;
  }

  const SceneConfig& scene_;
};

SceneConfig ManyShapes() {
  SceneConfig scene;
  scene.rooms.resize(1);
  scene.boxes.resize(3);
  scene.boxes[0] = {{.x_m = 3.0, .y_m = 2.0, .yaw_rad = 0.4}, 0.5, 0.3, 0.4};
  scene.boxes[1] = {{.x_m = 5.0, .y_m = 4.0, .z_m = 0.6, .yaw_rad = -1.2}, 1.2, 0.2, 0.1};
  scene.boxes[2] = {{.x_m = 1.5, .y_m = 4.5, .yaw_rad = 2.0}, 0.1, 0.1, 0.1};
  scene.cylinders.resize(2);
  scene.cylinders[0] = {{.x_m = 4.0, .y_m = 2.5}, 0.3, 1.0};
  scene.cylinders[1] = {{.x_m = 2.5, .y_m = 3.5, .z_m = 0.2}, 0.035, 1.5};
  scene.cables.resize(1);
  scene.cables[0] = {{.x_m = 2.0, .y_m = 2.0, .yaw_rad = 0.9}, 1.0, 0.08};
  scene.ramps.resize(1);
  scene.ramps[0] = {{.x_m = 6.0, .y_m = 2.0, .yaw_rad = 2.8}, 1.5, 1.0, 0.5};
  scene.holes.resize(1);
  scene.holes[0] = {{.x_m = 2.2, .y_m = 2.8, .yaw_rad = 0.5}, 0.8, 0.5, 0.3};
  return scene;
}

double Uniform(std::uint64_t counter) {
  return static_cast<double>(SplitMix64(counter) >> 11U) * 0x1.0p-53;
}

Vector3d RandomDirection(std::uint64_t counter) {
  const double z = 2.0 * Uniform(2 * counter) - 1.0;
  const double angle = 2.0 * std::numbers::pi * Uniform(2 * counter + 1);
  const double r = std::sqrt(1.0 - z * z);
  return {r * std::cos(angle), r * std::sin(angle), z};
}

TEST(RayCaster, FindsTheFirstSolidThatARayMarchesInto) {
  constexpr double kStep_m = 0.002;
  constexpr double kMargin_m = 1e-6;
  const SceneConfig scene = ManyShapes();
  const Solidity solid(scene);
  const Vector3d origin(0.7, 3.0, 0.5);
  const RayCaster caster(GeometryAt(scene, 0), origin);
  int num_objects_met[16] = {};

  for (std::uint64_t i = 0; i < 3000; ++i) {
    const Vector3d direction = RandomDirection(i + 7000);
    const auto hit = caster.Cast(direction);

    ASSERT_TRUE(hit) << "ray " << i << " leaves a closed room";
    // Nothing solid before the hit.
    for (double s = kStep_m; s < hit->range_m - kMargin_m; s += kStep_m) {
      ASSERT_EQ(solid.At(origin + s * direction), kNoObject) << "ray " << i << " at " << s;
    }
    // The object's inside begins at the hit.
    ASSERT_EQ(solid.At(origin + (hit->range_m - kMargin_m) * direction), kNoObject) << "ray " << i;
    const std::int32_t met = solid.At(origin + (hit->range_m + kMargin_m) * direction);
    // Walls and bottom of a hole belong to the hole; around it there is only floor.
    const bool is_hole = hit->object == 8;
    ASSERT_EQ(met, is_hole ? kFloorObject : hit->object) << "ray " << i;
    ++num_objects_met[hit->object == kFloorObject ? 15 : hit->object];
  }

  for (const int object : {0, 1, 2, 4, 5, 6, 7, 8, 15}) {
    EXPECT_GT(num_objects_met[object], 0) << "no ray met object " << object;
  }
}

TEST(RayCaster, RejectsNothingThatASingleSolidWouldShow) {
  const SceneConfig scene = ManyShapes();
  const Vector3d origin(0.7, 3.0, 0.5);
  const SceneGeometry all = GeometryAt(scene, 0);
  const RayCaster caster(all, origin);

  for (std::uint64_t i = 0; i < 20'000; ++i) {
    const Vector3d direction = RandomDirection(i);
    double nearest_m = 1e9;
    for (const Primitive& primitive : all.primitives) {
      const SceneGeometry alone{.floor = {.present = false}, .primitives = {primitive}, .pits = {}};
      const auto hit = RayCaster(alone, origin).Cast(direction);
      if (hit) nearest_m = std::min(nearest_m, hit->range_m);
    }
    const auto hit = caster.Cast(direction);

    ASSERT_LE(hit->range_m, nearest_m);
    if (hit->object >= 0 && hit->object != 8) {
      ASSERT_EQ(hit->range_m, nearest_m);
    }
  }
}

TEST(RayCaster, GivesTheAngleOfIncidence) {
  constexpr double kExact = 1e-12;
  SceneConfig scene;
  scene.boxes = {{{.x_m = 3.0, .y_m = 0.0}, 1.0, 4.0, 4.0}};
  scene.boxes[0].object.reflectivity = 0.7;
  const RayCaster caster(GeometryAt(scene, 0), Vector3d(0.0, 0.0, 1.0));
  const double slant_rad = 0.3;

  const auto wall = caster.Cast(Vector3d(std::cos(slant_rad), std::sin(slant_rad), 0.0));
  const auto floor = caster.Cast(Vector3d(0.0, 0.6, -0.8));

  ASSERT_TRUE(wall && floor);
  EXPECT_NEAR(wall->range_m, 2.5 / std::cos(slant_rad), kExact);
  EXPECT_NEAR(wall->incidence_cos, std::cos(slant_rad), kExact);
  EXPECT_EQ(wall->reflectivity, 0.7);
  EXPECT_EQ(floor->object, kFloorObject);
  EXPECT_NEAR(floor->range_m, 1.25, kExact);
  EXPECT_NEAR(floor->incidence_cos, 0.8, kExact);
}

TEST(RayCaster, SeesASolidFromWithin) {
  SceneConfig scene;
  scene.floor.present = false;
  scene.cylinders = {{{.x_m = 0.0, .y_m = 0.0}, 2.0, 3.0}};
  const RayCaster caster(GeometryAt(scene, 0), Vector3d(0.0, 0.0, 1.0));

  const auto side = caster.Cast(Vector3d::UnitY());
  const auto top = caster.Cast(Vector3d::UnitZ());

  ASSERT_TRUE(side && top);
  EXPECT_DOUBLE_EQ(side->range_m, 2.0);
  EXPECT_DOUBLE_EQ(top->range_m, 2.0);
}

TEST(RayCaster, MeetsNothingInAnEmptyScene) {
  SceneConfig scene;
  scene.floor.present = false;
  const RayCaster caster(GeometryAt(scene, 0), Vector3d(0.0, 0.0, 1.0));

  for (std::uint64_t i = 0; i < 100; ++i) EXPECT_FALSE(caster.Cast(RandomDirection(i)));
}

}  // namespace
}  // namespace clearway::core
