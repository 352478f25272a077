// SPDX-License-Identifier: BSD-3-Clause
#include "common/core/livox/slice_buffer.hpp"

#include <algorithm>
#include <limits>
#include <numeric>

namespace clearway::core::livox {
namespace {

template <typename T>
std::vector<T> Taken(const std::vector<T>& values, const std::vector<std::uint32_t>& order) {
  std::vector<T> taken(order.size());
  std::transform(
      order.begin(), order.end(), taken.begin(), [&](std::uint32_t i) { return values[i]; });
  return taken;
}

template <typename T>
std::vector<T> First(const std::vector<T>& values, std::size_t size) {
  return {values.begin(), values.begin() + static_cast<std::ptrdiff_t>(size)};
}

}  // namespace

void SliceBuffer::Clear() {
  size_ = 0;
  newest_offset_us_ = std::numeric_limits<std::int32_t>::min();
  is_sorted_ = true;
  shots_ = 0;
  zero_returns_ = 0;
  overflow_points_ = 0;
}

void SliceBuffer::Add(std::span<const Point> points,
                      std::size_t echoes,
                      std::int32_t time_offset_us) {
  if (points_.size() < max_points_) {
    points_.x.resize(max_points_);
    points_.y.resize(max_points_);
    points_.z.resize(max_points_);
    points_.intensity.resize(max_points_);
    points_.tag.resize(max_points_);
    points_.time_offset_us.resize(max_points_);
  }
  if (time_offset_us < newest_offset_us_) is_sorted_ = false;
  for (std::size_t i = 0; i < points.size(); i += echoes) {
    bool has_return = false;
    for (std::size_t echo = i; echo < i + echoes; ++echo) {
      const Point& point = points[echo];
      if (!point.is_return()) continue;
      has_return = true;
      if (size_ == max_points_) {
        ++overflow_points_;
        continue;
      }
      points_.x[size_] = point.x_m;
      points_.y[size_] = point.y_m;
      points_.z[size_] = point.z_m;
      points_.intensity[size_] = point.reflectivity;
      points_.tag[size_] = point.tag;
      points_.time_offset_us[size_] = time_offset_us;
      ++size_;
    }
    ++shots_;
    if (!has_return) ++zero_returns_;
    newest_offset_us_ = std::max(newest_offset_us_, time_offset_us);
    time_offset_us += static_cast<std::int32_t>(kShotPeriod_us);
  }
}

PointCloud SliceBuffer::Cloud() const {
  PointCloud cloud;
  if (is_sorted_) {
    cloud.x = First(points_.x, size_);
    cloud.y = First(points_.y, size_);
    cloud.z = First(points_.z, size_);
    cloud.intensity = First(points_.intensity, size_);
    cloud.tag = First(points_.tag, size_);
    cloud.time_offset_us = First(points_.time_offset_us, size_);
    return cloud;
  }
  std::vector<std::uint32_t> order(size_);
  std::iota(order.begin(), order.end(), 0U);
  std::stable_sort(order.begin(), order.end(), [this](std::uint32_t a, std::uint32_t b) {
    return points_.time_offset_us[a] < points_.time_offset_us[b];
  });
  cloud.x = Taken(points_.x, order);
  cloud.y = Taken(points_.y, order);
  cloud.z = Taken(points_.z, order);
  cloud.intensity = Taken(points_.intensity, order);
  cloud.tag = Taken(points_.tag, order);
  cloud.time_offset_us = Taken(points_.time_offset_us, order);
  return cloud;
}

}  // namespace clearway::core::livox
