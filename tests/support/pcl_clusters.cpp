// SPDX-License-Identifier: BSD-3-Clause
#include "tests/support/pcl_clusters.hpp"

#include <algorithm>
#include <vector>

#include <pcl/point_cloud.h>
#include <pcl/point_types.h>
#include <pcl/search/kdtree.h>
#include <pcl/segmentation/extract_clusters.h>

#include "common/core/perception/limits.hpp"

namespace clearway::test {

struct PclClusters::Data {
  pcl::PointCloud<pcl::PointXYZ>::Ptr cloud = std::make_shared<pcl::PointCloud<pcl::PointXYZ>>();
  std::vector<std::uint32_t> cloud_index;
  pcl::EuclideanClusterExtraction<pcl::PointXYZ> extraction;
  std::vector<pcl::PointIndices> clusters;
};

PclClusters::PclClusters(const core::PointCloud& cloud, const core::ClusteringConfig& config)
    : data_(std::make_unique<Data>()) {
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    if (!core::IsMeasurement(cloud, i)) continue;
    data_->cloud->push_back({cloud.x[i], cloud.y[i], cloud.z[i]});
    data_->cloud_index.push_back(static_cast<std::uint32_t>(i));
  }
  data_->extraction.setClusterTolerance(config.tolerance_m);
  data_->extraction.setMinClusterSize(static_cast<unsigned int>(config.min_points));
  data_->extraction.setInputCloud(data_->cloud);
}

PclClusters::~PclClusters() = default;

void PclClusters::Extract() {
  data_->clusters.clear();
  if (data_->cloud->empty()) return;
  data_->extraction.setSearchMethod(std::make_shared<pcl::search::KdTree<pcl::PointXYZ>>(false));
  data_->extraction.extract(data_->clusters);
}

core::Partition PclClusters::Result() const {
  std::vector<pcl::PointIndices> clusters = data_->clusters;
  std::sort(clusters.begin(), clusters.end(), [](const auto& a, const auto& b) {
    return a.indices.front() < b.indices.front();
  });
  core::Partition partition;
  for (const pcl::PointIndices& cluster : clusters) {
    for (const int i : cluster.indices) {
      partition.indices.push_back(data_->cloud_index[static_cast<std::size_t>(i)]);
    }
    partition.offsets.push_back(static_cast<std::uint32_t>(partition.indices.size()));
  }
  return partition;
}

}  // namespace clearway::test
