// SPDX-License-Identifier: BSD-3-Clause
#include "common/core/cloud.hpp"

#include <cmath>

namespace clearway::core {

void PointCloud::Clear() {
  x.clear();
  y.clear();
  z.clear();
  intensity.clear();
  tag.clear();
  time_offset_us.clear();
}

void PointCloud::Reserve(std::size_t n) {
  x.reserve(n);
  y.reserve(n);
  z.reserve(n);
  intensity.reserve(n);
  tag.reserve(n);
  time_offset_us.reserve(n);
}

void PointCloud::Add(const Eigen::Vector3f& point,
                     std::uint8_t point_intensity,
                     std::uint8_t point_tag,
                     std::int32_t point_time_offset_us) {
  x.push_back(point.x());
  y.push_back(point.y());
  z.push_back(point.z());
  intensity.push_back(point_intensity);
  tag.push_back(point_tag);
  time_offset_us.push_back(point_time_offset_us);
}

void PointCloud::AddFrom(const PointCloud& other, std::size_t i) {
  Add(other.Point(i), other.intensity[i], other.tag[i], other.time_offset_us[i]);
}

void PointCloud::Append(const PointCloud& other) {
  x.insert(x.end(), other.x.begin(), other.x.end());
  y.insert(y.end(), other.y.begin(), other.y.end());
  z.insert(z.end(), other.z.begin(), other.z.end());
  intensity.insert(intensity.end(), other.intensity.begin(), other.intensity.end());
  tag.insert(tag.end(), other.tag.begin(), other.tag.end());
  time_offset_us.insert(
      time_offset_us.end(), other.time_offset_us.begin(), other.time_offset_us.end());
}

bool IsFinite(const PointCloud& cloud, std::size_t i) {
  return std::isfinite(cloud.x[i]) && std::isfinite(cloud.y[i]) && std::isfinite(cloud.z[i]);
}

}  // namespace clearway::core
