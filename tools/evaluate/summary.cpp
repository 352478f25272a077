// SPDX-License-Identifier: BSD-3-Clause
#include "tools/evaluate/summary.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <utility>

namespace clearway::evaluate {
namespace {

constexpr std::array kBinEdges_m{0.0, 2.0, 5.0, 10.0, 20.0, kMaxRange_m};

std::vector<RangeBin> EmptyBins() {
  std::vector<RangeBin> bins;
  for (std::size_t i = 0; i + 1 < kBinEdges_m.size(); ++i) {
    bins.push_back({.min_m = kBinEdges_m[i], .max_m = kBinEdges_m[i + 1]});
  }
  return bins;
}

std::vector<RangeBin> BinByRange(std::span<const ObjectScore> objects) {
  std::vector<RangeBin> bins = EmptyBins();
  for (const ObjectScore& object : objects) {
    const auto bin = std::find_if(
        bins.begin(), bins.end(), [&](const RangeBin& b) { return object.range_m < b.max_m; });
    if (bin == bins.end()) continue;
    ++bin->objects;
    if (object.any_evidence) ++bin->any_evidence;
    if (object.separated) ++bin->separated;
  }
  std::erase_if(bins, [](const RangeBin& bin) { return bin.objects == 0; });
  return bins;
}

// The values of those objects that have one.
std::vector<double> Values(std::span<const ObjectScore> objects,
                           std::optional<double> ObjectScore::*field) {
  std::vector<double> values;
  for (const ObjectScore& object : objects) {
    if (object.*field) values.push_back(*(object.*field));
  }
  return values;
}

// A summary with the errors only.
Summary SummariseErrors(std::span<const ObjectScore> objects) {
  constexpr double kDegreesPerRadian = 180.0 / std::numbers::pi;
  Summary summary;
  const std::vector<double> centre_errors_m = Values(objects, &ObjectScore::centre_error_m);
  summary.centre_error_m = Quantile(centre_errors_m, 0.5);
  summary.centre_error_p99_m = Quantile(centre_errors_m, 0.99);
  summary.nearest_error_m = Quantile(Values(objects, &ObjectScore::nearest_error_m), 0.5);
  const auto yaw_error_rad = Quantile(Values(objects, &ObjectScore::yaw_error_rad), 0.5);
  if (yaw_error_rad) summary.yaw_error_deg = *yaw_error_rad * kDegreesPerRadian;
  return summary;
}

}  // namespace

std::optional<double> Quantile(std::vector<double> values, double q) {
  if (values.empty()) return std::nullopt;
  std::sort(values.begin(), values.end());
  const std::size_t n = values.size();
  if (q == 0.5 && n % 2 == 0) return 0.5 * (values[n / 2 - 1] + values[n / 2]);
  const auto rank = static_cast<std::size_t>(std::ceil(q * static_cast<double>(n)));
  return values[std::clamp<std::size_t>(rank, 1, n) - 1];
}

Summary Summarise(std::span<const SceneScore> scenes) {
  std::vector<ObjectScore> objects;
  for (const SceneScore& scene : scenes) {
    objects.insert(objects.end(), scene.objects.begin(), scene.objects.end());
  }
  Summary summary = SummariseErrors(objects);
  summary.recall = BinByRange(objects);
  summary.scans = scenes.size();
  summary.objects = objects.size();
  std::size_t detections = 0;
  std::size_t merges = 0;
  for (const SceneScore& scene : scenes) {
    detections += scene.detections;
    merges += scene.merges;
    summary.few_points += scene.few_points;
    summary.out_of_range += scene.out_of_range;
  }
  std::size_t splits = 0;
  for (const ObjectScore& object : objects) {
    splits += object.splits;
    if (object.within_radius) ++summary.within_radius;
  }
  if (summary.scans > 0) {
    summary.detections_per_scan =
        static_cast<double>(detections) / static_cast<double>(summary.scans);
  }
  if (!objects.empty()) {
    summary.splits = splits;
    summary.merges = merges;
  }
  return summary;
}

}  // namespace clearway::evaluate
