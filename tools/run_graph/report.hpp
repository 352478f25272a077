// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "tools/run_graph/graph_run.hpp"

namespace clearway::run_graph {

/// The table that a person reads.
[[nodiscard]] std::string FormatTable(const RunSummary& summary,
                                      const std::optional<MachineUse>& use);

/// The figures with their stable names; what was not measured is absent.
[[nodiscard]] std::string FormatJson(const RunSummary& summary,
                                     const std::optional<MachineUse>& use);

}  // namespace clearway::run_graph
