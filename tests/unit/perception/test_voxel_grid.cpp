// SPDX-License-Identifier: BSD-3-Clause
#include <string>

#include <gtest/gtest.h>

#include "common/core/perception/limits.hpp"
#include "common/core/perception/voxel/voxel_grid.hpp"
#include "tests/support/recorded_scan.hpp"
#include "tests/unit/perception/scenes.hpp"
#include "tests/unit/perception/voxel_oracle.hpp"

namespace clearway::core {
namespace {

using test::BruteForceVoxels;
using test::ExpectAgreement;
using test::kInfinity;
using test::kNan;
using test::Random;
using test::VoxelOracle;

class VoxelGridTest : public testing::TestWithParam<Backend> {
 protected:
  static VoxelGrid::Result Downsample(const PointCloud& cloud, const VoxelGridConfig& config = {}) {
    return MakeVoxelGrid(GetParam(), config)->Downsample(cloud);
  }

  static void ExpectBruteForceCells(const PointCloud& cloud, const VoxelGridConfig& config) {
    ExpectAgreement(Downsample(cloud, config),
                    BruteForceVoxels(cloud, config),
                    static_cast<float>(config.leaf_m));
  }
};

INSTANTIATE_TEST_SUITE_P(Backends,
                         VoxelGridTest,
                         testing::ValuesIn(test::AllBackends()),
                         test::BackendName);

TEST_P(VoxelGridTest, AgreesWithABruteForceHashOnRandomClouds) {
  for (std::uint32_t seed = 1; seed <= 60; ++seed) {
    Random random(seed);
    const PointCloud cloud = RandomCube(random, random.Index(3000), random.Uniform(0.1, 3.0));
    const VoxelGridConfig config{.leaf_m = random.Uniform(0.02, 0.5),
                                 .min_points = 1 + static_cast<int>(seed % 3)};

    SCOPED_TRACE("seed " + std::to_string(seed));
    ExpectBruteForceCells(cloud, config);
  }
}

TEST_P(VoxelGridTest, AgreesWithABruteForceHashOnRealScans) {
  for (const auto& scan : {test::kLivoxHorizon, test::kIndoor28k, test::kKittiFull}) {
    const PointCloud cloud = test::LoadScan(scan);
    if (cloud.empty()) GTEST_SKIP() << test::MissingData(scan.path);

    SCOPED_TRACE(scan.name);
    ExpectBruteForceCells(cloud, {.leaf_m = 0.05, .min_points = 1});
    ExpectBruteForceCells(cloud, {.leaf_m = 0.1, .min_points = 2});
  }
}

TEST_P(VoxelGridTest, StillFiltersWhenFarReturnsOverflowA32BitIndex) {
  PointCloud cloud = test::MakeRoom({});
  for (const float sign : {-1.0F, 1.0F}) {
    cloud.Add({sign * 303.0F, 0.01F, 1.0F});
    cloud.Add({0.01F, sign * 303.0F, 1.0F});
    cloud.Add({0.01F, 0.01F, sign * 303.0F});
  }

  ExpectBruteForceCells(cloud, {.leaf_m = 0.05, .min_points = 1});
  ExpectBruteForceCells(cloud, {.leaf_m = 0.05, .min_points = 2});
}

TEST_P(VoxelGridTest, NeverCutsACellWhenTheCloudIsAHundredKilometresWide) {
  Random random(7);
  PointCloud cloud;
  for (int i = 0; i < 300; ++i) {
    const Eigen::Vector3f center = test::RandomPoint(random, 99'000.0);
    for (int k = 0; k < 8; ++k) {
      cloud.Add(center + test::RandomPoint(random, 0.5), static_cast<std::uint8_t>(k));
    }
  }

  ExpectBruteForceCells(cloud, {.leaf_m = 0.2, .min_points = 1});
  ExpectBruteForceCells(cloud, {.leaf_m = 0.5, .min_points = 2});
}

TEST_P(VoxelGridTest, CountsHugeFiniteCoordinatesAsInvalid) {
  PointCloud cloud;
  cloud.Add({1.0F, 1.0F, 1.0F});
  cloud.Add({1e30F, 0.0F, 0.0F});
  cloud.Add({0.0F, -1e30F, 0.0F});
  cloud.Add({0.0F, 0.0F, std::numeric_limits<float>::max()});
  cloud.Add({kMaxCoordinate_m, -kMaxCoordinate_m, kMaxCoordinate_m});

  const auto result = Downsample(cloud, {.leaf_m = 0.005, .min_points = 1});

  EXPECT_EQ(result.cloud.size(), 2U);
  EXPECT_EQ(result.num_invalid, 3U);
}

TEST_P(VoxelGridTest, CountsPointsThatAreNotFiniteAsInvalid) {
  PointCloud cloud;
  cloud.Add({kNan, 0.0F, 0.0F});
  cloud.Add({0.0F, kInfinity, 0.0F});
  cloud.Add({0.0F, 0.0F, -kInfinity});

  const auto result = Downsample(cloud);

  EXPECT_TRUE(result.cloud.empty());
  EXPECT_EQ(result.num_invalid, 3U);
  EXPECT_EQ(result.num_sparse, 0U);
}

TEST_P(VoxelGridTest, GivesNothingForNothing) {
  const auto result = Downsample({});

  EXPECT_TRUE(result.cloud.empty());
  EXPECT_EQ(result.num_invalid, 0U);
  EXPECT_EQ(result.num_sparse, 0U);
}

TEST_P(VoxelGridTest, KeepsALonePointWhereItIs) {
  PointCloud cloud;
  cloud.Add({1.234F, -5.678F, 0.9F}, 77);

  const auto result = Downsample(cloud);

  ASSERT_EQ(result.cloud.size(), 1U);
  EXPECT_EQ(result.cloud.Point(0), cloud.Point(0));
  EXPECT_EQ(result.cloud.intensity[0], 77);
}

TEST_P(VoxelGridTest, DropsALonePointWhenACellNeedsTwo) {
  PointCloud cloud;
  cloud.Add({1.0F, 0.0F, 0.0F});

  const auto result = Downsample(cloud, {.leaf_m = 0.05, .min_points = 2});

  EXPECT_TRUE(result.cloud.empty());
  EXPECT_EQ(result.num_sparse, 1U);
}

TEST_P(VoxelGridTest, DoesNotDependOnTheOrderOfPoints) {
  Random random(11);
  const PointCloud cloud = RandomCube(random, 2000, 1.0);
  const VoxelGridConfig config{.leaf_m = 0.2, .min_points = 2};
  const PointCloud reordered = test::Reordered(cloud, test::RandomOrder(random, cloud.size()));

  const auto result = Downsample(reordered, config);

  ExpectAgreement(result, BruteForceVoxels(cloud, config), 0.2F);
}

TEST_P(VoxelGridTest, GivesTheSameMeansWhenEveryPointComesTwice) {
  Random random(12);
  PointCloud cloud = RandomCube(random, 1000, 1.0);
  const VoxelGridConfig config{.leaf_m = 0.2, .min_points = 1};
  const VoxelOracle once = BruteForceVoxels(cloud, config);

  cloud.Append(PointCloud(cloud));
  const auto result = Downsample(cloud, config);

  ExpectAgreement(result, once, 0.2F);
}

TEST_P(VoxelGridTest, MovesWithTheCloudByWholeCells) {
  Random random(13);
  const VoxelGridConfig config{.leaf_m = 0.125, .min_points = 2};  // exact in binary
  PointCloud cloud;
  PointCloud moved;
  const Eigen::Vector3f shift(0.125F * 40.0F, 0.125F * -24.0F, 0.125F * 8.0F);
  for (int i = 0; i < 2000; ++i) {
    Eigen::Vector3f point = test::RandomPoint(random, 1.0);
    point = (point * 1024.0F).array().round() / 1024.0F;  // so that the sum is exact too
    cloud.Add(point);
    moved.Add(point + shift);
  }

  const auto result = Downsample(moved, config);

  VoxelOracle expected;
  for (const auto& [cell, mean] : BruteForceVoxels(cloud, config).cells) {
    test::CellMean& shifted = expected.cells[{cell[0] + 40, cell[1] - 24, cell[2] + 8}];
    shifted = mean;
    shifted.position += shift.cast<double>();
  }
  expected.num_sparse = BruteForceVoxels(cloud, config).num_sparse;
  ExpectAgreement(result, expected, 0.125F);
}

TEST_P(VoxelGridTest, RemembersNothingOfThePreviousScan) {
  Random random(14);
  const VoxelGridConfig config{.leaf_m = 0.05, .min_points = 2};
  const auto grid = MakeVoxelGrid(GetParam(), config);
  PointCloud wide = RandomCube(random, 5000, 400.0);  // is split
  const PointCloud small = RandomCube(random, 500, 0.3);

  static_cast<void>(grid->Downsample(wide));
  const auto result = grid->Downsample(small);

  ExpectAgreement(result, BruteForceVoxels(small, config), 0.05F);
  EXPECT_EQ(result.cloud.x, Downsample(small, config).cloud.x);
}

TEST_P(VoxelGridTest, PrintsNothing) {
  Random random(15);
  PointCloud cloud = RandomCube(random, 100, 1000.0);
  cloud.Add({kNan, 0.0F, 0.0F});

  testing::internal::CaptureStderr();
  testing::internal::CaptureStdout();
  static_cast<void>(Downsample(cloud));
  static_cast<void>(Downsample({}));

  EXPECT_EQ(testing::internal::GetCapturedStderr(), "");
  EXPECT_EQ(testing::internal::GetCapturedStdout(), "");
}

}  // namespace
}  // namespace clearway::core
