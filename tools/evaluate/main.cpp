// SPDX-License-Identifier: BSD-3-Clause
#include <cstdio>
#include <numbers>
#include <optional>
#include <vector>

#include <CLI/CLI.hpp>

#include "common/graph/options.hpp"
#include "common/graph/output_files.hpp"
#include "tools/evaluate/evaluation.hpp"
#include "tools/evaluate/report.hpp"

namespace clearway::evaluate {
namespace {

struct Arguments {
  graph::Options common;
  EvaluationInput input;
  ScoreRules rules;
  std::filesystem::path json;
  std::vector<double> reference_pose;
};

void AddArguments(CLI::App& app, Arguments& arguments) {
  graph::AddOptions(app, arguments.common);
  app.add_option("--log",
                 arguments.input.log,
                 "LCM log with DETECTIONS and OBSTACLE_POINTS; with REMOVED_POINTS the map filter "
                 "is scored, "
                 "too")
      ->required()
      ->type_name("FILE");
  app.add_option("--labels",
                 arguments.input.labels,
                 "JSON file {\"stem\": [boxes], ...}, or folder with a list of boxes in "
                 "<stem>.json; frame of the first sensor")
      ->required()
      ->type_name("PATH");
  app.add_option("--input", arguments.input.input, "The recording that was played")
      ->required()
      ->type_name("PATH");
  app.add_option("--reference-pose",
                 arguments.reference_pose,
                 "Where the vehicle really stood in map [m, m, deg]: gives the error of POSE")
      ->delimiter(',')
      ->expected(3)
      ->type_name("X_M,Y_M,YAW_DEG");
  app.add_option("--json", arguments.json, "Write the figures to this file")->type_name("FILE");
  app.add_option("--min-points", arguments.rules.min_points, "Leave out boxes with fewer points")
      ->check(CLI::Range(0, 1'000'000'000))
      ->capture_default_str();
  app.add_option("--radius",
                 arguments.rules.radius_m,
                 "A centroid this near to a box's centre finds it [m]")
      ->check(CLI::Range(0.0, 100.0))
      ->capture_default_str();
  app.add_option("--tolerance", arguments.rules.tolerance_m, "Boxes are grown by this much [m]")
      ->check(CLI::Range(0.0, 10.0))
      ->capture_default_str();
}

std::optional<Eigen::Isometry3d> ReferencePose(const std::vector<double>& x_y_yaw_deg) {
  if (x_y_yaw_deg.empty()) return std::nullopt;
  const double yaw_rad = x_y_yaw_deg[2] * std::numbers::pi / 180.0;
  return core::FromRpy({x_y_yaw_deg[0], x_y_yaw_deg[1], 0.0}, {0.0, 0.0, yaw_rad});
}

int Main(int argc, char** argv) {
  CLI::App app("Scores the detections of an LCM log against labelled boxes", "clearway-evaluate");
  Arguments arguments;
  AddArguments(app, arguments);
  return graph::GuardedMain(app, arguments.common, argc, argv, [&] {
    arguments.input.channel_prefix = arguments.common.channel_prefix;
    arguments.input.T_map_reference = ReferencePose(arguments.reference_pose);
    const auto config = graph::LoadConfig(arguments.common);
    if (graph::AnsweredByConfig(arguments.common, config)) return graph::kExitOk;
    const Evaluation evaluation = Evaluate(arguments.input, config.root, arguments.rules);
    std::fputs(FormatTable(evaluation).c_str(), stdout);
    graph::RefuseToOverwrite(
        {arguments.json},
        {arguments.input.log, arguments.input.labels, arguments.common.config_path});
    if (!arguments.json.empty()) graph::WriteFile(arguments.json, FormatJson(evaluation));
    return graph::kExitOk;
  });
}

}  // namespace
}  // namespace clearway::evaluate

int main(int argc, char** argv) {
  return clearway::evaluate::Main(argc, argv);
}
