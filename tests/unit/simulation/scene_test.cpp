// SPDX-License-Identifier: BSD-3-Clause
#include "common/core/simulation/scene.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "common/core/simulation/scene_geometry.hpp"

namespace clearway::core {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

constexpr double kExact = 1e-9;

// Goes 2 m along x, waits 1 s, goes 1 m along y.
SceneObject Walker() {
  SceneObject object;
  object.name = "walker";
  object.x_m = 1.0;
  object.y_m = 1.0;
  object.start_s = 10.0;
  object.speed_mps = 2.0;
  object.waypoints = {{3.0, 1.0, 1.0}, {3.0, 2.0, 0.0}};
  return object;
}

ScenePerson Person() {
  ScenePerson person;
  person.object = Walker();
  return person;
}

TEST(SceneMotion, StandsAtItsStartUntilItStarts) {
  SceneObject object = Walker();
  object.yaw_rad = 0.3;

  const SceneMotion motion = MotionAt(object, 9.999);

  EXPECT_EQ(motion.x_m, 1.0);
  EXPECT_EQ(motion.y_m, 1.0);
  EXPECT_EQ(motion.yaw_rad, 0.3);
  EXPECT_EQ(motion.vx_mps, 0.0);
}

TEST(SceneMotion, GoesStraightToItsWaypointsAndFacesThem) {
  const SceneMotion first = MotionAt(Walker(), 10.5);
  const SceneMotion waiting = MotionAt(Walker(), 11.7);
  const SceneMotion second = MotionAt(Walker(), 12.25);
  const SceneMotion after = MotionAt(Walker(), 99.0);

  EXPECT_NEAR(first.x_m, 2.0, kExact);
  EXPECT_NEAR(first.vx_mps, 2.0, kExact);
  EXPECT_NEAR(waiting.x_m, 3.0, kExact);
  EXPECT_EQ(waiting.vx_mps, 0.0);
  EXPECT_NEAR(second.y_m, 1.5, kExact);
  EXPECT_NEAR(second.yaw_rad, std::numbers::pi / 2.0, kExact);
  EXPECT_NEAR(second.vy_mps, 2.0, kExact);
  EXPECT_NEAR(after.y_m, 2.0, kExact);
  EXPECT_NEAR(after.distance_m, 3.0, kExact);
}

TEST(SceneMotion, RepeatsItsRoundWhenItLoops) {
  SceneObject object = Walker();
  object.loop = true;
  const double round_s = 1.0 + 1.0 + 0.5 + std::hypot(2.0, 1.0) / 2.0;

  for (double t_s = 0.0; t_s < round_s; t_s += 0.1) {
    const SceneMotion once = MotionAt(object, 10.0 + t_s);
    const SceneMotion later = MotionAt(object, 10.0 + t_s + 3.0 * round_s);
    EXPECT_NEAR(once.x_m, later.x_m, 1e-6);
    EXPECT_NEAR(once.y_m, later.y_m, 1e-6);
  }
}

TEST(SceneMotion, NeverJumps) {
  constexpr double kStep_s = 0.001;
  SceneObject object = Walker();
  object.loop = true;

  SceneMotion last = MotionAt(object, 0.0);
  for (double t_s = kStep_s; t_s < 40.0; t_s += kStep_s) {
    const SceneMotion now = MotionAt(object, t_s);
    ASSERT_LE(std::hypot(now.x_m - last.x_m, now.y_m - last.y_m), 2.0 * kStep_s + kExact);
    last = now;
  }
}

TEST(SceneMotion, StandsWhenAllWaypointsAreItsStart) {
  SceneObject object = Walker();
  object.loop = true;
  object.waypoints = {{1.0, 1.0, 0.0}};

  EXPECT_EQ(MotionAt(object, 50.0).x_m, 1.0);
}

TEST(SceneObject, IsThereFromAppearUntilVanish) {
  SceneObject object;
  object.appear_s = 2.0;
  object.vanish_s = 3.0;

  EXPECT_FALSE(IsPresent(object, 1.999));
  EXPECT_TRUE(IsPresent(object, 2.0));
  EXPECT_TRUE(IsPresent(object, 2.999));
  EXPECT_FALSE(IsPresent(object, 3.0));
  EXPECT_TRUE(IsPresent(SceneObject{}, 0.0));
}

TEST(SceneValidate, AcceptsWhatIsRight) {
  SceneConfig scene;
  scene.persons = {Person()};

  EXPECT_THAT(scene.Validate(), IsEmpty());
  EXPECT_THAT(Person().Validate(), IsEmpty());
  EXPECT_THAT(SceneShelf{}.Validate(), IsEmpty());
  EXPECT_THAT(SceneTable{}.Validate(), IsEmpty());
  EXPECT_THAT(SceneRoom{}.Validate(), IsEmpty());
  EXPECT_THAT(SceneWall{}.Validate(), IsEmpty());
}

TEST(SceneValidate, NamesTheObjectThatBreaksARule) {
  SceneBox box;
  box.object.name = "crate";
  box.object.appear_s = 5.0;
  box.object.vanish_s = 4.0;
  box.object.speed_mps = 1.0;
  ScenePerson standing = Person();
  standing.object.speed_mps = 0.0;

  EXPECT_THAT(box.Validate(),
              ElementsAre(HasSubstr("box \"crate\": vanish_s must be later"),
                          HasSubstr("need at least one waypoint")));
  EXPECT_THAT(standing.Validate(), ElementsAre(HasSubstr("speed_mps must be more than 0")));
}

TEST(SceneValidate, RefusesShapesThatCannotBe) {
  SceneShelf shelf;
  shelf.num_boards = 50;
  shelf.board_thickness_m = 0.1;
  SceneTable table;
  table.overhang_m = 0.5;
  SceneHole hole;
  hole.object.z_m = 0.1;
  SceneWall wall;
  wall.x2_m = wall.x1_m;
  wall.y2_m = wall.y1_m;
  SceneRoom room;
  room.x_max_m = room.x_min_m;

  EXPECT_THAT(shelf.Validate(), ElementsAre(HasSubstr("boards")));
  EXPECT_THAT(table.Validate(), ElementsAre(HasSubstr("legs")));
  EXPECT_THAT(hole.Validate(), ElementsAre(HasSubstr("z_m must be 0")));
  EXPECT_THAT(wall.Validate(), ElementsAre(HasSubstr("two different points")));
  EXPECT_THAT(room.Validate(), ElementsAre(HasSubstr("x_min_m must be less than x_max_m")));
}

TEST(SceneValidate, WantsUniqueNames) {
  SceneConfig scene;
  scene.boxes.resize(3);
  scene.boxes[0].object.name = "a";
  scene.boxes[1].object.name = "a";

  EXPECT_THAT(scene.Validate(),
              ElementsAre(HasSubstr("\"a\" stands for more than one object"),
                          HasSubstr("Every box of the scene needs a name")));
}

TEST(TruthBoxes, FollowTheObjectsThatArePresent) {
  SceneConfig scene;
  scene.rooms.resize(1);
  scene.boxes.resize(1);
  scene.boxes[0].object.name = "late";
  scene.boxes[0].object.appear_s = 20.0;
  scene.persons = {Person()};

  const auto early = TruthBoxesAt(scene, 10'500'000);
  const auto late = TruthBoxesAt(scene, 20'000'000);

  ASSERT_EQ(early.size(), 1U);
  EXPECT_EQ(early[0].name, "walker");
  EXPECT_EQ(early[0].object, 2);
  EXPECT_NEAR(early[0].center.x(), 2.0, kExact);
  EXPECT_NEAR(early[0].center.z(), 0.875, kExact);
  EXPECT_NEAR(early[0].velocity_mps.x(), 2.0, kExact);
  ASSERT_EQ(late.size(), 2U);
  EXPECT_EQ(late[0].object, 1);
  EXPECT_EQ(late[0].kind, ObjectKind::kBox);
}

TEST(TruthBoxes, EncloseTheSolidsOfTheirObject) {
  SceneConfig scene;
  scene.walls.resize(1);
  scene.boxes.resize(1);
  scene.cylinders.resize(1);
  scene.shelves.resize(1);
  scene.tables.resize(1);
  scene.cables.resize(1);
  scene.ramps.resize(1);
  scene.persons = {Person()};
  const auto turn = [](auto& list) { list[0].object.yaw_rad = 0.7; };
  turn(scene.boxes);
  turn(scene.shelves);
  turn(scene.tables);
  turn(scene.cables);
  turn(scene.ramps);

  for (std::int64_t t_us = 10'000'000; t_us < 13'000'000; t_us += 130'000) {
    const auto boxes = TruthBoxesAt(scene, t_us);
    for (const Primitive& solid : GeometryAt(scene, t_us).primitives) {
      const auto box = std::find_if(
          boxes.begin(), boxes.end(), [&](const auto& b) { return b.object == solid.object; });
      ASSERT_NE(box, boxes.end());
      // Points all around the rim of an upright cylinder, corners of the others.
      for (int i = 0; i < 64; ++i) {
        const bool is_round =
            solid.shape == Primitive::Shape::kCylinder && box->kind != ObjectKind::kCable;
        const double angle = is_round ? 0.1 * i : std::numbers::pi * (0.25 + 0.5 * i);
        const double reach = is_round ? 1.0 : std::sqrt(2.0);
        const Eigen::Vector3d local(reach * std::cos(angle) * solid.half_extents.x(),
                                    reach * std::sin(angle) * solid.half_extents.y(),
                                    (i % 8 < 4 ? 1.0 : -1.0) * solid.half_extents.z());
        const Eigen::Vector3d in_box = Eigen::AngleAxisd(-box->yaw_rad, Eigen::Vector3d::UnitZ()) *
                                       (solid.T_map_local * local - box->center);
        EXPECT_LE(std::abs(in_box.x()), 0.5 * box->length_m + kExact) << KindName(box->kind);
        EXPECT_LE(std::abs(in_box.y()), 0.5 * box->width_m + kExact) << KindName(box->kind);
        EXPECT_LE(std::abs(in_box.z()), 0.5 * box->height_m + kExact) << KindName(box->kind);
      }
    }
  }
}

}  // namespace
}  // namespace clearway::core
