// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "tools/plot/canvas.hpp"
#include "tools/plot/palette.hpp"
#include "tools/plot/scan_picture.hpp"
#include "tools/plot/view_region.hpp"

namespace clearway::plot {

/// What a panel could not show.
struct PanelReport {
  std::size_t num_points_outside = 0;  ///< Raw points outside of the panel.
  std::size_t num_labels_left_out = 0;
  double grid_step_m = 0.0;
};

/// Seen from above, x up, y to the left.
PanelReport DrawBirdsEye(Canvas& canvas,
                         const Rect& panel,
                         const ScanPicture& picture,
                         const ViewRegion& region);

/// Seen by a pinhole camera behind and above the vehicle that looks along x and down.
PanelReport DrawPerspective(Canvas& canvas,
                            const Rect& panel,
                            const ScanPicture& picture,
                            const ViewRegion& region);

/// Key of colours with counts, remarks about what is not shown, and the picture's own text.
void DrawLegend(Canvas& canvas,
                const Rect& strip,
                const ScanPicture& picture,
                const std::vector<std::string>& remarks);

/// One kind of points: what both panels draw, in this order.
struct PointLayer {
  Layer layer;
  const char* name;
  const std::vector<Eigen::Vector3f>* points;
  Colour colour;
  int size_px;
};

/// Layers from the lowest to the uppermost, without those that are hidden, and without
/// outliers when there are none. Raw points are pale
/// where the points that were taken out can be told from those that are left.
[[nodiscard]] inline std::vector<PointLayer> LayersOf(const ScanPicture& picture) {
  constexpr std::size_t kManyPoints = 3000;
  const bool is_dense = picture.raw_points.size() > 40'000;
  std::vector<PointLayer> layers = {
      {Layer::kRaw,
       "raw points",
       &picture.raw_points,
       kPointGrey.WithOpacity(picture.map_points.empty() ? 0.55 : 0.35),
       is_dense ? 1 : 2},
      {Layer::kFloor, "floor", &picture.floor_points, kSkyBlue.WithOpacity(0.6), 2},
      {Layer::kRemovedByMap,
       "removed by map",
       &picture.map_points,
       kGreen.WithOpacity(0.8),
       picture.map_points.size() > kManyPoints ? 1 : 2},
      {Layer::kOutliers, "outliers", &picture.outlier_points, kBrown, 3},
      {Layer::kObstacles,
       "obstacle points",
       &picture.obstacle_points,
       kBlue.WithOpacity(0.9),
       picture.obstacle_points.size() > kManyPoints ? 2 : 3},
      {Layer::kObstacles,
       "below the floor",
       &picture.below_floor_points,
       kOrange,
       picture.below_floor_points.size() > 1000 ? 2 : 4}};
  std::erase_if(layers, [&](const PointLayer& layer) {
    const bool is_rare = layer.layer == Layer::kOutliers && layer.points->empty();
    return is_rare || picture.hidden.Contains(layer.layer);
  });
  return layers;
}

/// The map, when there is one and it is to be shown; else null.
[[nodiscard]] inline const PictureMap* MapOf(const ScanPicture& picture) {
  const bool is_shown = picture.map && !picture.hidden.Contains(Layer::kMap);
  return is_shown ? &*picture.map : nullptr;
}

/// What is to be shown of each kind.
[[nodiscard]] inline std::span<const PictureDetection> DetectionsOf(const ScanPicture& picture) {
  if (picture.hidden.Contains(Layer::kDetections)) return {};
  return picture.detections;
}
[[nodiscard]] inline std::span<const PictureCorridor> CorridorsOf(const ScanPicture& picture) {
  if (picture.hidden.Contains(Layer::kCorridor)) return {};
  return picture.corridors;
}
[[nodiscard]] inline std::span<const PictureTruthBox> TruthBoxesOf(const ScanPicture& picture) {
  if (picture.hidden.Contains(Layer::kLabels)) return {};
  return picture.truth_boxes;
}

/// How a corridor's state looks.
struct CorridorLook {
  const char* name;
  Colour fill;
  Pen outline;
};

[[nodiscard]] inline CorridorLook LookOf(CorridorState state) {
  switch (state) {
    case CorridorState::kStop:
      return {"stop", kVermillion.WithOpacity(0.30), {kVermillion, 3.0, false}};
    case CorridorState::kLimited:
      return {"limited", kYellow.WithOpacity(0.35), {{0.62, 0.55, 0.0}, 2.0, true}};
    case CorridorState::kFree:
      break;
  }
  return {"free", kGreen.WithOpacity(0.16), {kGreen, 1.6, false}};
}

/// Corners of a rectangle in the xy plane, in order.
[[nodiscard]] inline std::vector<Eigen::Vector2f> Corners(const Eigen::Vector2f& center,
                                                          float length_m,
                                                          float width_m,
                                                          float yaw_rad) {
  const Eigen::Vector2f along(std::cos(yaw_rad), std::sin(yaw_rad));
  const Eigen::Vector2f half_length = 0.5F * length_m * along;
  const Eigen::Vector2f half_width = 0.5F * width_m * Eigen::Vector2f(-along.y(), along.x());
  return {center - half_length - half_width,
          center + half_length - half_width,
          center + half_length + half_width,
          center - half_length + half_width};
}

}  // namespace clearway::plot
