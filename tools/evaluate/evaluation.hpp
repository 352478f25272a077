// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "common/graph/graph_config.hpp"
#include "common/io/cloud_source.hpp"
#include "tools/evaluate/labels.hpp"
#include "tools/evaluate/map_filter_score.hpp"
#include "tools/evaluate/score.hpp"
#include "tools/evaluate/summary.hpp"

namespace clearway::evaluate {

/// What is compared with what.
struct EvaluationInput {
  std::filesystem::path log;     ///< Holds DETECTIONS and OBSTACLE_POINTS; for the map filter's
                                 ///< figures also REMOVED_POINTS, and POSE for its error.
  std::filesystem::path labels;  ///< See ReadLabels().
  std::filesystem::path input;   ///< The recording that was played.
  std::string channel_prefix;
  std::optional<Eigen::Isometry3d> T_map_reference = {};  ///< Where the vehicle really stood.
};

/// The figures, and what could not be scored.
struct Evaluation {
  ScoreRules rules;
  Summary summary;
  std::optional<MapFilterSummary> map_filter = {};  ///< Nothing without REMOVED_POINTS.
  std::size_t scans_missing_slices = 0;             ///< Labelled, in the log, but not whole.
  std::size_t scans_unlabelled = 0;   ///< In the log, but not labelled or not of the input.
  std::size_t labels_not_in_log = 0;  ///< Labelled scans that the log does not hold at all.
  std::size_t messages_invalid = 0;   ///< Messages that do not decode or contradict others.
};

/// Finds the labels of a scan by its stamp: stamp -> scan of the recording -> stem of its file (a
/// scan of a cut file: stem#k) -> labels. Opens a scan's file when it is asked for it.
class ScanNames {
 public:
  /// Throws io::ReadError.
  ScanNames(const std::filesystem::path& input, const io::RecordingConfig& config);

  /// Key of the scan in the labels; empty when no scan has the stamp. Throws io::ReadError.
  [[nodiscard]] std::string KeyOf(std::int64_t scan_utime);

 private:
  io::CloudSource source_;
  bool is_cut_;
  std::map<std::int64_t, std::size_t> scans_;  // By utime.
};

/// Scores the log. Labels are brought from the frame of the configuration's first sensor to the
/// vehicle's. Throws io::ReadError, also when not one scan could be scored.
[[nodiscard]] Evaluation Evaluate(const EvaluationInput& input,
                                  const graph::GraphConfig& config,
                                  const ScoreRules& rules);

}  // namespace clearway::evaluate
