// SPDX-License-Identifier: BSD-3-Clause
// The shipped scene, read as the simulator reads it.
#include <algorithm>
#include <cstdint>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "common/config/config.hpp"
#include "common/core/simulation/lidar_scan.hpp"
#include "common/core/simulation/scene.hpp"
#include "common/core/simulation/scene_geometry.hpp"
#include "tests/support/test_data.hpp"

namespace clearway::core {
namespace {

using testing::Contains;
using testing::HasSubstr;
using testing::Not;
using testing::UnorderedElementsAre;

SceneConfig LabScene() {
  return config::Load<SceneFile>(test::SourceFolder() / "config" / "lab_scene.xml").root.scene;
}

std::vector<std::string> NamesAt(const SceneConfig& scene, std::int64_t time_us) {
  std::vector<std::string> names;
  for (const TruthBox& box : TruthBoxesAt(scene, time_us)) names.push_back(box.name);
  return names;
}

TEST(LabScene, HoldsWhatItsFileSays) {
  const SceneConfig scene = LabScene();

  ASSERT_EQ(scene.rooms.size(), 1U);
  EXPECT_EQ(scene.rooms[0].x_max_m, 8.0);
  EXPECT_EQ(scene.rooms[0].y_max_m, 6.0);
  ASSERT_EQ(scene.persons.size(), 1U);
  EXPECT_EQ(scene.persons[0].object.waypoints.size(), 1U);
  EXPECT_THAT(NamesAt(scene, 0),
              UnorderedElementsAre("partition",
                                   "shelf",
                                   "workbench",
                                   "crate",
                                   "small_box",
                                   "parcel",
                                   "thin_post",
                                   "cable",
                                   "walker"));
}

TEST(LabScene, HasASuddenObstacleForEightSeconds) {
  const SceneConfig scene = LabScene();

  EXPECT_THAT(NamesAt(scene, 5'999'999), Not(Contains("sudden_box")));
  EXPECT_THAT(NamesAt(scene, 6'000'000), Contains("sudden_box"));
  EXPECT_THAT(NamesAt(scene, 14'000'000), Not(Contains("sudden_box")));
}

TEST(LabScene, KeepsEverythingWithinTheRoom) {
  const SceneConfig scene = LabScene();
  const SceneRoom& room = scene.rooms[0];

  for (std::int64_t t_us = 0; t_us < 20'000'000; t_us += 250'000) {
    for (const TruthBox& box : TruthBoxesAt(scene, t_us)) {
      EXPECT_GT(box.center.x(), room.x_min_m) << box.name;
      EXPECT_LT(box.center.x(), room.x_max_m) << box.name;
      EXPECT_GT(box.center.y(), room.y_min_m) << box.name;
      EXPECT_LT(box.center.y(), room.y_max_m) << box.name;
    }
  }
}

TEST(LabScene, IsSeenFromTheDoor) {
  const SceneConfig scene = LabScene();
  ScanRequest request;
  request.T_map_vehicle = Eigen::Isometry3d(Eigen::Translation3d(0.5, 3.0, 0.0));
  request.T_vehicle_sensor = Eigen::Isometry3d(Eigen::Translation3d(0.0, 0.0, 0.35));
  request.begin_us = 7'000'000;
  request.duration_us = 1'000'000;

  const SimulatedScan scan = GenerateScan(scene, {}, request);

  // After a second of shots, every object of the scene has returned some of them.
  for (const TruthBox& box : TruthBoxesAt(scene, request.begin_us)) {
    const auto count = std::count(scan.objects.begin(), scan.objects.end(), box.object);
    EXPECT_GE(count, 5) << box.name;
  }
}

TEST(SceneFile, SaysWhereItIsWrong) {
  const std::string text = R"(<clearway version="1"><scene>
<box name="a" appear_s="5" vanish_s="4"/>
<person name="b" sped_mps="1"/>
</scene></clearway>)";

  try {
    (void)config::Parse<SceneFile>(text, "bad.xml");
    FAIL() << "no exception";
  } catch (const config::ConfigError& error) {
    EXPECT_THAT(error.what(), HasSubstr("vanish_s must be later than appear_s"));
    EXPECT_THAT(error.what(), HasSubstr("bad.xml:3"));
    EXPECT_THAT(error.what(), HasSubstr("speed_mps"));
  }
}

}  // namespace
}  // namespace clearway::core
