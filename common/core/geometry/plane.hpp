// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>

namespace clearway::core {

/// The plane { p : normal . p + offset_m = 0 }, with a unit normal.
struct Plane {
  Eigen::Vector3f normal = Eigen::Vector3f::UnitZ();
  float offset_m = 0.0F;

  /// Positive on the side that the normal points to [m].
  [[nodiscard]] float SignedDistance(const Eigen::Vector3f& point) const {
    return normal.dot(point) + offset_m;
  }
};

}  // namespace clearway::core
