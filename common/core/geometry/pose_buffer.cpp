// SPDX-License-Identifier: BSD-3-Clause
#include "common/core/geometry/pose_buffer.hpp"

#include <algorithm>

namespace clearway::core {

namespace {

double Fraction(const StampedPose& a, const StampedPose& b, std::int64_t utime) {
  return static_cast<double>(utime - a.utime) / static_cast<double>(b.utime - a.utime);
}

// Between equal poses the pose is exactly that one, whatever the fraction: who stands still gives
// the same result however often he is told so.
Eigen::Isometry3d Between(const StampedPose& a, const StampedPose& b, std::int64_t utime) {
  if (a.T_fixed_vehicle.matrix() == b.T_fixed_vehicle.matrix()) return a.T_fixed_vehicle;
  return Interpolate(a.T_fixed_vehicle, b.T_fixed_vehicle, Fraction(a, b, utime));
}

}  // namespace

PoseBuffer::Outcome PoseBuffer::Add(std::int64_t utime, const Eigen::Isometry3d& T_fixed_vehicle) {
  if (utime < 0 || !IsFinite(T_fixed_vehicle)) return Outcome::kInvalid;
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
  poses_.push_back({utime, T_fixed_vehicle});
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
  if (right->utime == utime) return right->T_fixed_vehicle;
  const StampedPose& left = *(right - 1);
  if (right->utime - left.utime > config_.max_gap_us) return std::nullopt;
  return Between(left, *right, utime);
}

std::optional<Eigen::Isometry3d> PoseBuffer::Extrapolate(std::int64_t utime) const {
  if (poses_.size() < 2 || utime - poses_.back().utime > config_.max_extrapolation_us) {
    return std::nullopt;
  }
  const StampedPose& last = poses_.back();
  const StampedPose& previous = poses_[poses_.size() - 2];
  if (last.utime - previous.utime > config_.max_gap_us) return std::nullopt;
  return Between(previous, last, utime);
}

std::optional<std::int64_t> PoseBuffer::newest_utime() const {
  if (poses_.empty()) return std::nullopt;
  return poses_.back().utime;
}

}  // namespace clearway::core
