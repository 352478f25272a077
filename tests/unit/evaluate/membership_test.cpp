// SPDX-License-Identifier: BSD-3-Clause
#include "tools/evaluate/membership.hpp"

#include <cmath>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/unit/evaluate/scenes.hpp"

namespace clearway::evaluate {
namespace {

using testing::ElementsAre;
using testing::Optional;

core::Detection MakeDetection(std::vector<Eigen::Vector2f> hull) {
  core::Detection detection;
  detection.hull = std::move(hull);
  detection.z_min_m = 0.0F;
  detection.z_max_m = 1.0F;
  return detection;
}

core::PointCloud MakeCloud(const std::vector<Eigen::Vector3f>& points) {
  core::PointCloud cloud;
  for (const Eigen::Vector3f& point : points) cloud.Add(point);
  return cloud;
}

const std::vector<Eigen::Vector2f> kUnitSquare{{0, 0}, {1, 0}, {1, 1}, {0, 1}};

TEST(MembershipTest, EveryPointOfALoneClusterIsItsOwn) {
  Scene scene;
  test::AddDetection(scene, test::MakePatch({3.0F, 1.0F}, 0.7F, 9));

  const auto members = PointsOfDetections(scene.points, scene.detections);

  ASSERT_EQ(members.size(), 1U);
  EXPECT_EQ(members[0].size(), 81U);
}

TEST(MembershipTest, AHullIsGrownByAMillimetre) {
  const std::vector detections{MakeDetection(kUnitSquare)};

  const auto owners = DetectionsOfPoints(
      MakeCloud({{1.0009F, 0.5F, 0.5F}, {1.0011F, 0.5F, 0.5F}, {1.0009F, 1.0009F, 0.5F}}),
      detections);

  EXPECT_THAT(owners, ElementsAre(Optional(0U), std::nullopt, std::nullopt));
}

TEST(MembershipTest, TheRangeOfHeightsIsClosed) {
  const std::vector detections{MakeDetection(kUnitSquare)};

  const auto owners = DetectionsOfPoints(
      MakeCloud({{0.5F, 0.5F, 0.0F}, {0.5F, 0.5F, 1.0F}, {0.5F, 0.5F, 1.01F}}), detections);

  EXPECT_THAT(owners, ElementsAre(Optional(0U), Optional(0U), std::nullopt));
}

TEST(MembershipTest, HullsOfOneAndTwoPointsHoldTheirPoints) {
  const std::vector detections{MakeDetection({{5, 5}}), MakeDetection({{0, 0}, {2, 2}})};

  const auto owners = DetectionsOfPoints(
      MakeCloud({{5.0F, 5.0F, 0.5F}, {1.0F, 1.0F, 0.5F}, {1.0F, 1.1F, 0.5F}, {3.0F, 3.0F, 0.5F}}),
      detections);

  EXPECT_THAT(owners, ElementsAre(Optional(0U), Optional(1U), std::nullopt, std::nullopt));
}

TEST(MembershipTest, WhatStandsInFrontOfAWallRoundACornerIsNotTheWalls) {
  Scene scene;
  std::vector<Eigen::Vector3f> wall;
  for (int i = 0; i <= 100; ++i) {
    const float along_m = 0.05F * static_cast<float>(i);
    wall.emplace_back(5.0F, along_m, 0.5F);
    wall.emplace_back(along_m, 5.0F, 0.5F);
  }
  test::AddDetection(scene, wall);
  test::AddDetection(scene, test::MakePatch({4.0F, 4.0F}, 0.4F, 5));

  const auto members = PointsOfDetections(scene.points, scene.detections);

  EXPECT_EQ(members[0].size(), wall.size());
  EXPECT_EQ(members[1].size(), 25U);
}

TEST(MembershipTest, OfEqualHullsTheFirstTakesThePoint) {
  const std::vector detections{MakeDetection(kUnitSquare), MakeDetection(kUnitSquare)};

  EXPECT_THAT(DetectionsOfPoints(MakeCloud({{0.5F, 0.5F, 0.5F}}), detections),
              ElementsAre(Optional(0U)));
}

TEST(MembershipTest, PointsThatAreNotFiniteAndEmptyHullsMatchNothing) {
  const std::vector detections{MakeDetection({}), MakeDetection(kUnitSquare)};

  const auto owners = DetectionsOfPoints(
      MakeCloud({{NAN, 0.5F, 0.5F}, {0.5F, INFINITY, 0.5F}, {0.5F, 0.5F, NAN}}), detections);

  EXPECT_THAT(owners, ElementsAre(std::nullopt, std::nullopt, std::nullopt));
}

TEST(MembershipTest, NoDetectionsOwnNothing) {
  EXPECT_THAT(DetectionsOfPoints(MakeCloud({{0.5F, 0.5F, 0.5F}}), {}), ElementsAre(std::nullopt));
  EXPECT_TRUE(PointsOfDetections({}, {}).empty());
}

}  // namespace
}  // namespace clearway::evaluate
