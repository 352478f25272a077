// SPDX-License-Identifier: BSD-3-Clause
#include "tools/plot/camera.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <utility>

#include <Eigen/Geometry>

namespace clearway::plot {

namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr double kDegree = std::numbers::pi / 180.0;
constexpr double kNear_m = 0.05;
constexpr double kPitch_rad = 27.0 * kDegree;      // Down.
constexpr double kTurn_rad = 14.0 * kDegree;       // To the left: it parts the x from the z axis.
constexpr double kHalfField_rad = 30.0 * kDegree;  // Across.

// The part of the image that holds something, along one axis.
struct Span {
  double lo = 1e9;
  double hi = -1e9;

  void Include(double value) {
    lo = std::min(lo, value);
    hi = std::max(hi, value);
  }
};

// The span of the values without one in a hundred at either end.
Span InnerSpan(std::vector<double> values) {
  if (values.empty()) return {};
  std::sort(values.begin(), values.end());
  const std::size_t left_out = values.size() / 100;
  return {values[left_out], values[values.size() - 1 - left_out]};
}

}  // namespace

Camera::Camera(const Rect& area, const ViewRegion& region)
    : area_(area),
      focal_px_(0.5 * area.width / std::tan(kHalfField_rad)),
      forward_(std::cos(kPitch_rad) * std::cos(kTurn_rad),
               std::cos(kPitch_rad) * std::sin(kTurn_rad),
               -std::sin(kPitch_rad)),
      right_(std::sin(kTurn_rad), -std::cos(kTurn_rad), 0.0),
      down_(forward_.cross(right_)) {
  const double x_min_m = std::max(region.x_min_m, -0.15 * region.x_max_m);
  target_ =
      Vector3d(0.5 * (x_min_m + region.x_max_m), 0.5 * (region.y_min_m + region.y_max_m), 0.0);
  std::vector<Vector3d> points;
  for (const Eigen::Vector3f& p : region.sample) {
    if (p.x() >= static_cast<float>(x_min_m)) points.push_back(p.cast<double>());
  }
  std::vector<Vector3d> anchors;
  for (const Eigen::Vector3f& p : region.anchors) anchors.push_back(p.cast<double>());
  double too_near_m = 0.0;
  double far_enough_m = 100.0 * (region.x_max_m - region.x_min_m + region.y_max_m - region.y_min_m);
  for (int i = 0; i < 40; ++i) {
    const double distance_m = 0.5 * (too_near_m + far_enough_m);
    (StandAt(distance_m, points, anchors) ? far_enough_m : too_near_m) = distance_m;
  }
  StandAt(far_enough_m, points, anchors);
}

bool Camera::StandAt(double distance_m,
                     const std::vector<Vector3d>& points,
                     const std::vector<Vector3d>& anchors) {
  constexpr double kShare = 0.92;
  position_ = target_ - distance_m * forward_;
  center_px_ = Vector2d::Zero();
  std::vector<double> across;
  std::vector<double> down;
  for (const Vector3d& point : points) {
    const std::optional<Vector2d> pixel = Project(point);
    if (!pixel) return false;
    across.push_back(pixel->x());
    down.push_back(pixel->y());
  }
  Span u = InnerSpan(std::move(across));
  Span v = InnerSpan(std::move(down));
  for (const Vector3d& anchor : anchors) {
    const std::optional<Vector2d> pixel = Project(anchor);
    if (!pixel) return false;
    u.Include(pixel->x());
    v.Include(pixel->y());
  }
  center_px_ = Vector2d(area_.x + 0.5 * (area_.width - u.lo - u.hi),
                        area_.y + 0.5 * (area_.height - v.lo - v.hi));
  return u.hi - u.lo <= kShare * area_.width && v.hi - v.lo <= kShare * area_.height;
}

Vector3d Camera::ToCamera(const Vector3d& point) const {
  const Vector3d d = point - position_;
  return {right_.dot(d), down_.dot(d), forward_.dot(d)};
}

Vector2d Camera::ToPixel(const Vector3d& camera) const {
  return center_px_ + focal_px_ / camera.z() * camera.head<2>();
}

std::optional<Vector2d> Camera::Project(const Vector3d& point) const {
  const Vector3d camera = ToCamera(point);
  if (!(camera.z() >= kNear_m)) return std::nullopt;
  return ToPixel(camera);
}

std::optional<Vector2d> Camera::FloorAt(const Vector2d& pixel) const {
  const Vector2d offset = (pixel - center_px_) / focal_px_;
  const Vector3d ray = forward_ + offset.x() * right_ + offset.y() * down_;
  const double distance = -position_.z() / ray.z();
  if (!(ray.z() < 0.0 && distance >= kNear_m)) return std::nullopt;
  return (position_ + distance * ray).head<2>();
}

std::vector<Vector2d> Camera::ProjectPolygon(const std::vector<Vector3d>& polygon) const {
  std::vector<Vector2d> pixels;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const Vector3d a = ToCamera(polygon[i]);
    const Vector3d b = ToCamera(polygon[(i + 1) % polygon.size()]);
    if (a.z() >= kNear_m) pixels.push_back(ToPixel(a));
    if ((a.z() >= kNear_m) != (b.z() >= kNear_m)) {
      Vector3d cut = a + (kNear_m - a.z()) / (b.z() - a.z()) * (b - a);
      cut.z() = kNear_m;
      pixels.push_back(ToPixel(cut));
    }
  }
  return pixels;
}

}  // namespace clearway::plot
