// SPDX-License-Identifier: BSD-3-Clause
#include "tests/benchmark/measure.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <memory>

#include "common/core/perception/clustering/clusterer.hpp"
#include "common/core/perception/detection/detection.hpp"
#include "common/core/perception/floor/floor_finder.hpp"
#include "common/core/perception/floor/floor_split.hpp"
#include "common/core/perception/voxel/voxel_grid.hpp"
#include "tests/support/pcl_clusters.hpp"

namespace clearway::bench {
namespace {

constexpr core::Backend kBackend = core::Backend::kTextbook;

template <typename Function>
double TimeMs(Function&& function) {
  const auto start = std::chrono::steady_clock::now();
  function();
  return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start)
      .count();
}

double Quantile(std::vector<double> values, double q) {
  std::sort(values.begin(), values.end());
  const auto rank = static_cast<std::size_t>(std::ceil(q * static_cast<double>(values.size())));
  return values[std::max<std::size_t>(rank, 1) - 1];
}

// The chain with the defaults that all backends start from.
class Chain {
 public:
  core::VoxelGrid::Result Voxel(const core::PointCloud& cloud) { return voxel_->Downsample(cloud); }

  core::PointCloud Floor(const core::PointCloud& cloud) {
    const auto fit = floor_->Find(cloud);
    const core::FloorSplit split =
        core::SplitByFloor(cloud, fit ? fit->plane_vehicle : core::Plane{}, floor_config_);
    core::PointCloud obstacles;
    for (const auto& part : {split.above, split.below}) {
      for (const std::uint32_t i : part) obstacles.AddFrom(cloud, i);
    }
    return obstacles;
  }

  core::Partition Clusters(const core::PointCloud& cloud) { return clusterer_->Cluster(cloud); }

  std::vector<core::Detection> Detections(const core::PointCloud& cloud,
                                          const core::Partition& partition) const {
    std::vector<core::Detection> detections;
    for (std::size_t c = 0; c < partition.size(); ++c) {
      detections.push_back(core::DescribeCluster(kBackend, cloud, partition.Cluster(c)));
    }
    return detections;
  }

  std::size_t Run(const core::PointCloud& cloud) {
    const core::PointCloud obstacles = Floor(Voxel(cloud).cloud);
    return Detections(obstacles, Clusters(obstacles)).size();
  }

 private:
  core::FloorConfig floor_config_;
  std::unique_ptr<core::VoxelGrid> voxel_ = core::MakeVoxelGrid(kBackend, {});
  std::unique_ptr<core::FloorFinder> floor_ = core::MakeFloorFinder(kBackend, floor_config_);
  std::unique_ptr<core::Clusterer> clusterer_ = core::MakeClusterer(kBackend, {});
};

// Keeps the optimiser from dropping a result that nobody reads.
volatile std::size_t g_sink = 0;

struct Times {
  std::vector<double> voxel;
  std::vector<double> floor;
  std::vector<double> clustering;
  std::vector<double> pcl;
  std::vector<double> detection;
  std::vector<double> chain;
};

// The input of each stage.
struct Frozen {
  const core::PointCloud& scan;
  core::PointCloud voxels;
  core::PointCloud obstacles;
  core::Partition partition;
};

void Repeat(Chain& chain, const Frozen& input, test::PclClusters& pcl, Times& times) {
  times.voxel.push_back(TimeMs([&] { g_sink = chain.Voxel(input.scan).cloud.size(); }));
  times.floor.push_back(TimeMs([&] { g_sink = chain.Floor(input.voxels).size(); }));
  const auto ours = [&] {
    times.clustering.push_back(TimeMs([&] { g_sink = chain.Clusters(input.obstacles).size(); }));
  };
  const auto theirs = [&] { times.pcl.push_back(TimeMs([&] { pcl.Extract(); })); };
  const bool is_odd = times.voxel.size() % 2 == 1;
  is_odd ? ours() : theirs();
  is_odd ? theirs() : ours();
  times.detection.push_back(
      TimeMs([&] { g_sink = chain.Detections(input.obstacles, input.partition).size(); }));
  times.chain.push_back(TimeMs([&] { g_sink = chain.Run(input.scan); }));
}

Row MakeRow(const Case& test_case,
            const std::string& stage,
            std::size_t points,
            const std::vector<double>& times) {
  Row row{.case_name = test_case.name,
          .stage = stage,
          .points = points,
          .textbook_ms = Quantile(times, 0.5),
          .textbook_p99_ms = Quantile(times, 0.99),
          .ns_per_point = {},
          .pcl_ms = {},
          .ratio_to_pcl = {},
          .partition_equal = {}};
  if (points > 0) row.ns_per_point = 1e6 * row.textbook_ms / static_cast<double>(points);
  return row;
}

}  // namespace

std::vector<Row> Measure(const Case& test_case, int repetitions) {
  Chain chain;
  Frozen input{.scan = test_case.cloud, .voxels = {}, .obstacles = {}, .partition = {}};
  input.voxels = chain.Voxel(input.scan).cloud;
  input.obstacles = chain.Floor(input.voxels);
  input.partition = chain.Clusters(input.obstacles);
  test::PclClusters pcl(input.obstacles, {});
  pcl.Extract();

  Times times;
  const int wanted = std::min(repetitions, test_case.max_repetitions);
  if (wanted > 1) {
    Times warm_up;
    Repeat(chain, input, pcl, warm_up);
  }
  for (int i = 0; i < wanted; ++i) Repeat(chain, input, pcl, times);

  Row clustering = MakeRow(test_case, "clustering", input.obstacles.size(), times.clustering);
  clustering.pcl_ms = Quantile(times.pcl, 0.5);
  if (*clustering.pcl_ms > 0.0) {
    clustering.ratio_to_pcl = clustering.textbook_ms / *clustering.pcl_ms;
  }
  clustering.partition_equal = input.partition == pcl.Result();
  return {MakeRow(test_case, "voxel", input.scan.size(), times.voxel),
          MakeRow(test_case, "floor", input.voxels.size(), times.floor),
          clustering,
          MakeRow(test_case, "detection", input.partition.indices.size(), times.detection),
          MakeRow(test_case, "chain", input.scan.size(), times.chain)};
}

}  // namespace clearway::bench
