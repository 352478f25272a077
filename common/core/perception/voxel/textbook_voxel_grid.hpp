// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>

#include "common/core/perception/voxel/voxel_grid.hpp"

namespace clearway::core {

/// pcl::VoxelGrid over x, y, z and intensity. PCL numbers the cells of a cloud's bounding box in 32
/// bits and hands out its input, unfiltered, when they do not suffice (two returns at 300 m and a
/// leaf of 0.05 m are enough). Here such a cloud is first split at planes between cells, so that
/// the cells are the same and each part suffices. O(n log n); a split costs O(n) a level.
[[nodiscard]] std::unique_ptr<VoxelGrid> MakeTextbookVoxelGrid(const VoxelGridConfig& config);

}  // namespace clearway::core
