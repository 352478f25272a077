// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <memory>

#include "common/core/cloud.hpp"
#include "common/core/perception/backend.hpp"

namespace clearway::core {

/// Settings of VoxelGrid. XML element: <preprocessor><voxel_grid>.
struct VoxelGridConfig {
  double leaf_m = 0.05;
  int min_points = 1;

  template <typename Self, typename Visitor>
  static void Visit(Self& self, Visitor& visitor) {
    visitor.Number("leaf_m",
                   self.leaf_m,
                   0.005,
                   2.0,
                   "Side of a cubic cell [m]. Larger cells are faster and blur small obstacles.");
    visitor.Integer("min_points",
                    self.min_points,
                    1,
                    100,
                    "A cell with fewer points than this is dropped. More than 1 removes lone noise "
                    "and, on sparse scans, most small and far obstacles with it.");
  }
};

/// Replaces the points of each occupied cell of a cubic grid by their mean (position and
/// intensity). Cells are aligned to the origin of the cloud's frame: cell index = floor(p / leaf),
/// evaluated in float as floor(p * (1 / leaf)). No extent of the cloud is too large.
/// Thread safety: none; an instance may keep buffers between calls.
class VoxelGrid {
 public:
  struct Result {
    PointCloud cloud;             ///< One point a kept cell; tag and time offset are 0.
    std::size_t num_invalid = 0;  ///< Points with a coordinate that is not finite or is beyond
                                  ///< kMaxCoordinate_m (100 km); in no cell.
    std::size_t num_sparse = 0;   ///< Points in cells with fewer than min_points.
  };

  virtual ~VoxelGrid() = default;

  /// Same input, same output; the order of the output is unspecified but fixed.
  [[nodiscard]] virtual Result Downsample(const PointCloud& cloud) = 0;
};

[[nodiscard]] std::unique_ptr<VoxelGrid> MakeVoxelGrid(Backend backend,
                                                       const VoxelGridConfig& config);

}  // namespace clearway::core
