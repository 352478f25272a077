// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>

#include "common/core/cloud.hpp"
#include "common/core/perception/clustering/clusterer.hpp"

namespace clearway::test {

/// pcl::EuclideanClusterExtraction as its users call it: the reference for partition and time.
class PclClusters {
 public:
  /// Copies the cloud's measurements (see IsMeasurement) into PCL's layout.
  PclClusters(const core::PointCloud& cloud, const core::ClusteringConfig& config);
  ~PclClusters();

  /// Builds the tree and extracts the clusters: what is to be timed.
  void Extract();

  /// The clusters of the last Extract(), in the order of Clusterer.
  [[nodiscard]] core::Partition Result() const;

 private:
  struct Data;
  std::unique_ptr<Data> data_;
};

}  // namespace clearway::test
