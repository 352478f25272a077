// SPDX-License-Identifier: BSD-3-Clause
#include "common/core/perception/voxel/voxel_grid.hpp"

#include <stdexcept>

#include "common/core/perception/voxel/textbook_voxel_grid.hpp"

namespace clearway::core {

std::unique_ptr<VoxelGrid> MakeVoxelGrid(Backend backend, const VoxelGridConfig& config) {
  switch (backend) {
    case Backend::kTextbook:
      return MakeTextbookVoxelGrid(config);
  }
  throw std::invalid_argument("MakeVoxelGrid: unknown backend");
}

}  // namespace clearway::core
