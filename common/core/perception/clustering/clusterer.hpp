// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "common/core/cloud.hpp"
#include "common/core/perception/backend.hpp"

namespace clearway::core {

/// Settings of Clusterer. XML element: <clusterer><clustering>.
struct ClusteringConfig {
  double tolerance_m = 0.2;
  int min_points = 5;

  template <typename Self, typename Visitor>
  static void Visit(Self& self, Visitor& visitor) {
    visitor.Number("tolerance_m",
                   self.tolerance_m,
                   0.01,
                   5.0,
                   "Points closer than this belong to one cluster [m]. Larger merges neighbours, "
                   "smaller splits sparse objects.");
    visitor.Integer(
        "min_points",
        self.min_points,
        1,
        10000,
        "Clusters with fewer points (voxels) are not reported. There is no upper limit: "
        "a large cluster is an obstacle.");
  }
};

/// Two points are neighbours when the square of their distance, (dx dx + dy dy) + dz dz in float,
/// is less than this [m^2]. Every backend uses the same float, so that ties fall alike.
[[nodiscard]] inline float SquaredTolerance_m2(const ClusteringConfig& config) {
  const double tolerance_m = static_cast<float>(config.tolerance_m);
  return static_cast<float>(tolerance_m * tolerance_m);
}

/// Disjoint sets of point indices, stored back to back.
struct Partition {
  std::vector<std::uint32_t> indices;        ///< Ascending within a cluster.
  std::vector<std::uint32_t> offsets = {0};  ///< Cluster c is indices[offsets[c], offsets[c + 1]).

  [[nodiscard]] std::size_t size() const { return offsets.size() - 1; }
  [[nodiscard]] std::span<const std::uint32_t> Cluster(std::size_t c) const {
    return std::span(indices).subspan(offsets[c], offsets[c + 1] - offsets[c]);
  }
  friend bool operator==(const Partition&, const Partition&) = default;
};

/// Euclidean clusters: exact single linkage with a distance tolerance (the connected components of
/// the graph that joins any two points closer than tolerance_m), as pcl::EuclideanClusterExtraction
/// gives them. Clusters are ordered by their lowest index. Points that are not finite or beyond
/// kMaxCoordinate_m are in none. A large cluster is never dropped or split.
/// Thread safety: none; an instance may keep buffers between calls.
/// Source: R. B. Rusu, Semantic 3D Object Maps, PhD thesis, TU Muenchen 2009, section 6.2.
class Clusterer {
 public:
  virtual ~Clusterer() = default;
  [[nodiscard]] virtual Partition Cluster(const PointCloud& cloud) = 0;
};

[[nodiscard]] std::unique_ptr<Clusterer> MakeClusterer(Backend backend,
                                                       const ClusteringConfig& config);

}  // namespace clearway::core
