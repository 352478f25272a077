// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include <Eigen/Core>

#include "tools/plot/canvas.hpp"

namespace clearway::plot {

/// Places labels so that none lies on another.
class LabelPlacer {
 public:
  explicit LabelPlacer(const Rect& area) : area_(area) {}

  /// Draws the text beside `anchor` at the first of several places that is free and within the
  /// area, with a thin line to the anchor where it does not stand close by; false when there is no
  /// such place.
  bool Place(Canvas& canvas,
             const std::string& text,
             const Eigen::Vector2d& anchor,
             const TextStyle& style);

  [[nodiscard]] bool IsInArea(const Eigen::Vector2d& pixel) const {
    return area_.Contains({pixel.x(), pixel.y(), 0.0, 0.0});
  }

  /// Keeps a place free of labels.
  void Reserve(const Rect& rect) { taken_.push_back(rect); }

 private:
  [[nodiscard]] bool IsFree(const Rect& rect) const;
  bool TryAt(Canvas& canvas,
             const std::string& text,
             const Eigen::Vector2d& upper_left,
             const TextStyle& style);

  Rect area_;
  std::vector<Rect> taken_;
};

}  // namespace clearway::plot
