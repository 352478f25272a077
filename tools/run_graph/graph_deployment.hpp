// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "common/core/procman/deployment.hpp"
#include "tools/run_graph/run_settings.hpp"

namespace clearway::run_graph {

/// Groups of the deployment: the processes of the graph, and what feeds them.
inline constexpr char kGraphGroup[] = "graph";
inline constexpr char kInputGroup[] = "input";

/// The one command of kInputGroup: "play", "livox_driver", "simulator"; there is none for a live
/// input.
[[nodiscard]] std::string FeederName(const RunSettings& settings);

/// Names of the graph's processes in this run, as in <NAME>_STATUS.
[[nodiscard]] std::vector<std::string> ProcessNames(const RunSettings& settings);

/// What a run's deputy is to run. Programs are named without their folder, since a deputy finds
/// those beside itself first. Nothing is started again when it ends: a run with a death is none.
[[nodiscard]] core::procman::Deployment MakeDeployment(const RunSettings& settings,
                                                       const std::string& deputy);

}  // namespace clearway::run_graph
