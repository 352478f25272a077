// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "tools/evaluate/score.hpp"

namespace clearway::evaluate {

/// Objects between two distances from the vehicle's origin, min_m <= range < max_m.
struct RangeBin {
  double min_m = 0.0;
  double max_m = 0.0;
  std::size_t objects = 0;
  std::size_t any_evidence = 0;  ///< How many of them; see ObjectScore.
  std::size_t separated = 0;     ///< How many of them.
};

/// Figures of many scans. What nothing was measured of is absent.
struct Summary {
  std::vector<RangeBin> recall;  ///< Nearest first; bins without objects are left out.
  std::size_t scans = 0;
  std::size_t objects = 0;
  std::size_t within_radius = 0;              ///< How many of them.
  std::size_t few_points = 0;                 ///< Boxes that were left out.
  std::size_t out_of_range = 0;               ///< Boxes that were left out.
  std::optional<double> detections_per_scan;  ///< Mean.
  std::optional<std::size_t> splits;
  std::optional<std::size_t> merges;

  // Over the objects that have a match; medians unless they say otherwise.
  std::optional<double> centre_error_m;
  std::optional<double> centre_error_p99_m;
  std::optional<double> nearest_error_m;
  std::optional<double> yaw_error_deg;
};

/// The smallest value that at least the share `q` of all values do not exceed (nearest rank), save
/// that q = 0.5 of an even number is the mean of the middle two. Nothing for no values.
/// @pre 0 < q <= 1.
[[nodiscard]] std::optional<double> Quantile(std::vector<double> values, double q);

/// Sums up; the order of the scans does not matter.
[[nodiscard]] Summary Summarise(std::span<const SceneScore> scenes);

}  // namespace clearway::evaluate
