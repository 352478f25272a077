// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "tests/benchmark/cases.hpp"

namespace clearway::bench {

/// The figures of one stage on one case. What was not measured is absent.
struct Row {
  std::string case_name;
  std::string stage;             ///< voxel, floor, clustering, detection, or chain (all of them).
  std::size_t points = 0;        ///< That go into the stage.
  double textbook_ms = 0.0;      ///< Median.
  double textbook_p99_ms = 0.0;  ///< Nearest rank; the largest below 100 repetitions.
  std::optional<double> ns_per_point;
  std::optional<double> pcl_ms;  ///< pcl::EuclideanClusterExtraction on the same input, median.
  std::optional<double> ratio_to_pcl;
  std::optional<bool> partition_equal;  ///< The same clusters as PCL's.
};

/// Measures all stages, each on the same frozen input in every repetition, and the chain from the
/// scan to the detections. What is compared runs in turn within one repetition, so that a busy
/// machine hits both. One more repetition before is not counted.
[[nodiscard]] std::vector<Row> Measure(const Case& test_case, int repetitions);

}  // namespace clearway::bench
