// SPDX-License-Identifier: BSD-3-Clause
#include "common/core/preprocessing/motion_track.hpp"

#include <algorithm>
#include <cmath>

namespace clearway::core {

MotionTrack::MotionTrack(const PoseBuffer& odometry,
                         std::int64_t utime_start,
                         std::int64_t utime_end,
                         const Eigen::Vector3d& origin_odom)
    : utime_start_(utime_start),
      utime_end_(utime_end),
      step_us_(std::max(kStep_us, (utime_end - utime_start + kMaxSteps - 1) / kMaxSteps)) {
  const std::int64_t num_steps = (utime_end - utime_start + step_us_ - 1) / step_us_;
  samples_.resize(static_cast<std::size_t>(num_steps) + 1);
  for (std::size_t k = 0; k < samples_.size(); ++k) {
    // The last step may be shorter: the pose at utime_end is known when nothing later is.
    const std::int64_t utime =
        std::min(utime_end, utime_start + static_cast<std::int64_t>(k) * step_us_);
    const std::optional<Eigen::Isometry3d> pose = odometry.Lookup(utime);
    if (!pose) continue;
    Matrix34f sample;
    sample.leftCols<3>() = pose->linear().cast<float>();
    sample.col(3) = (pose->translation() - origin_odom).cast<float>();
    samples_[k] = sample;
  }
}

std::optional<Eigen::Vector3f> MotionTrack::ToLocal(const Eigen::Vector3f& point_vehicle,
                                                    std::int64_t utime) const {
  if (utime < utime_start_ || utime > utime_end_) return std::nullopt;
  const auto k = static_cast<std::size_t>((utime - utime_start_) / step_us_);
  const std::int64_t left_utime = utime_start_ + static_cast<std::int64_t>(k) * step_us_;
  if (!samples_[k]) return std::nullopt;
  const Matrix34f& left = *samples_[k];
  const Eigen::Vector3f at_left = left.leftCols<3>() * point_vehicle + left.col(3);
  if (utime == left_utime) return at_left;
  if (!samples_[k + 1]) return std::nullopt;
  const Matrix34f& right = *samples_[k + 1];
  const Eigen::Vector3f at_right = right.leftCols<3>() * point_vehicle + right.col(3);
  const std::int64_t right_utime = std::min(utime_end_, left_utime + step_us_);
  const float alpha =
      static_cast<float>(utime - left_utime) / static_cast<float>(right_utime - left_utime);
  return Eigen::Vector3f(at_left + alpha * (at_right - at_left));
}

Eigen::Vector3d SnapToGrid(const Eigen::Vector3d& position_odom, double leaf_m) {
  return (position_odom / leaf_m).array().round().matrix() * leaf_m;
}

}  // namespace clearway::core
