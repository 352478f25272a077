// SPDX-License-Identifier: BSD-3-Clause
#include "common/core/perception/clustering/textbook_clusterer.hpp"

#include <algorithm>
#include <cstddef>

#include <flann/flann.hpp>

#include "common/core/perception/limits.hpp"

namespace clearway::core {
namespace {

using Tree = flann::KDTreeSingleIndex<flann::L2_Simple<float>>;

constexpr std::size_t kDimensions = 3;
constexpr int kPointsPerLeaf = 15;

// How far a point has come in the search.
enum class Mark : std::uint8_t {
  kUnseen,
  kQueued,  // In a cluster; its neighbours are still to be looked up.
  kDone,    // In a cluster; they have been, from here or from another point at the same place.
};

class TextbookClusterer final : public Clusterer {
 public:
  explicit TextbookClusterer(const ClusteringConfig& config)
      : min_points_(static_cast<std::size_t>(config.min_points)),
        radius2_m2_(SquaredTolerance_m2(config)) {
    search_.checks = flann::FLANN_CHECKS_UNLIMITED;
    search_.eps = 0.0F;
    search_.sorted = false;
    search_.max_neighbors = -1;
  }

  Partition Cluster(const PointCloud& cloud) override;

 private:
  void Load(const PointCloud& cloud);
  void Grow(const Tree& tree, std::uint32_t seed, std::vector<std::uint32_t>& indices);
  void TakeNeighbours(std::vector<std::uint32_t>& indices);

  std::size_t min_points_;
  float radius2_m2_;
  flann::SearchParams search_;
  std::vector<float> points_;               // x y z of the valid points
  std::vector<std::uint32_t> cloud_index_;  // of each of them
  std::vector<Mark> marks_;
  std::vector<std::vector<std::size_t>> neighbours_{1};  // of one query
  std::vector<std::vector<float>> distances2_{1};
};

Partition TextbookClusterer::Cluster(const PointCloud& cloud) {
  Load(cloud);
  Partition partition;
  if (cloud_index_.empty()) return partition;
  Tree tree(flann::Matrix<float>(points_.data(), cloud_index_.size(), kDimensions),
            flann::KDTreeSingleIndexParams(kPointsPerLeaf));
  tree.buildIndex();

  std::vector<std::uint32_t>& indices = partition.indices;
  for (std::size_t seed = 0; seed < cloud_index_.size(); ++seed) {
    if (marks_[seed] != Mark::kUnseen) continue;
    const std::size_t first = partition.offsets.back();
    Grow(tree, static_cast<std::uint32_t>(seed), indices);
    if (indices.size() - first < min_points_) {
      indices.resize(first);
      continue;
    }
    std::sort(indices.begin() + static_cast<std::ptrdiff_t>(first), indices.end());
    partition.offsets.push_back(static_cast<std::uint32_t>(indices.size()));
  }
  for (std::uint32_t& index : indices) index = cloud_index_[index];
  return partition;
}

void TextbookClusterer::Load(const PointCloud& cloud) {
  points_.clear();
  cloud_index_.clear();
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    if (!IsMeasurement(cloud, i)) continue;
    points_.insert(points_.end(), {cloud.x[i], cloud.y[i], cloud.z[i]});
    cloud_index_.push_back(static_cast<std::uint32_t>(i));
  }
  marks_.assign(cloud_index_.size(), Mark::kUnseen);
}

// Appends the component of `seed`. The end of `indices` is the queue of the search.
void TextbookClusterer::Grow(const Tree& tree,
                             std::uint32_t seed,
                             std::vector<std::uint32_t>& indices) {
  std::size_t head = indices.size();
  indices.push_back(seed);
  marks_[seed] = Mark::kQueued;
  for (; head < indices.size(); ++head) {
    const std::size_t point = indices[head];
    if (marks_[point] == Mark::kDone) continue;
    tree.radiusSearch(flann::Matrix<float>(&points_[kDimensions * point], 1, kDimensions),
                      neighbours_,
                      distances2_,
                      radius2_m2_,
                      search_);
    TakeNeighbours(indices);
  }
}

void TextbookClusterer::TakeNeighbours(std::vector<std::uint32_t>& indices) {
  const std::vector<std::size_t>& neighbours = neighbours_.front();
  for (std::size_t k = 0; k < neighbours.size(); ++k) {
    Mark& mark = marks_[neighbours[k]];
    if (mark == Mark::kUnseen) indices.push_back(static_cast<std::uint32_t>(neighbours[k]));
    // A point at this very place has the same neighbours: no query of its own.
    if (distances2_.front()[k] == 0.0F) {
      mark = Mark::kDone;
    } else if (mark == Mark::kUnseen) {
      mark = Mark::kQueued;
    }
  }
}

}  // namespace

std::unique_ptr<Clusterer> MakeTextbookClusterer(const ClusteringConfig& config) {
  return std::make_unique<TextbookClusterer>(config);
}

}  // namespace clearway::core
