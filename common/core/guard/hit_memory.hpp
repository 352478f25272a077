// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

#include <Eigen/Core>

#include "common/core/guard/swept_footprint.hpp"

namespace clearway::core {

/// The point that limits a direction.
struct NearestHit {
  double way = std::numeric_limits<double>::infinity();     ///< [m] or [rad], as in FreeWay.
  Eigen::Vector3f point_vehicle = Eigen::Vector3f::Zero();  ///< Meaningless when way is infinite.
};

/// Remembers, for a short time, what stands in the way: one pattern of a sparse scanner does not
/// hit everything each time. Hits are kept in a frame of the guard's own that is dead-reckoned from
/// the measured speeds, and so stay where they are while the vehicle moves.
///
/// A hit counts when at least `min_points` hits, itself included, lie in its cell (kCell_m square)
/// or the eight around it and are not older than the hold time. A cell keeps, for each direction,
/// the hit with the least way at the time it came, and the latest one: exact for a vehicle that
/// stands until the least one is too old, within one cell after that and when the vehicle moves.
/// Memory is fixed at construction; no call allocates. Thread safety: none.
class HitMemory {
 public:
  static constexpr double kCell_m = 0.1;
  /// Most hits that a cell counts; the limit of min_points.
  static constexpr int kMaxAgreeing = 4;

  /// Hits whose way straight ahead exceeds `reach_m` are not kept.
  HitMemory(const SweptFootprint& footprint, double reach_m, int min_points);

  /// Moves the vehicle by dead reckoning: `forward_m` along an arc that turns by `turn_rad`.
  void Move(double forward_m, double turn_rad);

  /// Takes a point that can be an obstacle. `clock_us` never goes back.
  void Add(const Eigen::Vector3f& point_vehicle, std::int64_t clock_us);

  /// For each direction, the nearest hit that counts and is not older than hold_us.
  [[nodiscard]] std::array<NearestHit, kNumDirections> Nearest(std::int64_t clock_us,
                                                               std::int64_t hold_us);

  void Clear();

 private:
  static constexpr std::int64_t kNever = std::numeric_limits<std::int64_t>::min() / 2;

  struct Hit {
    Eigen::Vector2d position_own = Eigen::Vector2d::Zero();
    float z_m = 0.0F;
    double way = std::numeric_limits<double>::infinity();
    std::int64_t clock_us = kNever;
  };
  struct Cell {
    std::int64_t cx = 0;
    std::int64_t cy = 0;
    bool is_listed = false;
    std::size_t next_recent = 0;
    std::array<std::int64_t, kMaxAgreeing> recent{kNever, kNever, kNever, kNever};
    std::array<Hit, kNumDirections> best;    // Least way at the time it came.
    std::array<Hit, kNumDirections> latest;  // Stands in when the best one grows too old.
  };

  [[nodiscard]] std::size_t IndexOf(std::int64_t cx, std::int64_t cy) const;
  void Expire(std::int64_t oldest_us);
  void TakeNearest(const Cell& cell, std::array<NearestHit, kNumDirections>& nearest) const;
  [[nodiscard]] int CountAround(const Cell& cell, std::int64_t oldest_us) const;
  [[nodiscard]] Eigen::Vector2d ToOwn(const Eigen::Vector2d& point_vehicle) const;
  [[nodiscard]] Eigen::Vector2d ToVehicle(const Eigen::Vector2d& point_own) const;

  SweptFootprint footprint_;
  double reach_m_;
  int min_points_;
  std::int64_t side_;                // Cells along a side of the square that wraps around.
  std::vector<Cell> cells_;          // side_ * side_
  std::vector<std::size_t> listed_;  // Indices of cells that hold something.
  Eigen::Vector2d position_own_ = Eigen::Vector2d::Zero();
  double heading_own_rad_ = 0.0;
};

}  // namespace clearway::core
