// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <numbers>
#include <random>
#include <utility>
#include <vector>

#include <Eigen/Core>

#include "common/core/cloud.hpp"

namespace clearway::test {

/// Uniform numbers that are the same with every standard library.
class Random {
 public:
  explicit Random(std::uint32_t seed) : engine_(seed) {}

  /// In [low, high).
  double Uniform(double low, double high) {
    return low + (high - low) * (static_cast<double>(engine_()) / 4294967296.0);
  }

  /// Zero mean, close to normal (Irwin-Hall of 12).
  double Normal(double sigma) {
    double sum = -6.0;
    for (int i = 0; i < 12; ++i) sum += Uniform(0.0, 1.0);
    return sigma * sum;
  }

  /// In [0, n).
  std::size_t Index(std::size_t n) {
    return static_cast<std::size_t>(Uniform(0.0, static_cast<double>(n)));
  }

 private:
  std::mt19937 engine_;
};

/// A box-shaped room with boxes on its floor, seen by a sensor like a MID-70.
struct RoomOptions {
  std::size_t num_points = 10'000;                          // 0.1 s of a MID-70
  Eigen::Vector3d size_m = {12.0, 8.0, 3.0};                // x from -2 m, y centred, z from 0
  int num_boxes = 10;                                       // 0.1..0.8 m wide, 0.1..1.8 m high
  double half_field_rad = 35.2 * std::numbers::pi / 180.0;  // of the cone around +x
  double noise_m = 0.01;                                    // along the ray, 1 sigma
  std::uint32_t seed = 1;
};

/// An axis-aligned box [m].
struct Box {
  Eigen::Vector3d min;
  Eigen::Vector3d max;
};

/// The parameter interval of a ray inside a box; empty (first > second) when it misses.
inline std::pair<double, double> Interval(const Box& box,
                                          const Eigen::Vector3d& origin,
                                          const Eigen::Vector3d& direction) {
  double enter = -std::numeric_limits<double>::infinity();
  double leave = std::numeric_limits<double>::infinity();
  for (Eigen::Index axis = 0; axis < 3; ++axis) {
    const double t0 = (box.min[axis] - origin[axis]) / direction[axis];
    const double t1 = (box.max[axis] - origin[axis]) / direction[axis];
    enter = std::max(enter, std::min(t0, t1));
    leave = std::min(leave, std::max(t0, t1));
  }
  return {enter, leave};
}

inline std::vector<Box> RoomBoxes(const RoomOptions& options, Random& random) {
  std::vector<Box> boxes;
  for (int i = 0; i < options.num_boxes; ++i) {
    const Eigen::Vector3d center(random.Uniform(1.5, options.size_m.x() - 2.5),
                                 random.Uniform(-0.45, 0.45) * options.size_m.y(),
                                 0.0);
    const Eigen::Vector3d half(random.Uniform(0.05, 0.4), random.Uniform(0.05, 0.4), 0.0);
    const Eigen::Vector3d height(0.0, 0.0, random.Uniform(0.1, 1.8));
    boxes.push_back({center - half, center + half + height});
  }
  return boxes;
}

inline Eigen::Vector3d DirectionInField(const RoomOptions& options, Random& random) {
  const double cosine = random.Uniform(std::cos(options.half_field_rad), 1.0);
  const double sine = std::sqrt(1.0 - cosine * cosine);
  const double turn_rad = random.Uniform(0.0, 2.0 * std::numbers::pi);
  return {cosine, sine * std::cos(turn_rad), sine * std::sin(turn_rad)};
}

/// A scan of the room in the vehicle frame, floor at z = 0, sensor at (0.2, 0, 0.5) m.
inline core::PointCloud MakeRoom(const RoomOptions& options) {
  Random random(options.seed);
  const Eigen::Vector3d sensor(0.2, 0.0, 0.5);
  const double half_y_m = options.size_m.y() / 2.0;
  const Box room{.min = {-2.0, -half_y_m, 0.0},
                 .max = {options.size_m.x() - 2.0, half_y_m, options.size_m.z()}};
  const std::vector<Box> boxes = RoomBoxes(options, random);

  core::PointCloud cloud;
  cloud.Reserve(options.num_points);
  for (std::size_t i = 0; i < options.num_points; ++i) {
    const Eigen::Vector3d direction = DirectionInField(options, random);
    double range_m = Interval(room, sensor, direction).second;
    for (const Box& box : boxes) {
      const auto [enter, leave] = Interval(box, sensor, direction);
      if (enter > 0.0 && enter <= leave) range_m = std::min(range_m, enter);
    }
    range_m += random.Normal(options.noise_m);
    cloud.Add((sensor + range_m * direction).cast<float>(), 100);
  }
  return cloud;
}

}  // namespace clearway::test
