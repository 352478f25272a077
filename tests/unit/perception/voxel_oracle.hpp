// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <map>

#include <gtest/gtest.h>

#include "common/core/perception/limits.hpp"
#include "common/core/perception/voxel/voxel_grid.hpp"

namespace clearway::test {

// Both sum floats, in another order: some 1e-6 of the coordinate.
inline constexpr double kMeanTolerance = 4e-6;
inline constexpr double kMeanTolerance_m = 1e-5;
// The mean of intensities is rounded to a whole number.
inline constexpr double kIntensityTolerance = 0.51;

using CellIndex = std::array<long, 3>;

struct CellMean {
  std::size_t count = 0;
  Eigen::Vector3d position = Eigen::Vector3d::Zero();
  double intensity = 0.0;
};

struct VoxelOracle {
  std::map<CellIndex, CellMean> cells;
  std::size_t num_invalid = 0;
  std::size_t num_sparse = 0;
};

inline CellIndex CellOf(const Eigen::Vector3f& p, float leaf_m) {
  const float inverse = 1.0F / leaf_m;
  return {static_cast<long>(std::floor(p.x() * inverse)),
          static_cast<long>(std::floor(p.y() * inverse)),
          static_cast<long>(std::floor(p.z() * inverse))};
}

inline VoxelOracle BruteForceVoxels(const core::PointCloud& cloud,
                                    const core::VoxelGridConfig& config) {
  VoxelOracle oracle;
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    if (!core::IsMeasurement(cloud, i)) {
      ++oracle.num_invalid;
      continue;
    }
    CellMean& cell = oracle.cells[CellOf(cloud.Point(i), static_cast<float>(config.leaf_m))];
    ++cell.count;
    cell.position += cloud.Point(i).cast<double>();
    cell.intensity += cloud.intensity[i];
  }
  for (auto it = oracle.cells.begin(); it != oracle.cells.end();) {
    CellMean& cell = it->second;
    if (cell.count < static_cast<std::size_t>(config.min_points)) {
      oracle.num_sparse += cell.count;
      it = oracle.cells.erase(it);
      continue;
    }
    cell.position /= static_cast<double>(cell.count);
    cell.intensity /= static_cast<double>(cell.count);
    ++it;
  }
  return oracle;
}

inline bool IsMeanOf(const CellMean& cell, const core::PointCloud& cloud, std::size_t i) {
  const double tolerance_m = kMeanTolerance_m + kMeanTolerance * cell.position.norm();
  return (cloud.Point(i).cast<double>() - cell.position).norm() <= tolerance_m &&
         std::fabs(cloud.intensity[i] - cell.intensity) <= kIntensityTolerance;
}

// Takes the cell whose mean is point i out of the oracle. A mean may be rounded over its border.
inline bool TakeCell(VoxelOracle& oracle,
                     const core::PointCloud& cloud,
                     std::size_t i,
                     float leaf_m) {
  const CellIndex center = CellOf(cloud.Point(i), leaf_m);
  for (long dx : {0L, -1L, 1L}) {
    for (long dy : {0L, -1L, 1L}) {
      for (long dz : {0L, -1L, 1L}) {
        const auto it = oracle.cells.find({center[0] + dx, center[1] + dy, center[2] + dz});
        if (it == oracle.cells.end() || !IsMeanOf(it->second, cloud, i)) continue;
        oracle.cells.erase(it);
        return true;
      }
    }
  }
  return false;
}

inline void ExpectAgreement(const core::VoxelGrid::Result& result,
                            VoxelOracle oracle,
                            float leaf_m) {
  ASSERT_EQ(result.cloud.size(), oracle.cells.size());
  EXPECT_EQ(result.num_invalid, oracle.num_invalid);
  EXPECT_EQ(result.num_sparse, oracle.num_sparse);
  std::size_t num_unmatched = 0;
  for (std::size_t i = 0; i < result.cloud.size(); ++i) {
    if (!TakeCell(oracle, result.cloud, i, leaf_m)) ++num_unmatched;
  }
  EXPECT_EQ(num_unmatched, 0U);
}

}  // namespace clearway::test
