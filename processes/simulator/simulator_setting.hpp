// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>

#include "common/graph/graph_config.hpp"
#include "processes/simulator/simulator_process.hpp"

namespace clearway {

/// Reads the scene and the map of the walls that a configuration names; `scene` is taken instead of
/// the configured file unless it is empty. Throws config::ConfigError or io::ReadError with what is
/// wrong in a file, std::runtime_error when no scene is named.
[[nodiscard]] SimulatorProcess::Setting LoadSetting(const graph::GraphConfig& config,
                                                    const std::filesystem::path& scene);

}  // namespace clearway
