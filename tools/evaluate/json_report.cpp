// SPDX-License-Identifier: BSD-3-Clause
#include <nlohmann/json.hpp>

#include "tools/evaluate/report.hpp"

namespace clearway::evaluate {
namespace {

using Json = nlohmann::ordered_json;

Json ToJson(const RangeBin& bin) {
  return {{"min_m", bin.min_m},
          {"max_m", bin.max_m},
          {"objects", bin.objects},
          {"any_evidence", bin.any_evidence},
          {"separated", bin.separated}};
}

}  // namespace

std::string FormatJson(const Evaluation& evaluation) {
  const Summary& summary = evaluation.summary;
  Json json;
  const auto add = [&json](const char* name, const auto& value) {
    if (value) json[name] = *value;
  };
  for (const RangeBin& bin : summary.recall) json["recall"].push_back(ToJson(bin));
  if (summary.objects > 0) {
    json["within_radius"] = {{"radius_m", evaluation.rules.radius_m},
                             {"objects", summary.objects},
                             {"found", summary.within_radius}};
  }
  add("centre_error_m", summary.centre_error_m);
  add("centre_error_p99_m", summary.centre_error_p99_m);
  add("nearest_error_m", summary.nearest_error_m);
  add("yaw_error_deg", summary.yaw_error_deg);
  add("splits", summary.splits);
  add("merges", summary.merges);
  json["scans"] = summary.scans;
  add("detections_per_scan", summary.detections_per_scan);
  json["scans_missing_slices"] = evaluation.scans_missing_slices;
  json["scans_unlabelled"] = evaluation.scans_unlabelled;
  json["labels_not_in_log"] = evaluation.labels_not_in_log;
  json["messages_invalid"] = evaluation.messages_invalid;
  json["boxes_few_points"] = summary.few_points;
  json["boxes_out_of_range"] = summary.out_of_range;
  return json.dump(2) + '\n';
}

}  // namespace clearway::evaluate
