// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>
#include <optional>

#include <Eigen/Core>

#include "tools/plot/canvas.hpp"
#include "tools/plot/scan_picture.hpp"

namespace clearway::plot {

/// What the static map says about a place of the floor.
enum class MapGround : std::int8_t {
  kFree,
  kOccupied,
  kBetween,  ///< Neither free nor occupied, but known.
  kUnknown,  ///< Also everything off the map.
};

/// `point` in the vehicle frame [m], on its floor (z = 0). O(1).
[[nodiscard]] MapGround GroundAt(const PictureMap& map, const Eigen::Vector2d& point);

/// How a panel looks at the floor.
struct FloorView {
  /// The place of the floor that a pixel shows, vehicle frame [m]; nothing where it shows none.
  std::function<std::optional<Eigen::Vector2d>(const Eigen::Vector2d& pixel)> floor_at;

  /// The pixel of a place of the floor; nothing when it is not in view.
  std::function<std::optional<Eigen::Vector2d>(const Eigen::Vector2d& point)> pixel_at;

  /// Opposite corners of the floor that may be in view, vehicle frame [m].
  Eigen::Vector2d low = Eigen::Vector2d::Zero();
  Eigen::Vector2d high = Eigen::Vector2d::Zero();
};

/// Lays the map on a panel's floor: occupied cells dark, unknown ones hatched, free ones as they
/// are. Each occupied cell in view takes a pixel at least. O(pixels + cells in view).
void DrawMap(Canvas& canvas, const Rect& area, const PictureMap& map, const FloorView& view);

}  // namespace clearway::plot
