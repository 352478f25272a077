// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include <Eigen/Core>

#include "tools/plot/scan_picture.hpp"

namespace clearway::plot {

/// The part of the world that both panels show, vehicle frame [m].
struct ViewRegion {
  double x_min_m = -1.0;
  double x_max_m = 1.0;
  double y_min_m = -1.0;
  double y_max_m = 1.0;
  double z_max_m = 1.0;
  double range_m = 1.0;  ///< 98th percentile of the points' distances from the origin, level.

  /// Some thousands of the points within range_m and below z_max_m: what a camera should have in
  /// view, but for the outermost few.
  std::vector<Eigen::Vector3f> sample = {};

  /// What it must have in view: origin, sensor, footprint.
  std::vector<Eigen::Vector3f> anchors = {};
};

/// The region around the origin and the nearest 98 % of the points; at least 3 m a side.
[[nodiscard]] ViewRegion ChooseRegion(const ScanPicture& picture);

/// The largest distance of the form 1, 2 or 5 times a power of ten that is not larger than
/// `about_m`, which must be positive.
[[nodiscard]] double RoundStep(double about_m);

/// "0", "2", "-0.5": a multiple of a round step, without needless digits.
[[nodiscard]] std::string StepLabel(double value_m, double step_m);

}  // namespace clearway::plot
