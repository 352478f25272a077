// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <array>
#include <cstdio>
#include <map>
#include <set>
#include <stdexcept>

#include <CLI/CLI.hpp>

#include "common/graph/finite_check.hpp"
#include "common/graph/options.hpp"
#include "common/graph/output_files.hpp"
#include "tools/evaluate/evaluation.hpp"
#include "tools/plot/scan_from_messages.hpp"
#include "tools/plot/scan_log.hpp"

namespace clearway::plot {
namespace {

namespace fs = std::filesystem;

struct Arguments {
  graph::Options common;
  fs::path log;
  fs::path output;
  fs::path output_folder;
  std::optional<std::int64_t> scan_id;
  std::optional<double> time_s;
  bool last = false;  ///< The default; takes no part in the choice.
  int every = 1;
  std::vector<std::string> layers;
  fs::path labels;
  fs::path input;
};

void AddSelection(CLI::App& app, Arguments& arguments) {
  auto* const scan =
      app.add_option("--scan", arguments.scan_id, "The scan with this id")->type_name("ID");
  auto* const time =
      app.add_option("--time", arguments.time_s, "The scan at this time into the log [s]")
          ->check(graph::Finite())
          ->check(CLI::Range(0.0, 1e9))
          ->type_name("SECONDS")
          ->excludes(scan);
  app.add_flag("--last", arguments.last, "The last scan with DETECTIONS (the default)")
      ->excludes(scan)
      ->excludes(time);
  auto* const every = app.add_option("--every", arguments.every, "One picture for N scans")
                          ->check(CLI::Range(1, 1'000'000'000))
                          ->type_name("N")
                          ->excludes(scan)
                          ->excludes(time)
                          ->excludes("--last");
  auto* const to = app.add_option_group("where to");
  to->add_option("--output", arguments.output, "The picture")->type_name("PNG")->excludes(every);
  auto* const folder = to->add_option("--output-folder",
                                      arguments.output_folder,
                                      "For the pictures of --every: scan_<id>.png")
                           ->type_name("FOLDER")
                           ->needs(every);
  every->needs(folder);
  to->require_option(1);
}

void AddArguments(CLI::App& app, Arguments& arguments) {
  graph::AddOptions(app, arguments.common);
  app.add_option("LOG", arguments.log, "LCM log of a run, with LIDAR_POINTS")
      ->required()
      ->type_name("");
  AddSelection(app, arguments);
  std::set<std::string> names;
  for (const auto& [name, layer] : kLayerNames) names.insert(name);
  app.add_option("--layers", arguments.layers, "What is drawn, separated by commas; without: all")
      ->delimiter(',')
      ->allow_extra_args(false)
      ->check(CLI::IsMember(names))
      ->type_name("NAMES");
  auto* const labels =
      app.add_option("--labels", arguments.labels, "Labelled boxes, as for clearway-evaluate")
          ->type_name("PATH");
  auto* const input =
      app.add_option("--input", arguments.input, "The recording that was played, for the labels")
          ->type_name("PATH")
          ->needs(labels);
  labels->needs(input);
}

LayerSet HiddenLayers(const std::vector<std::string>& shown) {
  LayerSet hidden;
  if (shown.empty()) return hidden;
  for (const auto& [name, layer] : kLayerNames) {
    if (std::find(shown.begin(), shown.end(), name) == shown.end()) hidden.Add(layer);
  }
  return hidden;
}

// Finds the labelled boxes of a scan.
class LabelledScans {
 public:
  LabelledScans(const Arguments& arguments, const graph::GraphConfig& config)
      : labels_(evaluate::ReadLabels(arguments.labels)),
        names_(arguments.input, config.recording),
        T_vehicle_sensor_(config.vehicle.sensors.front().T_vehicle_sensor()) {}

  void AddTo(const ScanMessages& scan, ScanPicture& picture) {
    const std::optional<std::int64_t> start_utime = StampsOf(scan).start_utime;
    const std::string key = start_utime ? names_.KeyOf(*start_utime) : "";
    const auto boxes = labels_.find(key);
    if (key.empty() || boxes == labels_.end()) {
      picture.missing.Add(Layer::kLabels);
      picture.text_lines.push_back(key.empty() ? "labels: this scan is not one of --input"
                                               : "labels: none for " + key);
      return;
    }
    for (const evaluate::Box& box_sensor : boxes->second) {
      const evaluate::Box box = evaluate::Moved(T_vehicle_sensor_, box_sensor);
      picture.truth_boxes.push_back({.center = box.T_F_box.translation().cast<float>(),
                                     .length_m = static_cast<float>(box.size_m.x()),
                                     .width_m = static_cast<float>(box.size_m.y()),
                                     .height_m = static_cast<float>(box.size_m.z()),
                                     .yaw_rad = static_cast<float>(evaluate::Yaw(box)),
                                     .label = box.kind});
    }
  }

 private:
  evaluate::Labels labels_;
  evaluate::ScanNames names_;
  Eigen::Isometry3d T_vehicle_sensor_;
};

std::vector<ScanEntry> Wanted(const Arguments& arguments, const ScanIndex& index) {
  if (arguments.scan_id) return {ScanWithId(index, *arguments.scan_id)};
  if (arguments.time_s) return {ScanAtTime(index, *arguments.time_s)};
  if (!arguments.output_folder.empty()) return EveryNthScan(index, arguments.every);
  return {LastScan(index)};
}

// A file of its own for each scan, also where an id comes again.
class OutputFiles {
 public:
  explicit OutputFiles(const Arguments& arguments)
      : file_(arguments.output), folder_(arguments.output_folder) {
    if (!folder_.empty()) fs::create_directories(folder_);
    graph::RefuseToOverwrite({file_}, {arguments.log, arguments.common.config_path});
  }

  [[nodiscard]] fs::path Next(std::int64_t scan_id) {
    if (folder_.empty()) return file_;
    std::array<char, 40> stem{};  // Names that sort as the scans do.
    std::snprintf(stem.data(), stem.size(), "scan_%06lld", static_cast<long long>(scan_id));
    const int count = ++uses_[scan_id];
    return folder_ /
           (stem.data() + std::string(count > 1 ? "_" + std::to_string(count) : "") + ".png");
  }

 private:
  fs::path file_;
  fs::path folder_;
  std::map<std::int64_t, int> uses_;
};

int Plot(const Arguments& arguments, const graph::GraphConfig& config) {
  std::optional<LabelledScans> labels;
  if (!arguments.labels.empty()) labels.emplace(arguments, config);
  OutputFiles files(arguments);
  const ScanLog log{arguments.log, arguments.common.channel_prefix};
  const ScanIndex index = IndexScans(log);
  ReadScans(log, Wanted(arguments, index), config.preprocessor.pose, [&](const LoggedScan& scan) {
    const std::string id = std::to_string(scan.entry.scan_id);
    const ScanContext context{
        .title = "clearway: scan " + id + " of " + arguments.log.filename().string(),
        .vehicle = config.vehicle,
        .floor_threshold_m = config.preprocessor.floor.distance_threshold_m,
        .map = scan.map,
        .seconds_into_log = SecondsInto(index, scan.entry.first_log_utime)};
    ScanPicture picture = MakePicture(scan.messages, context);
    picture.hidden = HiddenLayers(arguments.layers);
    if (labels) labels->AddTo(scan.messages, picture);
    const fs::path file = files.Next(scan.entry.scan_id);
    WritePng(picture, file);
    std::printf("scan %s: %s\n", id.c_str(), file.c_str());
  });
  return graph::kExitOk;
}

int Main(int argc, char** argv) {
  CLI::App app("Draws a scan of an LCM log and what the graph made of it", "clearway-plot");
  Arguments arguments;
  AddArguments(app, arguments);
  return graph::GuardedMain(app, arguments.common, argc, argv, [&] {
    const auto config = graph::LoadConfig(arguments.common);
    if (graph::AnsweredByConfig(arguments.common, config)) return graph::kExitOk;
    return Plot(arguments, config.root);
  });
}

}  // namespace
}  // namespace clearway::plot

int main(int argc, char** argv) {
  return clearway::plot::Main(argc, argv);
}
