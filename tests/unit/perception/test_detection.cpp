// SPDX-License-Identifier: BSD-3-Clause
#include <numeric>

#include <gtest/gtest.h>

#include "common/core/perception/detection/detection.hpp"
#include "tests/unit/perception/scenes.hpp"

namespace clearway::core {
namespace {

constexpr float kRounding_m = 1e-5F;

class DescribeClusterTest : public testing::TestWithParam<Backend> {};

INSTANTIATE_TEST_SUITE_P(Backends,
                         DescribeClusterTest,
                         testing::ValuesIn(test::AllBackends()),
                         test::BackendName);

TEST_P(DescribeClusterTest, DescribesABox) {
  PointCloud cloud;
  cloud.Add({100.0F, 100.0F, 100.0F});  // not in the cluster
  for (const float x : {2.0F, 4.0F}) {
    for (const float y : {-0.5F, 0.5F}) {
      for (const float z : {0.1F, 1.3F}) cloud.Add({x, y, z});
    }
  }
  std::vector<std::uint32_t> indices(8);
  std::iota(indices.begin(), indices.end(), 1U);

  const Detection detection = DescribeCluster(GetParam(), cloud, indices);

  EXPECT_EQ(detection.num_points, 8U);
  EXPECT_NEAR((detection.centroid - Eigen::Vector3f(3.0F, 0.0F, 0.7F)).norm(), 0.0F, kRounding_m);
  EXPECT_NEAR(detection.rectangle.length_m, 2.0F, kRounding_m);
  EXPECT_NEAR(detection.rectangle.width_m, 1.0F, kRounding_m);
  EXPECT_NEAR(detection.rectangle.yaw_rad, 0.0F, kRounding_m);
  EXPECT_NEAR((detection.rectangle.center - Eigen::Vector2f(3.0F, 0.0F)).norm(), 0.0F, kRounding_m);
  EXPECT_EQ(detection.z_min_m, 0.1F);
  EXPECT_EQ(detection.z_max_m, 1.3F);
  EXPECT_EQ(detection.hull.size(), 4U);
  EXPECT_EQ(detection.nearest, Eigen::Vector2f(2.0F, 0.0F));
}

TEST_P(DescribeClusterTest, DescribesNothingByDefault) {
  const Detection detection = DescribeCluster(GetParam(), {}, {});

  EXPECT_EQ(detection.num_points, 0U);
  EXPECT_TRUE(detection.hull.empty());
  EXPECT_EQ(detection.z_min_m, 0.0F);
}

TEST_P(DescribeClusterTest, DescribesASinglePoint) {
  PointCloud cloud;
  cloud.Add({3.0F, 4.0F, 0.5F});

  const Detection detection = DescribeCluster(GetParam(), cloud, std::vector<std::uint32_t>{0});

  EXPECT_EQ(detection.centroid, Eigen::Vector3f(3.0F, 4.0F, 0.5F));
  EXPECT_EQ(detection.hull.size(), 1U);
  EXPECT_EQ(detection.nearest, Eigen::Vector2f(3.0F, 4.0F));
  EXPECT_EQ(detection.rectangle.length_m, 0.0F);
}

TEST_P(DescribeClusterTest, DoesNotDependOnTheOrderOfPoints) {
  test::Random random(71);
  const PointCloud cloud = test::RandomCube(random, 500, 2.0);
  std::vector<std::uint32_t> indices(cloud.size());
  std::iota(indices.begin(), indices.end(), 0U);

  const Detection one = DescribeCluster(GetParam(), cloud, indices);
  const Detection other =
      DescribeCluster(GetParam(), cloud, test::RandomOrder(random, cloud.size()));

  EXPECT_EQ(one.hull, other.hull);
  EXPECT_EQ(one.nearest, other.nearest);
  EXPECT_NEAR((one.centroid - other.centroid).norm(), 0.0F, kRounding_m);
  EXPECT_NEAR(one.rectangle.length_m, other.rectangle.length_m, kRounding_m);
  EXPECT_NEAR(one.rectangle.yaw_rad, other.rectangle.yaw_rad, kRounding_m);
}

TEST_P(DescribeClusterTest, TakesTheOriginAsNearestWhenStandingInTheHull) {
  PointCloud cloud;
  cloud.Add({-1.0F, -1.0F, 0.0F});
  cloud.Add({1.0F, -1.0F, 0.0F});
  cloud.Add({0.0F, 1.0F, 0.0F});

  const Detection detection =
      DescribeCluster(GetParam(), cloud, std::vector<std::uint32_t>{0, 1, 2});

  EXPECT_EQ(detection.nearest, Eigen::Vector2f(0.0F, 0.0F));
}

}  // namespace
}  // namespace clearway::core
