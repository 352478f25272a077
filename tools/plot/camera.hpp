// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <vector>

#include <Eigen/Core>

#include "tools/plot/canvas.hpp"
#include "tools/plot/view_region.hpp"

namespace clearway::plot {

/// A pinhole camera behind, above and a little to the right of what it looks at. World points are
/// in the vehicle frame [m], pixels are those of the canvas.
class Camera {
 public:
  /// Stands as near as it can with the region's anchors and its sample, from a little behind the
  /// vehicle forward, in view.
  Camera(const Rect& area, const ViewRegion& region);

  /// Nothing for points that are not in front of the camera.
  [[nodiscard]] std::optional<Eigen::Vector2d> Project(const Eigen::Vector3d& point) const;

  /// The place of the floor (z = 0) that a pixel shows; nothing at and above the horizon.
  [[nodiscard]] std::optional<Eigen::Vector2d> FloorAt(const Eigen::Vector2d& pixel) const;

  /// A polygon, without what is not in front of the camera.
  [[nodiscard]] std::vector<Eigen::Vector2d> ProjectPolygon(
      const std::vector<Eigen::Vector3d>& polygon) const;

 private:
  // Right, down and forward of the camera [m].
  [[nodiscard]] Eigen::Vector3d ToCamera(const Eigen::Vector3d& point) const;

  // For points in front of the camera.
  [[nodiscard]] Eigen::Vector2d ToPixel(const Eigen::Vector3d& camera) const;

  // Moves there and shifts the image so that what should be in view is in its middle, with all
  // anchors and all points but one in a hundred at each side. False when that does not fit.
  bool StandAt(double distance_m,
               const std::vector<Eigen::Vector3d>& points,
               const std::vector<Eigen::Vector3d>& anchors);

  Rect area_;
  double focal_px_;
  Eigen::Vector3d forward_;
  Eigen::Vector3d right_;
  Eigen::Vector3d down_;
  Eigen::Vector3d target_;
  Eigen::Vector3d position_ = Eigen::Vector3d::Zero();
  Eigen::Vector2d center_px_ = Eigen::Vector2d::Zero();  // Of the optical axis.
};

}  // namespace clearway::plot
