// SPDX-License-Identifier: BSD-3-Clause
#include "tools/evaluate/evaluation.hpp"

#include <utility>

#include "common/io/read_error.hpp"
#include "tools/evaluate/log_scans.hpp"

namespace clearway::evaluate {
namespace {

std::vector<Box> AllMoved(const Eigen::Isometry3d& T_G_F, const std::vector<Box>& boxes) {
  std::vector<Box> moved;
  for (const Box& box : boxes) moved.push_back(Moved(T_G_F, box));
  return moved;
}

MapFilterScorer MakeMapFilterScorer(const core::PreprocessorConfig& config,
                                    const EvaluationInput& input,
                                    const ScoreRules& rules,
                                    std::vector<core::StampedPose> poses) {
  return {{.tolerance_m = rules.tolerance_m,
           .z_min_m = config.map_filter.z_min_m,
           .z_max_m = config.map_filter.z_max_m,
           .min_points = rules.min_points},
          config.pose,
          std::move(poses),
          input.T_map_reference};
}

io::ReadError NothingScored(const EvaluationInput& input, const LoggedScans& logged) {
  return io::ErrorInFile(
      input.log.string(),
      "no scan can be scored: " + std::to_string(logged.missing_slices) +
          " labelled scans are not whole, " + std::to_string(logged.not_wanted) +
          " scans are not labelled or not of " + input.input.string() +
          "; expected DETECTIONS and OBSTACLE_POINTS of the same --input, --config and --labels");
}

}  // namespace

ScanNames::ScanNames(const std::filesystem::path& input, const io::RecordingConfig& config)
    : source_(input, config), is_cut_(config.points_per_scan > 0) {
  for (std::size_t i = 0; i < source_.size(); ++i) scans_.emplace(source_.utime(i), i);
}

std::string ScanNames::KeyOf(std::int64_t scan_utime) {
  const auto scan = scans_.find(scan_utime);
  if (scan == scans_.end()) return {};
  std::string name = source_.Read(scan->second).name;
  std::string cut;
  if (is_cut_) {
    cut = name.substr(name.rfind('#'));
    name.resize(name.size() - cut.size());
  }
  return std::filesystem::path(name).stem().string() + cut;
}

Evaluation Evaluate(const EvaluationInput& input,
                    const graph::GraphConfig& config,
                    const ScoreRules& rules) {
  const Labels labels = ReadLabels(input.labels);
  ScanNames names(input.input, config.recording);
  std::map<std::int64_t, Labels::const_iterator> labels_by_utime;
  LoggedScans logged = ReadLog(input.log, input.channel_prefix, [&](std::int64_t scan_utime) {
    const auto found = labels.find(names.KeyOf(scan_utime));
    if (found == labels.end()) return false;
    labels_by_utime.emplace(scan_utime, found);
    return true;
  });
  if (logged.scans.empty()) throw NothingScored(input, logged);

  const Eigen::Isometry3d T_vehicle_sensor = config.vehicle.sensors.front().T_vehicle_sensor();
  std::vector<SceneScore> scores;
  MapFilterScorer map_filter =
      MakeMapFilterScorer(config.preprocessor, input, rules, std::move(logged.poses));
  for (LoggedScan& scan : logged.scans) {
    std::vector<Box> boxes =
        AllMoved(T_vehicle_sensor, labels_by_utime.at(scan.scan_utime)->second);
    map_filter.Add(scan, boxes);
    scores.push_back(ScoreScene({.points = std::move(scan.points),
                                 .detections = std::move(scan.detections),
                                 .boxes = std::move(boxes)},
                                rules));
  }
  return {.rules = rules,
          .summary = Summarise(scores),
          .map_filter =
              logged.has_removed_points ? std::optional(map_filter.Summarise()) : std::nullopt,
          .scans_missing_slices = logged.missing_slices,
          .scans_unlabelled = logged.not_wanted,
          .labels_not_in_log = labels.size() - labels_by_utime.size(),
          .messages_invalid = logged.invalid_messages};
}

}  // namespace clearway::evaluate
