// SPDX-License-Identifier: BSD-3-Clause
#include "tools/replay/report.hpp"

#include <array>
#include <cstdio>

#include <nlohmann/json.hpp>

#include "tools/run_graph/report.hpp"

namespace clearway::replay {
namespace {

void AddCount(std::string& text, const char* name, std::int64_t value) {
  std::array<char, 100> line{};
  std::snprintf(line.data(), line.size(), "%-24s %8lld\n", name, static_cast<long long>(value));
  text += line.data();
}

void AddCount(std::string& text, const char* name, std::size_t value) {
  AddCount(text, name, static_cast<std::int64_t>(value));
}

void AddFigure(std::string& text, const char* name, const std::optional<double>& value) {
  if (!value) return;
  std::array<char, 100> line{};
  std::snprintf(line.data(), line.size(), "%-24s %8.1f\n", name, *value);
  text += line.data();
}

void AddInputs(std::string& text, const InputCounts& inputs) {
  text += "\ninputs\n";
  for (const auto& [channel, count] : inputs.fed) AddCount(text, channel.c_str(), count);
  AddCount(text, "of other channels", inputs.not_inputs);
  if (inputs.left_out > 0) {
    AddCount(text, "POSE of the log left out", inputs.left_out);
    text += "  (the configuration runs a pose_source)\n";
  }
  if (inputs.stepped_back > 0) {
    AddCount(text, "stamps that go back", inputs.stepped_back);
    AddFigure(text, "  by at most, ms", static_cast<double>(inputs.largest_step_back_us) / 1000.0);
  }
  if (inputs.refused > 0) AddCount(text, "refused", inputs.refused);
}

void AddComparison(std::string& text, const Comparison& comparison) {
  text += "\ncompared with the reference, scans\n";
  AddCount(text, "equal", comparison.equal);
  AddCount(text, "different", comparison.different);
  AddCount(text, "only here", comparison.only_in_run);
  AddCount(text, "only in the reference", comparison.only_in_reference);
  AddCount(text, "incomplete: not compared", comparison.incomplete);
  AddCount(text, "detections compared", comparison.detections);
  if (comparison.invalid > 0) AddCount(text, "unusable messages", comparison.invalid);
}

nlohmann::ordered_json ToJson(const InputCounts& inputs) {
  nlohmann::ordered_json json;
  json["fed"] = nlohmann::ordered_json::object();
  for (const auto& [channel, count] : inputs.fed) json["fed"][channel] = count;
  json["other"] = inputs.not_inputs;
  json["pose_left_out"] = inputs.left_out;
  json["stepped_back"] = inputs.stepped_back;
  json["largest_step_back_us"] = inputs.largest_step_back_us;
  json["refused"] = inputs.refused;
  return json;
}

nlohmann::ordered_json ToJson(const Comparison& comparison) {
  nlohmann::ordered_json json;
  json["agrees"] = comparison.agrees();
  json["equal"] = comparison.equal;
  json["different"] = comparison.different;
  json["only_here"] = comparison.only_in_run;
  json["only_in_reference"] = comparison.only_in_reference;
  json["incomplete"] = comparison.incomplete;
  json["detections"] = comparison.detections;
  json["invalid"] = comparison.invalid;
  if (!comparison.first_difference.empty()) {
    json["first_difference"] = comparison.first_difference;
  }
  return json;
}

std::string ProblemOf(const Comparison& comparison) {
  if (comparison.agrees()) return {};
  if (!comparison.first_difference.empty()) {
    return "differs from the reference: " + comparison.first_difference + "\n";
  }
  if (comparison.equal == 0) {
    return "nothing could be compared: no scan has whole DETECTIONS here and in the reference\n";
  }
  return "differs from the reference: scans are in one of them only\n";
}

}  // namespace

std::string FormatTable(const Report& report) {
  const run_graph::RunSummary& summary = report.result.summary;
  std::string text;
  AddCount(text, "scans played", summary.scans_played);
  AddCount(text, "scans with detections", summary.scans_detected);
  AddCount(text, "scans incomplete", summary.scans_incomplete);
  AddCount(text, "messages lost", summary.messages_lost);
  if (report.result.dropped > 0) AddCount(text, "messages dropped", report.result.dropped);
  if (report.result.invalid > 0) AddCount(text, "messages not usable", report.result.invalid);
  text += "\nmean per scan\n";
  AddFigure(text, "points in", summary.points_in);
  AddFigure(text, "after the voxel grid", summary.points_voxel);
  AddFigure(text, "after the floor", summary.points_floor);
  AddFigure(text, "after the map", summary.points_map);
  AddFigure(text, "detections", summary.detections);
  AddInputs(text, report.result.inputs);
  if (report.comparison) AddComparison(text, *report.comparison);
  text += '\n';
  AddFigure(text, "recorded s", report.result.recorded_s);
  AddFigure(text, "wall s", report.wall_s);
  AddFigure(text, "times real time", report.speed());
  return text;
}

std::string FormatJson(const Report& report) {
  auto json =
      nlohmann::ordered_json::parse(run_graph::FormatJson(report.result.summary, std::nullopt));
  json["messages_dropped"] = report.result.dropped;
  json["messages_invalid"] = report.result.invalid;
  json["inputs"] = ToJson(report.result.inputs);
  json["recorded_s"] = report.result.recorded_s;
  json["wall_s"] = report.wall_s;
  json["speed"] = report.speed();
  if (report.comparison) json["comparison"] = ToJson(*report.comparison);
  return json.dump(2) + '\n';
}

std::string Problems(const Report& report) {
  const ReplayResult& result = report.result;
  std::string text;
  if (!result.inputs.fed.contains(messages::channels::kLidarPoints.name)) {
    text += "the log has no LIDAR_POINTS that could be fed; its channels: " + result.channels +
            " (see --channel-prefix)\n";
  } else if (result.summary.scans_detected == 0) {
    text +=
        "no scan went through the whole graph; the preprocessor says: " + result.preprocessor_says +
        "\n";
  }
  if (result.inputs.refused > 0) {
    text += "refused " + std::to_string(result.inputs.refused) +
            " inputs whose time stamps cannot be, or are more than an hour from the input before "
            "(damage, or logs joined together: replay them one by one); the first: " +
            result.inputs.first_refused + "\n";
  }
  if (report.comparison) text += ProblemOf(*report.comparison);
  return text;
}

}  // namespace clearway::replay
