// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <span>
#include <string>
#include <vector>

#include <Eigen/Core>

namespace clearway::plot {

/// Red, green, blue and opacity, 0..1.
struct Colour {
  double red = 0.0;
  double green = 0.0;
  double blue = 0.0;
  double opacity = 1.0;

  [[nodiscard]] Colour WithOpacity(double new_opacity) const {
    return {red, green, blue, new_opacity};
  }
};

/// Pixels, y down.
struct Rect {
  double x = 0.0;
  double y = 0.0;
  double width = 0.0;
  double height = 0.0;

  [[nodiscard]] bool Contains(const Rect& other) const;
  [[nodiscard]] bool Overlaps(const Rect& other) const;
};

struct Pen {
  Colour colour;
  double width_px = 1.0;
  bool is_dashed = false;
};

struct TextStyle {
  double size_px = 13.0;
  Colour colour;
  bool is_bold = false;
  bool has_halo = false;  ///< A white rim, for text on top of points.
};

/// A picture in memory. Coordinates are pixels, y down, origin in the upper left corner. Shapes
/// with a coordinate that is not finite are not drawn.
class Canvas {
 public:
  Canvas(int width_px, int height_px);
  ~Canvas();
  Canvas(const Canvas&) = delete;
  Canvas& operator=(const Canvas&) = delete;

  /// All drawing is confined to a rectangle until EndClip().
  void BeginClip(const Rect& rect);
  void EndClip();

  void FillRect(const Rect& rect, const Colour& colour);
  void StrokeRect(const Rect& rect, const Pen& pen);
  void FillPolygon(std::span<const Eigen::Vector2d> polygon, const Colour& colour);
  void StrokePolygon(std::span<const Eigen::Vector2d> polygon, const Pen& pen);
  void StrokeLine(const Eigen::Vector2d& from, const Eigen::Vector2d& to, const Pen& pen);
  void FillCircle(const Eigen::Vector2d& center, double radius_px, const Colour& colour);

  /// Square dots, blended. `clip` is the rectangle of BeginClip(). O(dots).
  void Dots(std::span<const Eigen::Vector2f> centers,
            const Colour& colour,
            int size_px,
            const Rect& clip);

  /// Width of a line of text [px].
  [[nodiscard]] double TextWidth(const std::string& text, const TextStyle& style);

  /// The text, or as much of its beginning as fits into a width, with an ellipsis.
  [[nodiscard]] std::string Shorten(const std::string& text,
                                    const TextStyle& style,
                                    double max_width_px);

  /// One line of text; (x, y) is the left end of its base line.
  void Text(const std::string& text, const Eigen::Vector2d& left_base, const TextStyle& style);

  /// The picture as a PNG file's content. Throws std::runtime_error when cairo reports an error.
  [[nodiscard]] std::vector<unsigned char> EncodePng();

 private:
  struct Cairo;
  void Trace(std::span<const Eigen::Vector2d> polygon);
  void UsePen(const Pen& pen);
  void UseStyle(const TextStyle& style);

  std::unique_ptr<Cairo> cairo_;
};

}  // namespace clearway::plot
