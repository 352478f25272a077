// SPDX-License-Identifier: BSD-3-Clause
#include "common/core/livox/delay_envelope.hpp"

#include <algorithm>

namespace clearway::core::livox {
namespace {

constexpr std::int64_t kBucket_ns = 500'000'000;
// A burst that waited somewhere spans much of the sender's time and little of ours: it tells one
// delay, not one for each bucket.
constexpr std::int64_t kMinBucketArrivals_ns = 400'000'000;
constexpr double kMinSpanForSlope_ns = 3e9;
constexpr double kMaxSlope = 1e-3;
constexpr double kBend_ns = 1e6;
constexpr std::size_t kBendBuckets = 4;

}  // namespace

void DelayEnvelope::Start(const Sample& sample) {
  line_ns_ = static_cast<double>(sample.offset_ns);
  line_stamp_ns_ = sample.stamp_ns;
  slope_ = 0.0;
  knows_slope_ = false;
  num_buckets_ = 0;
  bucket_start_ = sample;
  lowest_ = sample;
}

void DelayEnvelope::Add(const Sample& sample) {
  const double above_ns = static_cast<double>(sample.offset_ns) - At(sample.stamp_ns);
  if (above_ns < 0.0) line_ns_ += above_ns;
  if (!lowest_) {
    bucket_start_ = sample;
    lowest_ = sample;
    return;
  }
  if (static_cast<double>(sample.offset_ns) - At(sample.stamp_ns) <
      static_cast<double>(lowest_->offset_ns) - At(lowest_->stamp_ns)) {
    lowest_ = sample;
  }
  if (sample.stamp_ns - bucket_start_.stamp_ns >= kBucket_ns &&
      sample.arrival_ns - bucket_start_.arrival_ns >= kMinBucketArrivals_ns) {
    CloseBucket();
  }
}

void DelayEnvelope::CloseBucket() {
  if (num_buckets_ == kMaxBuckets) {
    std::move(buckets_.begin() + 1, buckets_.end(), buckets_.begin());
    --num_buckets_;
  }
  buckets_[num_buckets_++] = {.stamp_ns = static_cast<double>(lowest_->stamp_ns),
                              .offset_ns = static_cast<double>(lowest_->offset_ns)};
  lowest_.reset();
  ForgetBeforeBend();
  Fit();
}

double DelayEnvelope::AboveLine(const Point& point) const {
  return point.offset_ns - line_ns_ -
         slope_ * (point.stamp_ns - static_cast<double>(line_stamp_ns_));
}

void DelayEnvelope::ForgetBeforeBend() {
  if (num_buckets_ <= kBendBuckets) return;
  const auto end = buckets_.begin() + static_cast<std::ptrdiff_t>(num_buckets_);
  const auto bend = end - static_cast<std::ptrdiff_t>(kBendBuckets);
  if (!std::all_of(bend, end, [this](const Point& p) { return AboveLine(p) > kBend_ns; })) return;
  std::move(bend, end, buckets_.begin());
  num_buckets_ = kBendBuckets;
}

double DelayEnvelope::SlopeOfMiddleEdge() const {
  // Lower convex hull of points that ascend in time: Andrew's monotone chain.
  std::array<Point, kMaxBuckets> hull;
  std::size_t size = 0;
  for (std::size_t i = 0; i < num_buckets_; ++i) {
    const Point& p = buckets_[i];
    // Packets that overtook each other at a border.
    if (size > 0 && p.stamp_ns <= hull[size - 1].stamp_ns) continue;
    while (size >= 2) {
      const Point& a = hull[size - 2];
      const Point& b = hull[size - 1];
      const double turn = (b.stamp_ns - a.stamp_ns) * (p.offset_ns - a.offset_ns) -
                          (b.offset_ns - a.offset_ns) * (p.stamp_ns - a.stamp_ns);
      if (turn > 0.0) break;
      --size;
    }
    hull[size++] = p;
  }
  if (size < 2) return slope_;
  const double middle_ns = 0.5 * (hull[0].stamp_ns + hull[size - 1].stamp_ns);
  std::size_t right = 1;
  while (right + 1 < size && hull[right].stamp_ns < middle_ns) ++right;
  const Point& a = hull[right - 1];
  const Point& b = hull[right];
  return (b.offset_ns - a.offset_ns) / (b.stamp_ns - a.stamp_ns);
}

void DelayEnvelope::Fit() {
  const double span_ns = buckets_[num_buckets_ - 1].stamp_ns - buckets_[0].stamp_ns;
  if (span_ns >= kMinSpanForSlope_ns) {
    slope_ = std::clamp(SlopeOfMiddleEdge(), -kMaxSlope, kMaxSlope);
    knows_slope_ = true;
  }
  const Point& newest = buckets_[num_buckets_ - 1];
  line_stamp_ns_ = static_cast<std::int64_t>(newest.stamp_ns);
  line_ns_ = newest.offset_ns;
  double lowest_ns = 0.0;
  for (std::size_t i = 0; i < num_buckets_; ++i) {
    lowest_ns = std::min(lowest_ns, AboveLine(buckets_[i]));
  }
  line_ns_ += lowest_ns;
}

}  // namespace clearway::core::livox
