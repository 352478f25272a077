// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <map>
#include <numeric>
#include <set>
#include <string>

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include "common/core/perception/clustering/clusterer.hpp"
#include "common/core/perception/limits.hpp"
#include "tests/support/pcl_clusters.hpp"
#include "tests/support/recorded_scan.hpp"
#include "tests/unit/perception/scenes.hpp"

namespace clearway::core {
namespace {

using test::kInfinity;
using test::kNan;
using test::Random;

constexpr std::uint32_t kNumScenes = 250;

// Connected components by looking at every pair.
Partition BruteForce(const PointCloud& cloud, const ClusteringConfig& config) {
  const float tolerance2_m2 = SquaredTolerance_m2(config);
  std::vector<std::size_t> root(cloud.size());
  std::iota(root.begin(), root.end(), std::size_t{0});
  const auto find = [&](std::size_t i) {
    while (root[i] != i) i = root[i] = root[root[i]];
    return i;
  };
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      if (!IsMeasurement(cloud, i) || !IsMeasurement(cloud, j)) continue;
      const float dx = cloud.x[i] - cloud.x[j];
      const float dy = cloud.y[i] - cloud.y[j];
      const float dz = cloud.z[i] - cloud.z[j];
      if (!(dx * dx + dy * dy + dz * dz < tolerance2_m2)) continue;
      const std::size_t a = find(i);
      const std::size_t b = find(j);
      root[std::max(a, b)] = std::min(a, b);  // the lowest index leads
    }
  }
  std::map<std::size_t, std::vector<std::uint32_t>> components;
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    if (IsMeasurement(cloud, i)) components[find(i)].push_back(static_cast<std::uint32_t>(i));
  }
  Partition partition;
  for (const auto& [lowest, members] : components) {
    if (members.size() < static_cast<std::size_t>(config.min_points)) continue;
    partition.indices.insert(partition.indices.end(), members.begin(), members.end());
    partition.offsets.push_back(static_cast<std::uint32_t>(partition.indices.size()));
  }
  return partition;
}

Partition Pcl(const PointCloud& cloud, const ClusteringConfig& config) {
  test::PclClusters pcl(cloud, config);
  pcl.Extract();
  return pcl.Result();
}

// Blobs of random spread, lone points, repeated points and some that are not finite.
PointCloud RandomScene(Random& random) {
  PointCloud cloud;
  const std::size_t num_blobs = random.Index(8);
  for (std::size_t blob = 0; blob < num_blobs; ++blob) {
    const Eigen::Vector3f center = test::RandomPoint(random, 2.0);
    const double spread_m = random.Uniform(0.01, 0.8);
    const std::size_t num_points = random.Index(60);
    for (std::size_t i = 0; i < num_points; ++i) {
      cloud.Add(center + test::RandomPoint(random, spread_m));
    }
  }
  for (std::size_t i = random.Index(50); i > 0; --i) cloud.Add(test::RandomPoint(random, 3.0));
  for (std::size_t i = random.Index(20); i > 0 && !cloud.empty(); --i) {
    cloud.AddFrom(PointCloud(cloud), random.Index(cloud.size()));
  }
  if (random.Index(2) == 0) cloud.Add({kNan, 0.0F, 0.0F});
  if (random.Index(2) == 0) cloud.Add({0.0F, kInfinity, 0.0F});
  return test::Reordered(cloud, test::RandomOrder(random, cloud.size()));
}

// Clusters as sets, whatever their order and the order within.
std::set<std::set<std::uint32_t>> AsSets(const Partition& partition) {
  std::set<std::set<std::uint32_t>> sets;
  for (std::size_t c = 0; c < partition.size(); ++c) {
    const auto cluster = partition.Cluster(c);
    sets.emplace(cluster.begin(), cluster.end());
  }
  return sets;
}

class ClustererTest : public testing::TestWithParam<Backend> {
 protected:
  static Partition Cluster(const PointCloud& cloud, const ClusteringConfig& config = {}) {
    return MakeClusterer(GetParam(), config)->Cluster(cloud);
  }
};

INSTANTIATE_TEST_SUITE_P(Backends,
                         ClustererTest,
                         testing::ValuesIn(test::AllBackends()),
                         test::BackendName);

TEST_P(ClustererTest, GivesTheConnectedComponentsOfRandomScenes) {
  for (std::uint32_t seed = 1; seed <= kNumScenes; ++seed) {
    Random random(seed);
    const PointCloud cloud = RandomScene(random);
    const ClusteringConfig config{.tolerance_m = random.Uniform(0.05, 0.6),
                                  .min_points = 1 + static_cast<int>(seed % 6)};

    const Partition partition = Cluster(cloud, config);

    ASSERT_EQ(partition, BruteForce(cloud, config)) << "seed " << seed;
  }
}

TEST_P(ClustererTest, GivesThePartitionOfPclOnRandomScenes) {
  for (std::uint32_t seed = 1001; seed <= 1000 + kNumScenes; ++seed) {
    Random random(seed);
    const PointCloud cloud = RandomScene(random);
    const ClusteringConfig config{.tolerance_m = random.Uniform(0.05, 0.6),
                                  .min_points = 1 + static_cast<int>(seed % 6)};

    const Partition partition = Cluster(cloud, config);

    ASSERT_EQ(partition, Pcl(cloud, config)) << "seed " << seed;
  }
}

TEST_P(ClustererTest, GivesThePartitionOfPclOnRealScans) {
  for (const auto& scan : {test::kLivoxHorizon, test::kIndoor28k, test::kKittiFull}) {
    const PointCloud cloud = test::LoadScan(scan, 40.0F);
    if (cloud.empty()) GTEST_SKIP() << test::MissingData(scan.path);
    PointCloud obstacles;
    for (std::size_t i = 0; i < cloud.size(); ++i) {
      if (cloud.z[i] > 0.2F && i % 3 == 0) obstacles.AddFrom(cloud, i);
    }
    for (const double tolerance_m : {0.1, 0.2, 0.5}) {
      const ClusteringConfig config{.tolerance_m = tolerance_m, .min_points = 5};

      const Partition partition = Cluster(obstacles, config);

      EXPECT_EQ(partition, Pcl(obstacles, config)) << scan.name << ", " << tolerance_m << " m";
    }
  }
}

TEST_P(ClustererTest, TreatsDistancesEqualToTheToleranceAsPclDoes) {
  for (const float spacing_m : {0.1F, 0.2F, 0.25F, 0.3F}) {
    PointCloud lattice;
    for (int i = 0; i < 12 * 12 * 12; ++i) {
      lattice.Add({spacing_m * static_cast<float>(i % 12),
                   spacing_m * static_cast<float>(i / 12 % 12),
                   spacing_m * static_cast<float>(i / 144)});
    }
    const ClusteringConfig config{.tolerance_m = spacing_m, .min_points = 1};

    const Partition partition = Cluster(lattice, config);

    EXPECT_EQ(partition, BruteForce(lattice, config)) << spacing_m;
    EXPECT_EQ(partition, Pcl(lattice, config)) << spacing_m;
  }
}

TEST_P(ClustererTest, SeparatesPointsExactlyTheToleranceApart) {
  PointCloud cloud;
  cloud.Add({0.0F, 0.0F, 0.0F});
  cloud.Add({0.25F, 0.0F, 0.0F});
  cloud.Add({0.25F, 0.2499F, 0.0F});

  const Partition partition = Cluster(cloud, {.tolerance_m = 0.25, .min_points = 1});

  EXPECT_EQ(partition, (Partition{.indices = {0, 1, 2}, .offsets = {0, 1, 3}}));
}

TEST_P(ClustererTest, DoesNotDependOnTheOrderOfPoints) {
  Random random(21);
  const PointCloud cloud = RandomScene(random);
  const std::vector<std::uint32_t> order = test::RandomOrder(random, cloud.size());

  Partition partition = Cluster(test::Reordered(cloud, order));

  for (std::uint32_t& index : partition.indices) index = order[index];
  EXPECT_EQ(AsSets(partition), AsSets(Cluster(cloud)));
}

TEST_P(ClustererTest, IsNotChangedByARigidMotion) {
  const PointCloud cloud = test::MakeRoom({.num_points = 1500, .seed = 22});
  PointCloud moved;
  const Eigen::AngleAxisf turn(0.7F, Eigen::Vector3f(1.0F, 2.0F, 3.0F).normalized());
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    moved.Add(turn * cloud.Point(i) + Eigen::Vector3f(3.0F, -7.0F, 1.5F));
  }

  EXPECT_EQ(Cluster(moved), Cluster(cloud));
}

TEST_P(ClustererTest, PutsRepeatedPointsIntoTheClusterOfTheFirst) {
  Random random(23);
  const PointCloud once = RandomScene(random);
  PointCloud twice = once;
  twice.Append(once);
  const ClusteringConfig config{.tolerance_m = 0.2, .min_points = 1};

  const Partition partition = Cluster(twice, config);

  EXPECT_EQ(partition, BruteForce(twice, config));
  EXPECT_EQ(partition.size(), Cluster(once, config).size());
}

// A query at each of them would take minutes.
TEST_P(ClustererTest, IsNotSlowWhenManyPointsLieAtOnePlace) {
  PointCloud cloud;
  for (int i = 0; i < 300'000; ++i) cloud.Add({1.0F, 2.0F, 3.0F});

  const Partition partition = Cluster(cloud);

  ASSERT_EQ(partition.size(), 1U);
  EXPECT_EQ(partition.indices.size(), 300'000U);
}

TEST_P(ClustererTest, NeverDropsALargeCluster) {
  PointCloud cloud;
  for (int i = 0; i < 100'000; ++i) cloud.Add({0.1F * static_cast<float>(i), 0.0F, 0.0F});

  const Partition partition = Cluster(cloud);

  ASSERT_EQ(partition.size(), 1U);
  EXPECT_EQ(partition.indices.size(), 100'000U);
}

TEST_P(ClustererTest, ReportsClustersOfTheLeastSizeAndNoSmaller) {
  PointCloud cloud;
  for (int i = 0; i < 4; ++i) cloud.Add({0.1F * static_cast<float>(i), 0.0F, 0.0F});
  for (int i = 0; i < 5; ++i) cloud.Add({0.1F * static_cast<float>(i), 5.0F, 0.0F});

  const Partition partition = Cluster(cloud, {.tolerance_m = 0.2, .min_points = 5});

  EXPECT_EQ(partition, (Partition{.indices = {4, 5, 6, 7, 8}, .offsets = {0, 5}}));
}

TEST_P(ClustererTest, GivesNothingForNothing) {
  EXPECT_EQ(Cluster({}), Partition{});
}

TEST_P(ClustererTest, ReportsALonePointWhenOneIsEnough) {
  PointCloud cloud;
  cloud.Add({1.0F, 2.0F, 3.0F});

  EXPECT_EQ(Cluster(cloud, {.tolerance_m = 0.2, .min_points = 1}),
            (Partition{.indices = {0}, .offsets = {0, 1}}));
}

TEST_P(ClustererTest, IgnoresPointsThatAreNoMeasurements) {
  PointCloud cloud;
  const float largest = std::numeric_limits<float>::max();
  for (int i = 0; i < 40; ++i) {
    cloud.Add({kNan, 0.0F, 0.0F});
    cloud.Add({0.0F, -kInfinity, 0.0F});
    cloud.Add({1e30F, 0.0F, 0.0F});
    cloud.Add({largest, largest, largest});
  }
  const auto num_invalid = static_cast<std::uint32_t>(cloud.size());
  EXPECT_EQ(Cluster(cloud, {.tolerance_m = 0.2, .min_points = 1}), Partition{});
  cloud.Add({kMaxCoordinate_m, 0.0F, 0.0F});

  const Partition partition = Cluster(cloud, {.tolerance_m = 0.2, .min_points = 1});

  EXPECT_EQ(partition, (Partition{.indices = {num_invalid}, .offsets = {0, 1}}));
}

TEST_P(ClustererTest, RemembersNothingOfThePreviousScan) {
  Random random(24);
  const auto clusterer = MakeClusterer(GetParam(), {});
  const PointCloud first = RandomScene(random);
  const PointCloud second = RandomScene(random);
  const Partition before = clusterer->Cluster(second);

  static_cast<void>(clusterer->Cluster(first));
  static_cast<void>(clusterer->Cluster({}));

  EXPECT_EQ(clusterer->Cluster(second), before);
}

}  // namespace
}  // namespace clearway::core
