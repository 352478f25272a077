// SPDX-License-Identifier: BSD-3-Clause
#include "common/core/geometry/pose_buffer.hpp"

#include <algorithm>

namespace clearway::core {

namespace {

double Fraction(const StampedPose& a, const StampedPose& b, std::int64_t utime) {
  return static_cast<double>(utime - a.utime) / static_cast<double>(b.utime - a.utime);
}

}  // namespace

PoseBuffer::Outcome PoseBuffer::Add(std::int64_t utime, const Eigen::Isometry3d& T_odom_vehicle) {
  if (utime < 0 || !IsFinite(T_odom_vehicle)) return Outcome::kInvalid;
  Outcome outcome = Outcome::kAdded;
  if (!poses_.empty()) {
    const std::int64_t newest = poses_.back().utime;
    if (utime == newest) return Outcome::kDuplicate;
    if (utime < newest) {
      if (newest - utime <= config_.restart_us) return Outcome::kOutOfOrder;
      poses_.clear();
      outcome = Outcome::kRestarted;
    }
  }
  poses_.push_back({utime, T_odom_vehicle});
  while (poses_.size() > kMaxPoses || utime - poses_.front().utime > config_.window_us) {
    poses_.pop_front();
  }
  return outcome;
}

std::optional<Eigen::Isometry3d> PoseBuffer::Lookup(std::int64_t utime) const {
  if (poses_.empty() || utime < poses_.front().utime) return std::nullopt;
  if (utime > poses_.back().utime) return Extrapolate(utime);
  const auto right = std::lower_bound(
      poses_.begin(), poses_.end(), utime, [](const StampedPose& pose, std::int64_t t) {
        return pose.utime < t;
      });
  if (right->utime == utime) return right->T_odom_vehicle;
  const StampedPose& left = *(right - 1);
  if (right->utime - left.utime > config_.max_gap_us) return std::nullopt;
  return Interpolate(left.T_odom_vehicle, right->T_odom_vehicle, Fraction(left, *right, utime));
}

std::optional<Eigen::Isometry3d> PoseBuffer::Extrapolate(std::int64_t utime) const {
  if (poses_.size() < 2 || utime - poses_.back().utime > config_.max_extrapolation_us) {
    return std::nullopt;
  }
  const StampedPose& last = poses_.back();
  const StampedPose& previous = poses_[poses_.size() - 2];
  if (last.utime - previous.utime > config_.max_gap_us) return std::nullopt;
  return Interpolate(previous.T_odom_vehicle, last.T_odom_vehicle, Fraction(previous, last, utime));
}

std::optional<std::int64_t> PoseBuffer::newest_utime() const {
  if (poses_.empty()) return std::nullopt;
  return poses_.back().utime;
}

}  // namespace clearway::core
