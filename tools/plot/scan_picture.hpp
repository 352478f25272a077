// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "common/core/mapping/occupancy_grid.hpp"
#include "tools/plot/layers.hpp"

namespace clearway::plot {

/// What the robot may do in a corridor.
enum class CorridorState : std::int8_t { kFree, kLimited, kStop };

/// A stretch of floor that the robot would sweep.
struct PictureCorridor {
  std::vector<Eigen::Vector2f> polygon;  ///< Vehicle frame [m]; simple, in order, not closed.
  CorridorState state = CorridorState::kFree;
  std::string label;  ///< May be empty.
};

/// One obstacle.
struct PictureDetection {
  std::vector<Eigen::Vector2f> hull;                 ///< Vehicle frame [m]; in order, not closed.
  Eigen::Vector2f center = Eigen::Vector2f::Zero();  ///< Of the rectangle [m].
  float length_m = 0.0F;
  float width_m = 0.0F;
  float yaw_rad = 0.0F;  ///< Direction of the length.
  Eigen::Vector3f centroid = Eigen::Vector3f::Zero();
  float z_min_m = 0.0F;
  float z_max_m = 0.0F;
  std::string label;  ///< May be empty.
};

/// Ground truth: an upright box.
struct PictureTruthBox {
  Eigen::Vector3f center = Eigen::Vector3f::Zero();  ///< Vehicle frame [m].
  float length_m = 0.0F;
  float width_m = 0.0F;
  float height_m = 0.0F;
  float yaw_rad = 0.0F;
  std::string label;  ///< May be empty.
};

/// The static map under the vehicle.
struct PictureMap {
  std::shared_ptr<const core::OccupancyGrid> grid;  ///< Not null; valid, with all of its cells.
  Eigen::Isometry3d T_map_vehicle = Eigen::Isometry3d::Identity();
};

/// One scan and what was made of it. Everything is in the vehicle frame (x forward, y left, z up,
/// floor near z = 0), in metres. Every part may be empty. Points and shapes with a coordinate that
/// is not finite are not drawn.
struct ScanPicture {
  std::string title;
  std::vector<Eigen::Vector3f> raw_points;
  std::vector<Eigen::Vector3f> floor_points;
  std::vector<Eigen::Vector3f> map_points;          ///< Taken out: the map explains them.
  std::vector<Eigen::Vector3f> outlier_points;      ///< Taken out: too few neighbours.
  std::vector<Eigen::Vector3f> obstacle_points;     ///< What is left after preprocessing.
  std::vector<Eigen::Vector3f> below_floor_points;  ///< The rest of what is left: holes, steps.
  std::vector<PictureDetection> detections;
  std::vector<PictureCorridor> corridors;
  std::vector<Eigen::Vector2f> footprint;  ///< Of the robot; in order, not closed.
  Eigen::Vector3f sensor_origin = Eigen::Vector3f::Zero();
  std::vector<PictureTruthBox> truth_boxes;
  std::optional<PictureMap> map;

  /// Not drawn and not in the legend. What is in view does not depend on it.
  LayerSet hidden;

  /// Of these nothing is known: the legend says so in place of a count.
  LayerSet missing;

  /// Short lines for the legend: scan id, permit and its reason, times. About 90 characters and 8
  /// lines fit; what does not fit is cut and marked so.
  std::vector<std::string> text_lines;
};

/// Size of a picture.
inline constexpr int kPictureWidth_px = 1600;
inline constexpr int kPictureHeight_px = 900;

/// Writes a PNG with two panels, bird's eye (x up) and perspective from behind and above the
/// vehicle, and a legend with the counts. Both panels show the same part of the floor: what 98 % of
/// the raw points lie in (of all points where there are no raw ones); the legend says how many
/// points lie outside of the panels. Same picture, same bytes. O(points).
/// Throws std::runtime_error when the file cannot be written; what was there may then be gone.
void WritePng(const ScanPicture& picture, const std::filesystem::path& path);

}  // namespace clearway::plot
