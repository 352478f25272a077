// SPDX-License-Identifier: BSD-3-Clause
#include "common/core/perception/floor/textbook_floor_finder.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

#include <pcl/console/print.h>
#include <pcl/point_cloud.h>
#include <pcl/point_types.h>
#include <pcl/segmentation/sac_segmentation.h>

#include "common/core/perception/limits.hpp"

namespace clearway::core {
namespace {

using PclCloud = pcl::PointCloud<pcl::PointXYZ>;

constexpr double kLevelTilt_rad = 0.001;
constexpr int kMaxPlanes = 4;

void SilencePcl() {
  static const bool is_silent = [] {
    pcl::console::setVerbosityLevel(pcl::console::L_ALWAYS);
    return true;
  }();
  static_cast<void>(is_silent);
}

double Tilt(const Plane& plane) {
  const Eigen::Vector3d normal = plane.normal.cast<double>();
  return std::atan2(std::hypot(normal.x(), normal.y()), normal.z());
}

// Unit normal, upwards. Nothing for a plane that stands upright or is none.
std::optional<Plane> Normalized(const std::vector<float>& coefficients) {
  if (coefficients.size() != 4) return std::nullopt;
  const Eigen::Vector3d normal(coefficients[0], coefficients[1], coefficients[2]);
  const double scale = std::copysign(normal.norm(), normal.z());
  if (!std::isfinite(scale) || normal.z() == 0.0) return std::nullopt;
  return Plane{.normal = (normal / scale).cast<float>(),
               .offset_m = static_cast<float>(coefficients[3] / scale)};
}

class TextbookFloorFinder final : public FloorFinder {
 public:
  explicit TextbookFloorFinder(const FloorConfig& config) : config_(config) {
    SilencePcl();
    segmentation_.setModelType(pcl::SACMODEL_PERPENDICULAR_PLANE);
    segmentation_.setMethodType(pcl::SAC_RANSAC);
    segmentation_.setAxis(Eigen::Vector3f::UnitZ());
    segmentation_.setEpsAngle(config.max_tilt_rad);
    segmentation_.setDistanceThreshold(config.distance_threshold_m);
    segmentation_.setMaxIterations(config.max_hypotheses - 1);  // PCL tries one more than this.
    segmentation_.setOptimizeCoefficients(true);
  }

  std::optional<FloorFit> Find(const PointCloud& cloud_vehicle) override;

 private:
  void SelectCandidates(const PointCloud& cloud);
  std::optional<FloorFit> FindTilted();
  std::optional<FloorFit> FindLevel() const;
  FloorFit Describe(const Plane& plane) const;
  bool MeetsPrior(const FloorFit& fit) const;

  FloorConfig config_;
  pcl::SACSegmentation<pcl::PointXYZ> segmentation_;
  PclCloud::Ptr candidates_ = std::make_shared<PclCloud>();
};

std::optional<FloorFit> TextbookFloorFinder::Find(const PointCloud& cloud_vehicle) {
  SelectCandidates(cloud_vehicle);
  if (candidates_->size() < static_cast<std::size_t>(config_.min_inliers)) return std::nullopt;
  return config_.max_tilt_rad <= kLevelTilt_rad ? FindLevel() : FindTilted();
}

void TextbookFloorFinder::SelectCandidates(const PointCloud& cloud) {
  const double at_origin_m =
      config_.max_height_offset_m + config_.distance_threshold_m / std::cos(config_.max_tilt_rad);
  const double slope = std::tan(config_.max_tilt_rad);
  candidates_->clear();
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    if (!IsMeasurement(cloud, i)) continue;
    const double range_m = std::hypot(static_cast<double>(cloud.x[i]), cloud.y[i]);
    if (std::fabs(static_cast<double>(cloud.z[i])) > at_origin_m + slope * range_m) continue;
    candidates_->push_back({cloud.x[i], cloud.y[i], cloud.z[i]});
  }
}

std::optional<FloorFit> TextbookFloorFinder::FindTilted() {
  const auto min_inliers = static_cast<std::size_t>(config_.min_inliers);
  auto remaining = std::make_shared<pcl::Indices>(candidates_->size());
  for (std::size_t i = 0; i < remaining->size(); ++i) (*remaining)[i] = static_cast<int>(i);
  segmentation_.setInputCloud(candidates_);
  for (int plane = 0; plane < kMaxPlanes && remaining->size() >= min_inliers; ++plane) {
    segmentation_.setIndices(remaining);
    pcl::PointIndices inliers;
    pcl::ModelCoefficients coefficients;
    segmentation_.segment(inliers, coefficients);
    const std::optional<Plane> found = Normalized(coefficients.values);
    if (!found || inliers.indices.size() < min_inliers) return std::nullopt;
    const FloorFit fit = Describe(*found);
    if (MeetsPrior(fit)) return fit;

    auto rest = std::make_shared<pcl::Indices>();
    std::set_difference(remaining->begin(),
                        remaining->end(),
                        inliers.indices.begin(),
                        inliers.indices.end(),
                        std::back_inserter(*rest));
    remaining = rest;
  }
  return std::nullopt;
}

std::optional<FloorFit> TextbookFloorFinder::FindLevel() const {
  std::vector<double> heights_m;
  heights_m.reserve(candidates_->size());
  for (const pcl::PointXYZ& point : *candidates_) heights_m.push_back(point.z);
  std::sort(heights_m.begin(), heights_m.end());

  std::size_t first = 0;
  std::size_t best_count = 0;
  double sum_m = 0.0;  // of heights_m[first..last]
  double best_sum_m = 0.0;
  for (std::size_t last = 0; last < heights_m.size(); ++last) {
    sum_m += heights_m[last];
    while (heights_m[last] - heights_m[first] > 2.0 * config_.distance_threshold_m) {
      sum_m -= heights_m[first++];
    }
    if (last + 1 - first > best_count) {
      best_count = last + 1 - first;
      best_sum_m = sum_m;
    }
  }
  const double height_m = best_sum_m / static_cast<double>(best_count);
  const FloorFit fit =
      Describe({.normal = Eigen::Vector3f::UnitZ(), .offset_m = static_cast<float>(-height_m)});
  if (!MeetsPrior(fit)) return std::nullopt;
  return fit;
}

FloorFit TextbookFloorFinder::Describe(const Plane& plane) const {
  const auto threshold_m = static_cast<float>(config_.distance_threshold_m);
  FloorFit fit{
      .plane_vehicle = plane, .num_candidates = candidates_->size(), .tilt_rad = Tilt(plane)};
  double sum2_m2 = 0.0;
  for (const pcl::PointXYZ& point : *candidates_) {
    const float distance_m = plane.SignedDistance(point.getVector3fMap());
    if (std::fabs(distance_m) > threshold_m) continue;
    ++fit.num_inliers;
    sum2_m2 += static_cast<double>(distance_m) * distance_m;
  }
  if (fit.num_inliers > 0) fit.rms_m = std::sqrt(sum2_m2 / static_cast<double>(fit.num_inliers));
  return fit;
}

bool TextbookFloorFinder::MeetsPrior(const FloorFit& fit) const {
  const Plane& plane = fit.plane_vehicle;
  const double height_m = -plane.offset_m / plane.normal.z();
  return fit.tilt_rad <= config_.max_tilt_rad &&
         std::fabs(height_m) <= config_.max_height_offset_m &&
         fit.num_inliers >= static_cast<std::size_t>(config_.min_inliers);
}

}  // namespace

std::unique_ptr<FloorFinder> MakeTextbookFloorFinder(const FloorConfig& config) {
  return std::make_unique<TextbookFloorFinder>(config);
}

}  // namespace clearway::core
