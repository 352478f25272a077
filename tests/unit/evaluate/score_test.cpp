// SPDX-License-Identifier: BSD-3-Clause
#include "tools/evaluate/score.hpp"

#include <numbers>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/unit/evaluate/scenes.hpp"

namespace clearway::evaluate {
namespace {

using test::AddDetection;
using test::MakeBox;
using test::MakePatch;
using testing::DoubleNear;
using testing::Optional;

constexpr double kRounding_m = 1e-5;  // Detections are floats, a few metres away.
const Eigen::Vector3d kPersonSize_m{0.6, 0.6, 1.8};

ObjectScore ScoreOnlyObject(const Scene& scene, const ScoreRules& rules = {}) {
  const SceneScore score = ScoreScene(scene, rules);
  EXPECT_EQ(score.objects.size(), 1U);
  return score.objects.at(0);
}

TEST(ScoreTest, AnExactMatchHasNoErrors) {
  Scene scene;
  scene.boxes = {MakeBox({4.0, 3.0}, kPersonSize_m)};
  AddDetection(scene, MakePatch({4.0F, 3.0F}, 0.6F, 7));

  const ObjectScore score = ScoreOnlyObject(scene);

  EXPECT_TRUE(score.any_evidence);
  EXPECT_TRUE(score.separated);
  EXPECT_TRUE(score.within_radius);
  EXPECT_EQ(score.splits, 0U);
  EXPECT_NEAR(score.range_m, 5.0, kRounding_m);
  EXPECT_THAT(score.centre_error_m, Optional(DoubleNear(0.0, kRounding_m)));
  EXPECT_THAT(score.nearest_error_m, Optional(DoubleNear(0.0, kRounding_m)));
  EXPECT_FALSE(score.yaw_error_rad.has_value());
}

TEST(ScoreTest, ErrorsAreThoseOfTheMatch) {
  Scene scene;
  scene.boxes = {MakeBox({4.0, 0.0}, kPersonSize_m)};
  AddDetection(scene, MakePatch({3.9F, 0.1F}, 0.4F, 7));

  const ObjectScore score = ScoreOnlyObject(scene);

  EXPECT_THAT(score.centre_error_m, Optional(DoubleNear(std::hypot(0.1, 0.1), kRounding_m)));
  // Both come nearest on the x axis: the patch at 3.9 - 0.2, the box at 4.0 - 0.3.
  EXPECT_THAT(score.nearest_error_m, Optional(DoubleNear(0.0, kRounding_m)));
}

TEST(ScoreTest, TheNearestErrorHasNoSign) {
  Scene farther;
  farther.boxes = {MakeBox({4.0, 0.0}, kPersonSize_m)};
  AddDetection(farther, MakePatch({4.1F, 0.0F}, 0.4F, 7));
  Scene nearer;
  nearer.boxes = {MakeBox({4.0, 0.0}, kPersonSize_m)};
  AddDetection(nearer, MakePatch({3.85F, 0.0F}, 0.5F, 7));

  EXPECT_THAT(ScoreOnlyObject(farther).nearest_error_m, Optional(DoubleNear(0.2, kRounding_m)));
  EXPECT_THAT(ScoreOnlyObject(nearer).nearest_error_m, Optional(DoubleNear(0.1, kRounding_m)));
}

TEST(ScoreTest, AMissHasNoErrorsToMeasure) {
  Scene scene;
  scene.boxes = {MakeBox({4.0, 0.0}, kPersonSize_m)};
  AddDetection(scene, MakePatch({8.0F, 0.0F}, 0.4F, 5));

  const ObjectScore score = ScoreOnlyObject(scene);

  EXPECT_FALSE(score.any_evidence);
  EXPECT_FALSE(score.separated);
  EXPECT_FALSE(score.within_radius);
  EXPECT_FALSE(score.centre_error_m.has_value());
  EXPECT_FALSE(score.nearest_error_m.has_value());
}

TEST(ScoreTest, PointsThatNoDetectionHoldsAreNoEvidence) {
  Scene scene;
  scene.boxes = {MakeBox({4.0, 0.0}, kPersonSize_m)};
  scene.points.Add({4.0F, 0.0F, 0.5F});

  EXPECT_FALSE(ScoreOnlyObject(scene).any_evidence);
}

TEST(ScoreTest, AnObjectThatIsPartOfAWallIsEvidenceButNotSeparated) {
  Scene scene;
  scene.boxes = {MakeBox({4.0, 0.0}, kPersonSize_m)};
  std::vector<Eigen::Vector3f> cluster = MakePatch({4.0F, 0.0F}, 0.4F, 5);
  const std::vector<Eigen::Vector3f> wall = MakePatch({4.0F, 3.0F}, 2.0F, 6);
  cluster.insert(cluster.end(), wall.begin(), wall.end());
  AddDetection(scene, cluster);

  const ObjectScore score = ScoreOnlyObject(scene);

  EXPECT_TRUE(score.any_evidence);
  EXPECT_FALSE(score.separated);
}

TEST(ScoreTest, ExactlyHalfOfThePointsSeparates) {
  Scene scene;
  scene.boxes = {MakeBox({4.0, 0.0}, kPersonSize_m)};
  AddDetection(scene, {{3.9F, 0, 0.5F}, {4.1F, 0, 0.5F}, {5.0F, 0, 0.5F}, {5.2F, 0, 0.5F}});
  EXPECT_TRUE(ScoreOnlyObject(scene).separated);

  scene.detections.clear();
  scene.points.Clear();
  AddDetection(
      scene, {{3.9F, 0, 0.5F}, {4.1F, 0, 0.5F}, {5.0F, 0, 0.5F}, {5.2F, 0, 0.5F}, {5.4F, 0, 0.5F}});
  EXPECT_FALSE(ScoreOnlyObject(scene).separated);
}

TEST(ScoreTest, FurtherDetectionsOfTheSameObjectAreSplits) {
  Scene scene;
  scene.boxes = {MakeBox({4.0, 0.0}, {1.0, 1.0, 1.8})};
  AddDetection(scene, MakePatch({3.7F, -0.3F}, 0.2F, 3));
  AddDetection(scene, MakePatch({4.2F, 0.2F}, 0.3F, 6));
  AddDetection(scene, MakePatch({3.7F, 0.3F}, 0.2F, 4));
  AddDetection(scene, MakePatch({6.0F, 0.0F}, 0.2F, 4));

  const ObjectScore score = ScoreOnlyObject(scene);

  EXPECT_TRUE(score.separated);
  EXPECT_EQ(score.splits, 2U);
  EXPECT_THAT(score.centre_error_m, Optional(DoubleNear(std::hypot(0.2, 0.2), kRounding_m)))
      << "the match is the one with most points, not the first or the nearest one";
}

TEST(ScoreTest, OneDetectionOfTwoObjectsIsAMerge) {
  Scene scene;
  scene.boxes = {MakeBox({4.0, 0.5}, kPersonSize_m), MakeBox({4.0, -0.5}, kPersonSize_m)};
  std::vector<Eigen::Vector3f> cluster = MakePatch({4.0F, 0.5F}, 0.4F, 5);
  const std::vector<Eigen::Vector3f> other = MakePatch({4.0F, -0.5F}, 0.4F, 5);
  cluster.insert(cluster.end(), other.begin(), other.end());
  AddDetection(scene, cluster);

  const SceneScore score = ScoreScene(scene, {});

  EXPECT_EQ(score.merges, 1U);
  EXPECT_TRUE(score.objects[0].any_evidence);
  EXPECT_TRUE(score.objects[1].any_evidence);
}

TEST(ScoreTest, AFewStrayPointsOfAnotherObjectAreNoMerge) {
  Scene scene;
  scene.boxes = {MakeBox({4.0, 0.5}, kPersonSize_m), MakeBox({4.0, -0.5}, kPersonSize_m)};
  std::vector<Eigen::Vector3f> cluster = MakePatch({4.0F, 0.5F}, 0.4F, 6);
  for (int i = 0; i < 3; ++i) cluster.emplace_back(4.0F, -0.5F, 0.5F);  // 3 of 39.
  AddDetection(scene, cluster);
  EXPECT_EQ(ScoreScene(scene, {}).merges, 0U);

  Scene more = scene;
  more.points.Add({4.0F, -0.5F, 0.5F});  // 4 of 40.
  EXPECT_EQ(ScoreScene(more, {}).merges, 1U);
}

TEST(ScoreTest, TwoObjectsWithADetectionEachAreNeitherMergedNorSplit) {
  Scene scene;
  scene.boxes = {MakeBox({4.0, 1.0}, kPersonSize_m), MakeBox({4.0, -1.0}, kPersonSize_m)};
  AddDetection(scene, MakePatch({4.0F, -1.0F}, 0.4F, 5));
  AddDetection(scene, MakePatch({4.0F, 1.0F}, 0.4F, 5));

  const SceneScore score = ScoreScene(scene, {});

  EXPECT_EQ(score.merges, 0U);
  for (const ObjectScore& object : score.objects) {
    EXPECT_TRUE(object.separated);
    EXPECT_EQ(object.splits, 0U);
  }
}

TEST(ScoreTest, ATurnedBoxIsNotItsAlignedOne) {
  // A point beside the middle of a long box lies in it only when the box is turned towards it.
  Scene scene;
  AddDetection(scene, {{5.0F, 1.5F, 0.5F}});

  scene.boxes = {MakeBox({5.0, 0.0}, {4.0, 1.0, 1.5}, 0.0)};
  EXPECT_FALSE(ScoreOnlyObject(scene).any_evidence);
  scene.boxes = {MakeBox({5.0, 0.0}, {4.0, 1.0, 1.5}, 0.5 * std::numbers::pi)};
  EXPECT_TRUE(ScoreOnlyObject(scene).any_evidence);
}

TEST(ScoreTest, TheHeadingOfACarIsMeasuredModuloAQuarterTurn) {
  constexpr double kTolerance_rad = 0.02;  // The sweep goes in steps of a degree.
  const double detected_rad = 10.0 * std::numbers::pi / 180.0;
  const double labelled_rad = detected_rad + 0.5 * std::numbers::pi - 0.1;
  std::vector<Eigen::Vector3f> car;
  const Eigen::Rotation2Df turn(static_cast<float>(detected_rad));
  for (const Eigen::Vector3f& point : MakePatch({0.0F, 0.0F}, 1.6F, 9)) {
    const Eigen::Vector2f stretched(2.0F * point.x(), point.y());
    const Eigen::Vector2f xy = turn * stretched + Eigen::Vector2f(10.0F, 0.0F);
    car.emplace_back(xy.x(), xy.y(), 0.5F);
  }
  Scene scene;
  AddDetection(scene, car);

  for (const char* kind : {"Car", "Van", "Truck", "car"}) {
    scene.boxes = {MakeBox({10.0, 0.0}, {4.0, 4.0, 1.5}, labelled_rad, kind)};
    EXPECT_THAT(ScoreOnlyObject(scene).yaw_error_rad, Optional(DoubleNear(0.1, kTolerance_rad)));
  }
  scene.boxes = {MakeBox({10.0, 0.0}, {4.0, 4.0, 1.5}, labelled_rad, "Cyclist")};
  EXPECT_FALSE(ScoreOnlyObject(scene).yaw_error_rad.has_value());
}

TEST(ScoreTest, TheToleranceMovesTheFacesOutwards) {
  Scene scene;
  scene.boxes = {MakeBox({4.0, 0.0}, kPersonSize_m)};
  AddDetection(scene, {{4.399F, 0.0F, 0.5F}});

  EXPECT_TRUE(ScoreOnlyObject(scene, {.tolerance_m = 0.1}).any_evidence);
  EXPECT_FALSE(ScoreOnlyObject(scene, {.tolerance_m = 0.098}).any_evidence);
}

TEST(ScoreTest, TheRadiusIsHorizontalAndClosed) {
  Scene scene;
  scene.boxes = {MakeBox({4.0, 0.0}, {0.25, 0.25, 9.0})};
  AddDetection(scene, {{4.5F, 0.0F, 0.5F}});

  EXPECT_TRUE(ScoreOnlyObject(scene, {.radius_m = 0.5}).within_radius);
  EXPECT_FALSE(ScoreOnlyObject(scene, {.radius_m = 0.499}).within_radius);
  EXPECT_FALSE(ScoreOnlyObject(scene, {.radius_m = 0.5}).any_evidence);
}

TEST(ScoreTest, BoxesWithFewPointsAreCountedNotScored) {
  Scene scene;
  scene.boxes = {MakeBox({4.0, 0.0}, kPersonSize_m), MakeBox({6.0, 0.0}, kPersonSize_m)};
  scene.boxes[0].points = 9;
  scene.boxes[1].points = 10;

  const SceneScore score = ScoreScene(scene, {.min_points = 10});

  EXPECT_EQ(score.few_points, 1U);
  ASSERT_EQ(score.objects.size(), 1U);
  EXPECT_NEAR(score.objects[0].range_m, 6.0, kRounding_m);
}

TEST(ScoreTest, BoxesOutOfRangeAreCountedNotScored) {
  Scene scene;
  scene.boxes = {MakeBox({59.9, 0.0}, kPersonSize_m), MakeBox({0.0, -60.0}, kPersonSize_m)};

  const SceneScore score = ScoreScene(scene, {});

  EXPECT_EQ(score.objects.size(), 1U);
  EXPECT_EQ(score.out_of_range, 1U);
}

TEST(ScoreTest, WithoutLabelsOnlyDetectionsAreCounted) {
  Scene scene;
  AddDetection(scene, MakePatch({4.0F, 0.0F}, 0.4F, 5));

  const SceneScore score = ScoreScene(scene, {});

  EXPECT_EQ(score.detections, 1U);
  EXPECT_TRUE(score.objects.empty());
  EXPECT_EQ(score.merges, 0U);
}

TEST(ScoreTest, WithoutDetectionsEveryObjectIsMissed) {
  Scene scene;
  scene.boxes = {MakeBox({4.0, 0.0}, kPersonSize_m), MakeBox({9.0, 0.0}, kPersonSize_m)};

  const SceneScore score = ScoreScene(scene, {});

  ASSERT_EQ(score.objects.size(), 2U);
  EXPECT_FALSE(score.objects[0].any_evidence);
  EXPECT_FALSE(score.objects[1].any_evidence);
  EXPECT_EQ(score.detections, 0U);
}

}  // namespace
}  // namespace clearway::evaluate
