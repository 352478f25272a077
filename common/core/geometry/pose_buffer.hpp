// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <optional>

#include <Eigen/Geometry>

#include "common/core/geometry/pose.hpp"

namespace clearway::core {

/// Settings of PoseBuffer. XML elements: <odometry>, <pose>.
struct PoseBufferConfig {
  std::int64_t window_us = 10'000'000;
  std::int64_t max_extrapolation_us = 50'000;
  std::int64_t max_gap_us = 300'000;
  std::int64_t restart_us = 1'000'000;

  template <typename Self, typename Visitor>
  static void Visit(Self& self, Visitor& visitor) {
    visitor.Milliseconds("window_ms",
                         self.window_us,
                         100.0,
                         60000.0,
                         "Poses older than the newest by more than this are forgotten [ms]. Longer "
                         "than the slowest scan takes to arrive.");
    visitor.Milliseconds("max_extrapolation_ms",
                         self.max_extrapolation_us,
                         0.0,
                         50.0,
                         "How far past the newest pose the motion is carried on [ms]; after that "
                         "the pose counts as missing.");
    visitor.Milliseconds("max_gap_ms",
                         self.max_gap_us,
                         10.0,
                         5000.0,
                         "Two poses further apart than this are not interpolated between: what the "
                         "vehicle did meanwhile is not known [ms].");
    visitor.Milliseconds("restart_ms",
                         self.restart_us,
                         0.0,
                         60000.0,
                         "A stamp that goes back by more than this is a source that started anew "
                         "(or a log played again): older poses are forgotten [ms].");
  }
};

/// The last few seconds of T_fixed_vehicle (fixed: odom for ODOMETRY, map for POSE), to be asked at
/// any time in between.
/// Memory is bounded by the window and by kMaxPoses, whichever is less; Add is O(1) amortised,
/// Lookup O(log n). Thread safety: none.
class PoseBuffer {
 public:
  static constexpr std::size_t kMaxPoses = 20'000;

  enum class Outcome : std::int8_t {
    kAdded,
    kRestarted,   ///< Added, after the stamp went back by more than restart_us.
    kDuplicate,   ///< The newest stamp again; ignored.
    kOutOfOrder,  ///< A stamp before the newest, by restart_us at most; ignored.
    kInvalid,     ///< NaN, infinite, or a stamp below zero; ignored.
  };

  explicit PoseBuffer(const PoseBufferConfig& config = {}) : config_(config) {}

  Outcome Add(std::int64_t utime, const Eigen::Isometry3d& T_fixed_vehicle);

  /// T_fixed_vehicle at `utime`: between two neighbours by Interpolate(); after the newest pose by
  /// carrying on the motion between the last two at constant speed (their difference, not the
  /// message's twist: one source of truth), for max_extrapolation_us at most. Nothing before the
  /// oldest pose, inside a gap longer than max_gap_us, and further ahead.
  [[nodiscard]] std::optional<Eigen::Isometry3d> Lookup(std::int64_t utime) const;

  [[nodiscard]] std::optional<std::int64_t> newest_utime() const;
  [[nodiscard]] std::size_t size() const { return poses_.size(); }
  void Clear() { poses_.clear(); }

 private:
  [[nodiscard]] std::optional<Eigen::Isometry3d> Extrapolate(std::int64_t utime) const;

  PoseBufferConfig config_;
  std::deque<StampedPose> poses_;  // Strictly ascending stamps.
};

}  // namespace clearway::core
