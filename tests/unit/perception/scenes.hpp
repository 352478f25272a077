// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <numbers>
#include <numeric>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "common/core/cloud.hpp"
#include "common/core/perception/backend.hpp"
#include "tests/support/make_room.hpp"

namespace clearway::test {

inline constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
inline constexpr float kInfinity = std::numeric_limits<float>::infinity();

/// Each backend passes the same tests.
inline std::vector<core::Backend> AllBackends() {
  std::vector<core::Backend> backends;
  for (const auto& [name, backend] : core::kBackendNames) backends.push_back(backend);
  return backends;
}

/// The backend's name, for the name of a test.
inline std::string BackendName(const testing::TestParamInfo<core::Backend>& info) {
  for (const auto& [name, backend] : core::kBackendNames) {
    if (backend == info.param) return name;
  }
  return "unknown";
}

inline Eigen::Vector3f RandomPoint(Random& random, double half_side_m) {
  const double x = random.Uniform(-half_side_m, half_side_m);
  const double y = random.Uniform(-half_side_m, half_side_m);
  const double z = random.Uniform(-half_side_m, half_side_m);
  return {static_cast<float>(x), static_cast<float>(y), static_cast<float>(z)};
}

/// Points spread evenly over a cube around the origin, intensities 0..255.
inline core::PointCloud RandomCube(Random& random, std::size_t num_points, double half_side_m) {
  core::PointCloud cloud;
  for (std::size_t i = 0; i < num_points; ++i) {
    cloud.Add(RandomPoint(random, half_side_m), static_cast<std::uint8_t>(random.Index(256)));
  }
  return cloud;
}

/// A random order of 0..n-1 (Fisher-Yates).
inline std::vector<std::uint32_t> RandomOrder(Random& random, std::size_t n) {
  std::vector<std::uint32_t> order(n);
  std::iota(order.begin(), order.end(), 0U);
  for (std::size_t i = n; i > 1; --i) std::swap(order[i - 1], order[random.Index(i)]);
  return order;
}

/// The points in another order: point i of the result is point order[i] of the cloud.
inline core::PointCloud Reordered(const core::PointCloud& cloud,
                                  const std::vector<std::uint32_t>& order) {
  core::PointCloud reordered;
  for (const std::uint32_t i : order) reordered.AddFrom(cloud, i);
  return reordered;
}

}  // namespace clearway::test
