// SPDX-License-Identifier: BSD-3-Clause
#include <array>
#include <cstdio>
#include <numbers>

#include "tools/evaluate/report.hpp"

namespace clearway::evaluate {
namespace {

template <typename... Values>
std::string Line(const char* format, Values... values) {
  std::array<char, 200> text{};
  std::snprintf(text.data(), text.size(), format, values...);
  return text.data();
}

std::string CountLine(const char* name, std::size_t count) {
  return Line("%-32s %8zu\n", name, count);
}

std::string FigureLine(const char* name, const std::optional<double>& value) {
  return value ? Line("%-32s %8.3f\n", name, *value) : "";
}

std::string ShareLine(const std::string& name, std::size_t found, std::size_t objects) {
  const double percent = 100.0 * static_cast<double>(found) / static_cast<double>(objects);
  return Line("%-32s %8zu of %zu (%.1f %%)\n", name.c_str(), found, objects, percent);
}

std::string RecallTable(const Summary& summary) {
  std::string text =
      Line("\n%-12s %8s %13s %10s\n", "range m", "objects", "any evidence", "separated");
  for (const RangeBin& bin : summary.recall) {
    const std::string range = Line("%.0f - %.0f", bin.min_m, bin.max_m);
    text += Line(
        "%-12s %8zu %13zu %10zu\n", range.c_str(), bin.objects, bin.any_evidence, bin.separated);
  }
  return text + '\n';
}

std::string RemovedLine(const char* name, const RemovedShare& share) {
  return share.points == 0 ? "" : ShareLine(name, share.removed, share.points);
}

std::string MapFilterTable(const MapFilterSummary& map_filter) {
  constexpr double kDegreesPerRadian = 180.0 / std::numbers::pi;
  std::string text = "\nmap filter\n" + CountLine("scans it is judged by", map_filter.scans);
  if (map_filter.pose_error) {
    text += FigureLine("pose error, mean m", map_filter.pose_error->distance_m);
    text += FigureLine("pose error, mean deg", map_filter.pose_error->turn_rad * kDegreesPerRadian);
  }
  text += RemovedLine("static points removed", map_filter.counts.statics);
  text += RemovedLine("of those in the height band", map_filter.counts.statics_in_band);
  text += FigureLine("static points leaked per scan", map_filter.LeakedPerScan());
  text += RemovedLine("object points swallowed", map_filter.counts.objects);
  return text + CountLine("scans incomplete", map_filter.scans_incomplete) +
         CountLine("scans without map or pose", map_filter.scans_not_filtered) +
         CountLine("scans missing REMOVED_POINTS", map_filter.scans_missing_removed);
}

std::string LeftOutTable(const Evaluation& evaluation) {
  return CountLine("scans with missing slices", evaluation.scans_missing_slices) +
         CountLine("scans without labels", evaluation.scans_unlabelled) +
         CountLine("labelled scans not in the log", evaluation.labels_not_in_log) +
         CountLine("invalid messages", evaluation.messages_invalid) +
         CountLine("boxes with few points", evaluation.summary.few_points) +
         CountLine("boxes out of range", evaluation.summary.out_of_range);
}

}  // namespace

std::string FormatTable(const Evaluation& evaluation) {
  const Summary& summary = evaluation.summary;
  std::string text = CountLine("scans scored", summary.scans);
  text += FigureLine("detections per scan", summary.detections_per_scan);
  if (summary.objects > 0) {
    text += RecallTable(summary);
    const std::string within = Line("found within %.2f m", evaluation.rules.radius_m);
    text += ShareLine(within, summary.within_radius, summary.objects);
  }
  text += FigureLine("centre error, median m", summary.centre_error_m);
  text += FigureLine("centre error, p99 m", summary.centre_error_p99_m);
  text += FigureLine("nearest point error, median m", summary.nearest_error_m);
  text += FigureLine("yaw error, median deg", summary.yaw_error_deg);
  if (summary.splits) text += CountLine("splits", *summary.splits);
  if (summary.merges) text += CountLine("merges", *summary.merges);
  if (evaluation.map_filter) text += MapFilterTable(*evaluation.map_filter);
  return text + "\nleft out\n" + LeftOutTable(evaluation);
}

}  // namespace clearway::evaluate
