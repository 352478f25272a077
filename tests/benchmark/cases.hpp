// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "common/core/cloud.hpp"

namespace clearway::bench {

/// One scan to measure on, in the vehicle frame (floor at z = 0), within 60 m in the plane.
struct Case {
  std::string name;
  core::PointCloud cloud;
  int max_repetitions = 1'000'000;  ///< Less where the textbook takes minutes.
};

/// The generated cases and those of the real recordings that are here; others are left out. With
/// `with_slow` also those on which the textbook chain takes seconds or more.
[[nodiscard]] std::vector<Case> MakeCases(bool with_slow);

}  // namespace clearway::bench
