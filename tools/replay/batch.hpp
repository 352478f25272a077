// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>

#include "common/graph/graph_config.hpp"
#include "tools/run_graph/run_statistics.hpp"

namespace clearway::replay {

struct BatchSettings {
  double duration_s = 30.0;         ///< Of virtual time.
  bool with_graph = true;           ///< False: simulator and driver alone; nobody permits motion.
  std::filesystem::path log = {};   ///< All messages go to this LCM log; empty: none is written.
  std::string channel_prefix = {};  ///< Of the log.
  std::string version = {};         ///< As the statuses tell it.
  std::function<void(double done_s)> on_progress = {};  ///< Every 0.1 s of virtual time.
};

/// Virtual time of the start [us since the epoch].
inline constexpr std::int64_t kBatchStartUtime = 1'000'000'000'000'000;

/// Simulator, driver and graph in memory, in virtual time, as fast as it goes: the robot drives,
/// the stop guard permits. Same configuration, seed and version: the same messages, byte for byte.
/// Throws what LoadSetting() throws, io::ReadError for the map, std::runtime_error when the log
/// cannot be written.
[[nodiscard]] run_graph::RunSummary RunBatch(const graph::GraphConfig& config,
                                             const BatchSettings& settings);

}  // namespace clearway::replay
