// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>

#include "common/core/perception/clustering/clusterer.hpp"

namespace clearway::core {

/// Breadth-first search with a radius query at each point of a FLANN k-d tree: the algorithm of
/// pcl::EuclideanClusterExtraction on the same tree (one KDTreeSingleIndex, 15 points a leaf), so
/// with the same partition. O(n (log n + k)) for k neighbours a point, which is O(n^2) where the
/// cloud is dense against the tolerance: that is the method's own weakness. Points at one place
/// share one query.
[[nodiscard]] std::unique_ptr<Clusterer> MakeTextbookClusterer(const ClusteringConfig& config);

}  // namespace clearway::core
