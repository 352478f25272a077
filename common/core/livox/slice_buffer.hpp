// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "common/core/cloud.hpp"
#include "common/core/livox/data_packet.hpp"

namespace clearway::core::livox {

/// Collects the points of one slice in memory that is used again and again.
class SliceBuffer {
 public:
  explicit SliceBuffer(std::size_t max_points) : max_points_(max_points) {}

  /// Empties it.
  void Clear();

  /// Appends the returns of shots that follow one another, all echoes of each. The first was fired
  /// `time_offset_us` after the scan's start. What came late is sorted in by Cloud().
  void Add(std::span<const Point> points, std::size_t echoes, std::int32_t time_offset_us);

  [[nodiscard]] std::int64_t shots() const { return shots_; }
  [[nodiscard]] std::int64_t zero_returns() const { return zero_returns_; }
  [[nodiscard]] std::int64_t overflow_points() const { return overflow_points_; }

  /// The points in order of time; those of one shot in order of their echoes.
  [[nodiscard]] PointCloud Cloud() const;

 private:
  std::size_t max_points_;
  std::size_t size_ = 0;
  PointCloud points_;  // All arrays max_points_ long once it has been used.
  std::int32_t newest_offset_us_ = 0;
  bool is_sorted_ = true;
  std::int64_t shots_ = 0;
  std::int64_t zero_returns_ = 0;
  std::int64_t overflow_points_ = 0;
};

}  // namespace clearway::core::livox
