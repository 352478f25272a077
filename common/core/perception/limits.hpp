// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>
#include <cstddef>

#include "common/core/cloud.hpp"

namespace clearway::core {

/// A coordinate beyond this is no measurement but a defect, like NaN [m]. No sensor reaches that
/// far, float coordinates there are 8 mm apart, and all cell indices and squares of what lies
/// within stay far from overflow.
inline constexpr float kMaxCoordinate_m = 100'000.0F;

/// True when all three coordinates of point i are finite and within kMaxCoordinate_m. All stages
/// of perception ignore points that are not.
[[nodiscard]] inline bool IsMeasurement(const PointCloud& cloud, std::size_t i) {
  // A comparison with NaN is false.
  return std::fabs(cloud.x[i]) <= kMaxCoordinate_m && std::fabs(cloud.y[i]) <= kMaxCoordinate_m &&
         std::fabs(cloud.z[i]) <= kMaxCoordinate_m;
}

}  // namespace clearway::core
