// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>

namespace clearway::core::livox {

/// The least delay of packets as a line over the sender's clock.
///
/// A sample is (stamp, arrival - stamp): a straight line, the offset of the two clocks and their
/// drift, plus a delay that is never negative. The line that lies under all samples and touches
/// them is therefore that of the quickest packets. Samples are kept as minima of half a second, for
/// 20 s; the line is the edge of their lower convex hull over the middle of that time. Until there
/// are 3 s it has slope 0. A sample below the line lowers it at once.
/// When the minima of 2 s lie more than 1 ms above the line, the host's clock was moved or its rate
/// changed, and what is older is forgotten; so the line follows within 2.5 s.
/// Source: S. Moon, P. Skelly, D. Towsley, "Estimation and removal of clock skew from network delay
/// measurements" (1999); as a hull: L. Zhang, Z. Liu, C. Xia, "Clock synchronization algorithms for
/// network measurements" (2002).
/// Time: O(1) a sample, O(buckets) twice a second. Allocates nothing. Thread safety: none.
class DelayEnvelope {
 public:
  /// All in nanoseconds since any fixed moments of their clocks.
  struct Sample {
    std::int64_t stamp_ns = 0;   ///< On the sender's clock.
    std::int64_t offset_ns = 0;  ///< Arrival less stamp.
    std::int64_t arrival_ns = 0;
  };

  /// Forgets everything and starts with a horizontal line through `sample`.
  void Start(const Sample& sample);

  /// Takes one more. @pre Start() was called.
  void Add(const Sample& sample);

  /// The line [ns].
  [[nodiscard]] double At(std::int64_t stamp_ns) const {
    return line_ns_ +
           slope_ * (static_cast<double>(stamp_ns) - static_cast<double>(line_stamp_ns_));
  }
  /// Its slope; 0 until it is known.
  [[nodiscard]] double slope() const { return slope_; }
  [[nodiscard]] bool knows_slope() const { return knows_slope_; }

 private:
  static constexpr std::size_t kMaxBuckets = 40;
  struct Point {
    double stamp_ns = 0.0;
    double offset_ns = 0.0;
  };

  void CloseBucket();
  void ForgetBeforeBend();
  void Fit();
  [[nodiscard]] double SlopeOfMiddleEdge() const;
  [[nodiscard]] double AboveLine(const Point& point) const;

  double line_ns_ = 0.0;
  std::int64_t line_stamp_ns_ = 0;
  double slope_ = 0.0;
  bool knows_slope_ = false;

  Sample bucket_start_;
  std::optional<Sample> lowest_;  // Of the bucket that is open.
  std::array<Point, kMaxBuckets> buckets_{};
  std::size_t num_buckets_ = 0;
};

}  // namespace clearway::core::livox
