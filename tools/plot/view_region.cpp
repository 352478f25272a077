// SPDX-License-Identifier: BSD-3-Clause
#include "tools/plot/view_region.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdio>
#include <iterator>
#include <string>

namespace clearway::plot {

namespace {

constexpr double kShare = 0.98;
constexpr double kLeastSide_m = 3.0;
constexpr std::size_t kSampleSize = 4000;
constexpr double kHorizon_m = 10'000.0;  // Beyond this a coordinate is an error.

struct LevelPoint {
  float range_m;
  Eigen::Vector3f point;
};

// What the scale follows: the raw points, or all others where there are none.
std::vector<LevelPoint> PointsOf(const ScanPicture& picture) {
  std::vector<LevelPoint> points;
  const auto add = [&](const std::vector<Eigen::Vector3f>& list) {
    for (const Eigen::Vector3f& p : list) {
      if (p.cwiseAbs().maxCoeff() < static_cast<float>(kHorizon_m) && p.allFinite()) {
        points.push_back({std::hypot(p.x(), p.y()), p});
      }
    }
  };
  add(picture.raw_points);
  if (!points.empty()) return points;
  add(picture.floor_points);
  add(picture.map_points);
  add(picture.outlier_points);
  add(picture.obstacle_points);
  add(picture.below_floor_points);
  for (const PictureDetection& detection : picture.detections) add({detection.centroid});
  return points;
}

template <typename List, typename Less>
auto Percentile(List& list, Less less) {
  const auto at = static_cast<std::ptrdiff_t>(kShare * static_cast<double>(list.size() - 1));
  std::nth_element(list.begin(), list.begin() + at, list.end(), less);
  return list[static_cast<std::size_t>(at)];
}

// Grows to hold a point.
void Include(ViewRegion& region, double x_m, double y_m) {
  if (!(std::abs(x_m) < kHorizon_m && std::abs(y_m) < kHorizon_m)) return;
  region.x_min_m = std::min(region.x_min_m, x_m);
  region.x_max_m = std::max(region.x_max_m, x_m);
  region.y_min_m = std::min(region.y_min_m, y_m);
  region.y_max_m = std::max(region.y_max_m, y_m);
}

void AddAnchor(ViewRegion& region, const Eigen::Vector3f& point) {
  if (point.cwiseAbs().maxCoeff() < 0.5F * static_cast<float>(region.range_m) &&
      point.allFinite()) {
    region.anchors.push_back(point);
  }
}

void Widen(double& lo, double& hi) {
  const double middle = 0.5 * (lo + hi);
  const double half = 0.5 * std::max(1.06 * (hi - lo), kLeastSide_m);
  lo = middle - half;
  hi = middle + half;
}

}  // namespace

ViewRegion ChooseRegion(const ScanPicture& picture) {
  ViewRegion region{.x_min_m = 0.0, .x_max_m = 0.0, .y_min_m = 0.0, .y_max_m = 0.0};
  std::vector<LevelPoint> points = PointsOf(picture);
  if (!points.empty()) {
    region.range_m = Percentile(points, [](const LevelPoint& a, const LevelPoint& b) {
                       return a.range_m < b.range_m;
                     }).range_m;
    std::vector<float> heights;
    for (const LevelPoint& p : points) {
      if (p.range_m > static_cast<float>(region.range_m)) continue;
      Include(region, p.point.x(), p.point.y());
      heights.push_back(p.point.z());
    }
    region.z_max_m = std::clamp(static_cast<double>(Percentile(heights, std::less<float>())),
                                0.5,
                                0.5 * region.range_m + 0.5);
  }
  // Every n-th point: nth_element has left them in no order that matters, and always the same.
  const std::size_t stride = points.size() / kSampleSize + 1;
  for (std::size_t i = 0; i < points.size(); i += stride) {
    const LevelPoint& p = points[i];
    if (p.range_m <= static_cast<float>(region.range_m) &&
        p.point.z() <= static_cast<float>(region.z_max_m)) {
      region.sample.push_back(p.point);
    }
  }
  AddAnchor(region, Eigen::Vector3f::Zero());
  AddAnchor(region, picture.sensor_origin);
  for (const Eigen::Vector2f& vertex : picture.footprint) {
    Include(region, vertex.x(), vertex.y());
    AddAnchor(region, {vertex.x(), vertex.y(), 0.0F});
  }
  Widen(region.x_min_m, region.x_max_m);
  Widen(region.y_min_m, region.y_max_m);
  return region;
}

double RoundStep(double about_m) {
  const double power = std::pow(10.0, std::floor(std::log10(about_m)));
  for (const double digit : {5.0, 2.0}) {
    if (digit * power <= about_m) return digit * power;
  }
  return power;
}

std::string StepLabel(double value_m, double step_m) {
  const int decimals = std::max(0, static_cast<int>(std::ceil(-std::log10(step_m) - 1e-9)));
  const double rounded = std::round(value_m / step_m) * step_m;
  char text[64];
  std::snprintf(text, sizeof(text), "%.*f", decimals, rounded == 0.0 ? 0.0 : rounded);
  return text;
}

}  // namespace clearway::plot
