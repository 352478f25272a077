// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include <Eigen/Core>

namespace clearway::core {

/// A point cloud as a structure of arrays. The frame is stated by whoever holds it. All six arrays
/// have the same length at all times; what a source does not know is 0.
/// Coordinates may be NaN or infinite; algorithms state what they do with such points.
struct PointCloud {
  std::vector<float> x;                      ///< [m]
  std::vector<float> y;                      ///< [m]
  std::vector<float> z;                      ///< [m]
  std::vector<std::uint8_t> intensity;       ///< Reflectivity, 0..255 as the sensor gives it.
  std::vector<std::uint8_t> tag;             ///< The sensor's tag bits, 0 when it has none.
  std::vector<std::int32_t> time_offset_us;  ///< Time of the shot after the cloud's stamp [us].

  [[nodiscard]] std::size_t size() const { return x.size(); }
  [[nodiscard]] bool empty() const { return x.empty(); }
  [[nodiscard]] Eigen::Vector3f Point(std::size_t i) const { return {x[i], y[i], z[i]}; }

  void Clear();
  void Reserve(std::size_t n);
  void Add(const Eigen::Vector3f& point,
           std::uint8_t point_intensity = 0,
           std::uint8_t point_tag = 0,
           std::int32_t point_time_offset_us = 0);

  /// Appends point i of `other`, with all that belongs to it.
  void AddFrom(const PointCloud& other, std::size_t i);

  /// Appends all points of `other`.
  void Append(const PointCloud& other);
};

/// True when all three coordinates of point i are finite.
[[nodiscard]] bool IsFinite(const PointCloud& cloud, std::size_t i);

}  // namespace clearway::core
