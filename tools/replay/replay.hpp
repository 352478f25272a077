// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>

#include "common/graph/graph_config.hpp"
#include "tools/replay/compare_detections.hpp"
#include "tools/replay/log_inputs.hpp"
#include "tools/run_graph/run_statistics.hpp"

namespace clearway::replay {

/// How far a replay has come.
struct Progress {
  double share = 0.0;       ///< Of the log, 0..1.
  double recorded_s = 0.0;  ///< Of the recording, since its first input.
};

struct ReplaySettings {
  std::filesystem::path log = {};
  std::filesystem::path output = {};                      ///< An LCM log; empty: none is written.
  bool with_inputs = false;                               ///< What is fed is written, too.
  std::string channel_prefix = {};                        ///< Of the log and of the output.
  std::string version = {};                               ///< As the statuses tell it.
  std::function<void(const Progress&)> on_progress = {};  ///< After each input; may be empty.
};

/// What a replay came to.
struct ReplayResult {
  run_graph::RunSummary summary;  ///< Without durations: in virtual time there are none.
  InputCounts inputs;
  double recorded_s = 0.0;        ///< From the first input to the last.
  std::int64_t dropped = 0;       ///< Messages that the processes gave up because too many waited.
  std::int64_t invalid = 0;       ///< Messages that a process could not use; counted by each.
  std::string channels;           ///< Of the log, for people.
  std::string preprocessor_says;  ///< State of the preprocessor at the end of the inputs.
  DetectionsOfRun detections{"this replay"};
};

/// Feeds the inputs of an LCM log to the process objects of a graph in virtual time: each when the
/// log's stamp says, as fast as it goes. Virtual time begins kSettleUs before the first input
/// (kSettleWithMapUs when a map is served, so that it is there before the first scan) and ends
/// kDrainUs after the last. When the configuration runs a pose source, POSE and POSE_STATUS of the
/// log are left out: a channel has one publisher.
/// Same log, configuration, map and version: the same output, byte for byte. Memory does not grow
/// with the points of the log. Throws io::ReadError when the log cannot be opened or holds no
/// input, or the map cannot be loaded; std::runtime_error when the output cannot be written.
[[nodiscard]] ReplayResult Replay(const graph::GraphConfig& config, const ReplaySettings& settings);

inline constexpr std::int64_t kSettleUs = 1'000'000;
inline constexpr std::int64_t kSettleWithMapUs = 10'000'000;
inline constexpr std::int64_t kDrainUs = 1'000'000;

}  // namespace clearway::replay
