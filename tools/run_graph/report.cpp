// SPDX-License-Identifier: BSD-3-Clause
#include "tools/run_graph/report.hpp"

#include <array>
#include <cstdio>

#include <nlohmann/json.hpp>

namespace clearway::run_graph {
namespace {

template <typename... Values>
std::string Line(const char* format, Values... values) {
  std::array<char, 200> text{};
  std::snprintf(text.data(), text.size(), format, values...);
  return text.data();
}

void AddQuantiles(std::string& text, const char* name, const std::optional<Quantiles>& q) {
  if (q) text += Line("%-24s %8.2f %8.2f\n", name, q->median, q->p99);
}

void AddFigure(std::string& text, const char* name, const std::optional<double>& value) {
  if (value) text += Line("%-24s %8.1f\n", name, *value);
}

nlohmann::ordered_json ToJson(const Quantiles& quantiles) {
  return {{"median", quantiles.median}, {"p99", quantiles.p99}};
}

}  // namespace

std::string FormatTable(const RunSummary& summary, const std::optional<MachineUse>& use) {
  std::string text;
  text += Line("%-24s %8zu\n", "scans played", summary.scans_played);
  text += Line("%-24s %8zu\n", "scans with detections", summary.scans_detected);
  text += Line("%-24s %8zu\n", "scans incomplete", summary.scans_incomplete);
  text += Line("%-24s %8lld\n\n", "messages lost", static_cast<long long>(summary.messages_lost));

  text += Line("%-24s %8s %8s %8s\n", "stage", "median", "p99 ms", "scans");
  for (const auto& [name, stage] : summary.stages) {
    if (!stage.processing_ms) continue;
    const Quantiles& ms = *stage.processing_ms;
    text += Line("%-24s %8.2f %8.2f %8zu\n", name.c_str(), ms.median, ms.p99, stage.scans);
  }
  AddQuantiles(text, "last slice to detections", summary.scan_to_detections_ms);
  AddQuantiles(text, "slice to permit", summary.slice_to_permit_ms);

  text += Line("\n%-24s %8s\n", "mean per scan", "");
  AddFigure(text, "points in", summary.points_in);
  AddFigure(text, "after the voxel grid", summary.points_voxel);
  AddFigure(text, "after the floor", summary.points_floor);
  AddFigure(text, "after the map", summary.points_map);
  AddFigure(text, "detections", summary.detections);
  if (summary.map_scans > 0) {
    text += Line("\n%-24s %8zu of %zu scans\n",
                 "filtered with the map",
                 summary.map_filtered,
                 summary.map_scans);
    if (!summary.map_trouble.empty()) text += "  (" + summary.map_trouble + ")\n";
  }
  if (summary.drive) {
    const DriveSummary& drive = *summary.drive;
    text += Line("\n%-24s %8.2f\n", "driven m", drive.driven_m);
    text += Line("%-24s %8zu\n", "stops for an obstacle", drive.obstacle_stops);
    if (drive.nearest_m) text += Line("%-24s %8.2f\n", "nearest to anything m", *drive.nearest_m);
    text += Line("%-24s %8lld\n", "contacts", static_cast<long long>(drive.contacts));
  }
  if (use) {
    text += Line("\n%-24s %8.2f\n", "CPU cores", use->cpu_cores);
    text += Line("%-24s %8.1f\n", "memory (PSS) MB", use->pss_mb);
    for (const auto& [name, one] : use->processes) {
      text += Line("  %-22s %8.2f %8.1f MB\n", name.c_str(), one.cpu_cores, one.pss_mb);
    }
  }
  return text;
}

std::string FormatJson(const RunSummary& summary, const std::optional<MachineUse>& use) {
  nlohmann::ordered_json json;
  json["scans_played"] = summary.scans_played;
  json["scans_detected"] = summary.scans_detected;
  json["scans_incomplete"] = summary.scans_incomplete;
  json["messages_lost"] = summary.messages_lost;
  json["stages"] = nlohmann::ordered_json::object();
  for (const auto& [name, stage] : summary.stages) {
    auto& entry = json["stages"][name];
    entry["scans"] = stage.scans;
    if (!stage.processing_ms) continue;
    entry["median_ms"] = stage.processing_ms->median;
    entry["p99_ms"] = stage.processing_ms->p99;
  }
  if (summary.points_in) json["points"]["in"] = *summary.points_in;
  if (summary.points_voxel) json["points"]["voxel"] = *summary.points_voxel;
  if (summary.points_floor) json["points"]["floor"] = *summary.points_floor;
  if (summary.points_map) json["points"]["map"] = *summary.points_map;
  if (summary.detections) json["detections"] = *summary.detections;
  if (summary.map_scans > 0) {
    json["map_filter"]["scans"] = summary.map_scans;
    json["map_filter"]["filtered"] = summary.map_filtered;
  }
  if (summary.scan_to_detections_ms) {
    json["latency_ms"]["scan_to_detections"] = ToJson(*summary.scan_to_detections_ms);
  }
  if (summary.slice_to_permit_ms) {
    json["latency_ms"]["slice_to_permit"] = ToJson(*summary.slice_to_permit_ms);
  }
  if (summary.drive) {
    json["drive"]["driven_m"] = summary.drive->driven_m;
    json["drive"]["obstacle_stops"] = summary.drive->obstacle_stops;
    if (summary.drive->nearest_m) json["drive"]["nearest_m"] = *summary.drive->nearest_m;
    json["drive"]["contacts"] = summary.drive->contacts;
  }
  if (use) {
    json["cpu_cores"] = use->cpu_cores;
    json["pss_mb"] = use->pss_mb;
    for (const auto& [name, one] : use->processes) {
      json["processes"][name] = {{"cpu_cores", one.cpu_cores}, {"pss_mb", one.pss_mb}};
    }
  }
  return json.dump(2) + '\n';
}

}  // namespace clearway::run_graph
