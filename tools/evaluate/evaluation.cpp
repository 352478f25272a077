// SPDX-License-Identifier: BSD-3-Clause
#include "tools/evaluate/evaluation.hpp"

#include <utility>

#include "common/io/read_error.hpp"
#include "tools/evaluate/log_scans.hpp"

namespace clearway::evaluate {
namespace {

Scene SceneOf(LoggedScan scan,
              const std::vector<Box>& boxes_sensor,
              const Eigen::Isometry3d& T_vehicle_sensor) {
  Scene scene{
      .points = std::move(scan.points), .detections = std::move(scan.detections), .boxes = {}};
  for (const Box& box : boxes_sensor) scene.boxes.push_back(Moved(T_vehicle_sensor, box));
  return scene;
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
  for (LoggedScan& scan : logged.scans) {
    const std::vector<Box>& boxes = labels_by_utime.at(scan.scan_utime)->second;
    scores.push_back(ScoreScene(SceneOf(std::move(scan), boxes, T_vehicle_sensor), rules));
  }
  return {.rules = rules,
          .summary = Summarise(scores),
          .scans_missing_slices = logged.missing_slices,
          .scans_unlabelled = logged.not_wanted,
          .labels_not_in_log = labels.size() - labels_by_utime.size(),
          .messages_invalid = logged.invalid_messages};
}

}  // namespace clearway::evaluate
