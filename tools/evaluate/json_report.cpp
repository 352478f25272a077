// SPDX-License-Identifier: BSD-3-Clause
#include <numbers>

#include <nlohmann/json.hpp>

#include "tools/evaluate/report.hpp"

namespace clearway::evaluate {
namespace {

using Json = nlohmann::ordered_json;

constexpr double kDegreesPerRadian = 180.0 / std::numbers::pi;

Json ToJson(const RangeBin& bin) {
  return {{"min_m", bin.min_m},
          {"max_m", bin.max_m},
          {"objects", bin.objects},
          {"any_evidence", bin.any_evidence},
          {"separated", bin.separated}};
}

template <typename Value>
void AddIfKnown(Json& json, const char* name, const std::optional<Value>& value) {
  if (value) json[name] = *value;
}

// One entry: the log is of one run, with one map and one pose.
Json MapFilterJson(const MapFilterSummary& map_filter, const Summary& summary) {
  Json json = Json::object();
  if (map_filter.pose_error) {
    json["pose_error_m"] = map_filter.pose_error->distance_m;
    json["pose_error_deg"] = map_filter.pose_error->turn_rad * kDegreesPerRadian;
  }
  const MapFilterCounts& counts = map_filter.counts;
  const std::optional<double> removal = counts.statics.Value();
  AddIfKnown(json, "removal", removal);
  AddIfKnown(json, "removal_in_band", counts.statics_in_band.Value());
  if (removal) json["leak"] = 1.0 - *removal;
  AddIfKnown(json, "leaked_per_scan", map_filter.LeakedPerScan());
  AddIfKnown(json, "swallow", counts.objects.Value());
  json["scans"] = map_filter.scans;
  json["scans_incomplete"] = map_filter.scans_incomplete;
  json["scans_not_filtered"] = map_filter.scans_not_filtered;
  json["scans_missing_removed_points"] = map_filter.scans_missing_removed;
  if (summary.objects > 0) {
    json["objects"] = summary.objects;
    json["found"] = summary.within_radius;
  }
  AddIfKnown(json, "centre_error_m", summary.centre_error_m);
  AddIfKnown(json, "detections_per_scan", summary.detections_per_scan);
  return json;
}

}  // namespace

std::string FormatJson(const Evaluation& evaluation) {
  const Summary& summary = evaluation.summary;
  Json json;
  const auto add = [&json](const char* name, const auto& value) { AddIfKnown(json, name, value); };
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
  if (evaluation.map_filter && evaluation.map_filter->scans > 0) {
    json["map_filter"].push_back(MapFilterJson(*evaluation.map_filter, summary));
  }
  json["scans_missing_slices"] = evaluation.scans_missing_slices;
  json["scans_unlabelled"] = evaluation.scans_unlabelled;
  json["labels_not_in_log"] = evaluation.labels_not_in_log;
  json["messages_invalid"] = evaluation.messages_invalid;
  json["boxes_few_points"] = summary.few_points;
  json["boxes_out_of_range"] = summary.out_of_range;
  return json.dump(2) + '\n';
}

}  // namespace clearway::evaluate
