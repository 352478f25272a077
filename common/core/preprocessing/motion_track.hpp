// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "common/core/geometry/pose_buffer.hpp"

namespace clearway::core {

/// The vehicle's motion during one scan, sampled so that each of its points can be moved cheaply.
///
/// Points go from `vehicle` at their own time to `local`: the odom frame with its origin shifted
/// (not turned) to `origin_odom`, so that floats stay exact far from odom's origin. Between the
/// samples, kStep_us apart, the matrices are interpolated linearly: at 3 rad/s the direction is
/// wrong by (3 * 0.001)^2 / 8, about 1e-6 rad.
/// Memory is bounded: long scans are sampled at kMaxSteps times. Thread safety: const.
class MotionTrack {
 public:
  static constexpr std::int64_t kStep_us = 1000;
  static constexpr std::int64_t kMaxSteps = 2000;

  /// Samples [utime_start, utime_end]. @pre utime_start <= utime_end.
  MotionTrack(const PoseBuffer& odometry,
              std::int64_t utime_start,
              std::int64_t utime_end,
              const Eigen::Vector3d& origin_odom);

  /// The point in `local`; nothing where the pose at that time is not known, and for times outside
  /// the sampled span.
  [[nodiscard]] std::optional<Eigen::Vector3f> ToLocal(const Eigen::Vector3f& point_vehicle,
                                                       std::int64_t utime) const;

 private:
  using Matrix34f = Eigen::Matrix<float, 3, 4, Eigen::DontAlign>;

  std::int64_t utime_start_;
  std::int64_t utime_end_;
  std::int64_t step_us_;
  std::vector<std::optional<Matrix34f>> samples_;  // The last one lies at utime_end or after it.
};

/// The multiple of `leaf_m` nearest to each coordinate of `position_odom`. Cells of a voxel grid
/// that starts there are the cells of the grid that starts at the origin of odom.
[[nodiscard]] Eigen::Vector3d SnapToGrid(const Eigen::Vector3d& position_odom, double leaf_m);

}  // namespace clearway::core
