// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>
#include <cstddef>
#include <numbers>

#include "common/core/geometry/plane.hpp"
#include "tests/unit/perception/scenes.hpp"

namespace clearway::test {

inline constexpr double kDegree_rad = std::numbers::pi / 180.0;
inline constexpr double kNoise_m = 0.01;

inline core::Plane PlaneOf(double tilt_rad, double azimuth_rad, double height_m) {
  const Eigen::Vector3d normal(std::sin(tilt_rad) * std::cos(azimuth_rad),
                               std::sin(tilt_rad) * std::sin(azimuth_rad),
                               std::cos(tilt_rad));
  return {.normal = normal.cast<float>(), .offset_m = static_cast<float>(-normal.z() * height_m)};
}

inline double HeightAtOrigin(const core::Plane& plane) {
  return -plane.offset_m / plane.normal.z();
}

inline double AngleBetween(const core::Plane& a, const core::Plane& b) {
  return std::atan2(a.normal.cross(b.normal).norm(), a.normal.dot(b.normal));
}

inline void AddFloor(core::PointCloud& cloud,
                     const core::Plane& plane,
                     std::size_t num_points,
                     Random& random) {
  for (std::size_t i = 0; i < num_points; ++i) {
    const auto x = static_cast<float>(random.Uniform(-4.0, 4.0));
    const auto y = static_cast<float>(random.Uniform(-4.0, 4.0));
    const float z =
        -(plane.normal.x() * x + plane.normal.y() * y + plane.offset_m) / plane.normal.z();
    cloud.Add({x, y, z + static_cast<float>(random.Normal(kNoise_m))});
  }
}

inline void AddWall(core::PointCloud& cloud, float x_m, std::size_t num_points, Random& random) {
  for (std::size_t i = 0; i < num_points; ++i) {
    cloud.Add({x_m + static_cast<float>(random.Normal(kNoise_m)),
               static_cast<float>(random.Uniform(-4.0, 4.0)),
               static_cast<float>(random.Uniform(0.0, 2.5))});
  }
}

inline void AddTable(core::PointCloud& cloud, std::size_t num_points, Random& random) {
  for (std::size_t i = 0; i < num_points; ++i) {
    cloud.Add({static_cast<float>(random.Uniform(1.5, 4.0)),
               static_cast<float>(random.Uniform(-1.0, 1.0)),
               0.75F + static_cast<float>(random.Normal(kNoise_m))});
  }
}

}  // namespace clearway::test
