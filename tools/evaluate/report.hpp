// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "tools/evaluate/evaluation.hpp"

namespace clearway::evaluate {

/// The table that a person reads.
[[nodiscard]] std::string FormatTable(const Evaluation& evaluation);

/// The figures with their stable names; what was not measured is absent. any_evidence, separated
/// and found are numbers of objects, as is `objects`.
/// "map_filter" is a list, so that those of several runs can be put together; its one entry holds
/// the filter's figures (see MapFilterCounts; leak = 1 - removal), and those of the detections that
/// came out. It is there when a scan says something about the filter.
[[nodiscard]] std::string FormatJson(const Evaluation& evaluation);

}  // namespace clearway::evaluate
