// SPDX-License-Identifier: BSD-3-Clause
#include "tools/plot/label_placer.hpp"

#include <algorithm>

namespace clearway::plot {

bool LabelPlacer::IsFree(const Rect& rect) const {
  return area_.Contains(rect) && std::none_of(taken_.begin(), taken_.end(), [&](const Rect& t) {
           return t.Overlaps(rect);
         });
}

bool LabelPlacer::TryAt(Canvas& canvas,
                        const std::string& text,
                        const Eigen::Vector2d& upper_left,
                        const TextStyle& style) {
  const Rect rect{
      upper_left.x(), upper_left.y(), canvas.TextWidth(text, style) + 4.0, style.size_px + 4.0};
  if (!IsFree(rect)) return false;
  Reserve(rect);
  canvas.Text(text, {rect.x + 2.0, rect.y + style.size_px}, style);
  return true;
}

bool LabelPlacer::Place(Canvas& canvas,
                        const std::string& text,
                        const Eigen::Vector2d& anchor,
                        const TextStyle& style) {
  if (text.empty()) return true;
  constexpr double kNear_px = 7.0;
  constexpr double kFar_px = 22.0;
  const Eigen::Vector2d half(0.5 * canvas.TextWidth(text, style) + 2.0, 0.5 * style.size_px + 2.0);
  // Directions of the label's centre from the anchor, the best ones first.
  constexpr double kDirections[][2] = {
      {1, 0}, {-1, 0}, {0, -1}, {0, 1}, {1, -1}, {1, 1}, {-1, -1}, {-1, 1}};
  for (const double gap_px : {kNear_px, kFar_px}) {
    for (const auto& direction : kDirections) {
      const Eigen::Vector2d toward(direction[0], direction[1]);
      const Eigen::Vector2d offset = toward.cwiseProduct(half + Eigen::Vector2d::Constant(gap_px));
      if (!TryAt(canvas, text, anchor + offset - half, style)) continue;
      if (gap_px == kFar_px) {
        const Eigen::Vector2d edge = offset - toward.cwiseProduct(half);
        canvas.StrokeLine(anchor, anchor + edge, {style.colour, 0.8});
      }
      return true;
    }
  }
  return false;
}

}  // namespace clearway::plot
