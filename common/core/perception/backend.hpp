// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <utility>

namespace clearway::core {

/// Which implementation of voxel grid, floor and clustering runs. All backends stand behind the
/// same interfaces and must agree stage by stage on the same input.
enum class Backend {
  kTextbook,  ///< The published chain: pcl::VoxelGrid, pcl::SACSegmentation, FLANN radius search.
};

/// The names used in the configuration.
inline constexpr std::array<std::pair<const char*, Backend>, 1> kBackendNames{
    {{"textbook", Backend::kTextbook}}};

}  // namespace clearway::core
