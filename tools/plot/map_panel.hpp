// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <string>
#include <vector>

#include "common/core/mapping/occupancy_grid.hpp"
#include "tools/plot/canvas.hpp"
#include "tools/plot/palette.hpp"
#include "tools/plot/view_region.hpp"

namespace clearway::plot {

// How a picture of a map looks.
inline constexpr Colour kOffMap{0.97, 0.94, 0.86};
inline constexpr Colour kUnknownCell{0.72, 0.76, 0.82};
inline constexpr TextStyle kTitle{.size_px = 16.0, .colour = kBlack, .is_bold = true};
inline constexpr TextStyle kText{.size_px = 13.0, .colour = kTextGrey};
inline constexpr TextStyle kTick{.size_px = 12.0, .colour = kTextGrey};
inline constexpr TextStyle kOverMap{.size_px = 13.0,
                                    .colour = kBlack,
                                    .is_bold = true,
                                    .has_halo = true};

inline std::string Format(const char* format, double a, double b = 0.0) {
  std::array<char, 120> text{};
  std::snprintf(text.data(), text.size(), format, a, b);
  return text.data();
}

inline Colour ColourOf(std::uint8_t cell) {
  if (cell == core::OccupancyGrid::kUnknown) return kUnknownCell;
  const double shade = 1.0 - cell / 100.0;
  return {shade, shade, shade};
}

// A pixel that shows no cell.
inline constexpr std::uint8_t kNoCell = 254;

// Corner of the grid `column` and `row` cells from the origin, in map.
inline Eigen::Vector2d CornerOf(const core::GridGeometry& geometry, int column, int row) {
  // CenterOf() takes cells beyond the grid; a corner is half a cell's diagonal from a centre.
  return 0.5 * (geometry.CenterOf({column, row}) + geometry.CenterOf({column - 1, row - 1}));
}

inline std::vector<double> TicksBetween(double low_m, double high_m, double step_m) {
  std::vector<double> ticks;
  const double first = std::ceil(low_m / step_m);
  const auto count = static_cast<int>(std::floor(high_m / step_m) - first) + 1;
  for (int i = 0; i < count; ++i) ticks.push_back((first + i) * step_m);
  return ticks;
}

/// A map in the frame `map`, x to the right, with grid lines, ticks and axes.
class MapPanel {
 public:
  MapPanel(Canvas& canvas, const Rect& area, const Eigen::Vector2d& min_map, double px_per_m)
      : canvas_(canvas), area_(area), min_map_(min_map), px_per_m_(px_per_m) {}

  void Draw(const core::OccupancyGrid& grid) {
    canvas_.FillRect(area_, kOffMap);
    DrawCells(grid);
    canvas_.BeginClip(area_);
    const core::GridGeometry& geometry = grid.geometry;
    const std::array<Eigen::Vector2d, 4> corners = {
        ToPixel(CornerOf(geometry, 0, 0)),
        ToPixel(CornerOf(geometry, geometry.width, 0)),
        ToPixel(CornerOf(geometry, geometry.width, geometry.height)),
        ToPixel(CornerOf(geometry, 0, geometry.height))};
    canvas_.StrokePolygon(corners, {kPointGrey, 1.0});
    DrawAxes({0.0, 0.0}, 0.0, {"map", kVermillion});
    DrawAxes({geometry.origin_x_m, geometry.origin_y_m}, geometry.origin_yaw_rad, {"grid", kBlue});
    canvas_.EndClip();
    canvas_.StrokeRect(area_, {kPointGrey, 1.0});
    DrawTicks();
  }

  [[nodiscard]] bool Shows(const Eigen::Vector2d& point_map) const {
    const Eigen::Vector2d pixel = ToPixel(point_map);
    return area_.Contains({pixel.x(), pixel.y(), 0.0, 0.0});
  }

 private:
  struct AxesLook {
    const char* name;
    Colour colour;
  };

  [[nodiscard]] Eigen::Vector2d ToPixel(const Eigen::Vector2d& point_map) const {
    const Eigen::Vector2d offset_px = px_per_m_ * (point_map - min_map_);
    return {area_.x + offset_px.x(), area_.y + area_.height - offset_px.y()};
  }
  [[nodiscard]] Eigen::Vector2d ToMap(const Eigen::Vector2d& pixel) const {
    return min_map_ +
           Eigen::Vector2d(pixel.x() - area_.x, area_.y + area_.height - pixel.y()) / px_per_m_;
  }

  void DrawCells(const core::OccupancyGrid& grid) {
    const auto columns = static_cast<std::size_t>(area_.width);
    const std::vector<std::uint8_t> pixels = CellPixels(grid);
    std::array<std::vector<Eigen::Vector2f>, 256> centers;
    for (std::size_t i = 0; i < pixels.size(); ++i) {
      if (pixels[i] == kNoCell) continue;
      centers[pixels[i]].emplace_back(
          static_cast<float>(area_.x) + static_cast<float>(i % columns) + 0.5F,
          static_cast<float>(area_.y) + static_cast<float>(i / columns) + 0.5F);
    }
    for (std::size_t cell = 0; cell < centers.size(); ++cell) {
      const auto value = static_cast<std::uint8_t>(cell);
      if (!centers[cell].empty()) canvas_.Dots(centers[cell], ColourOf(value), 1, area_);
    }
  }

  // First each pixel takes the cell that its middle lies in. Then each cell that is more occupied
  // than the pixel in which its own middle lies takes that one: none is lost between the pixels.
  [[nodiscard]] std::vector<std::uint8_t> CellPixels(const core::OccupancyGrid& grid) const {
    const auto columns = static_cast<std::size_t>(area_.width);
    const auto rows = static_cast<std::size_t>(area_.height);
    std::vector<std::uint8_t> pixels(columns * rows, kNoCell);
    for (std::size_t i = 0; i < pixels.size(); ++i) {
      const Eigen::Vector2d pixel(area_.x + static_cast<double>(i % columns) + 0.5,
                                  area_.y + static_cast<double>(i / columns) + 0.5);
      if (const auto cell = grid.geometry.CellAt(ToMap(pixel))) pixels[i] = grid.At(*cell);
    }
    for (int row = 0; row < grid.geometry.height; ++row) {
      for (int column = 0; column < grid.geometry.width; ++column) {
        const std::uint8_t cell = grid.At({column, row});
        if (cell == core::OccupancyGrid::kFree || cell > core::OccupancyGrid::kOccupied) continue;
        const Eigen::Vector2d pixel = ToPixel(grid.geometry.CenterOf({column, row}));
        const double u = std::floor(pixel.x() - area_.x);
        const double v = std::floor(pixel.y() - area_.y);
        if (!(u >= 0.0 && u < area_.width && v >= 0.0 && v < area_.height)) continue;
        std::uint8_t& shown =
            pixels[static_cast<std::size_t>(v) * columns + static_cast<std::size_t>(u)];
        if (shown > core::OccupancyGrid::kOccupied || cell > shown) shown = cell;
      }
    }
    return pixels;
  }

  void DrawAxes(const Eigen::Vector2d& origin_map, double yaw_rad, const AxesLook& look) {
    constexpr double kLength_px = 48.0;
    if (!Shows(origin_map)) return;
    const Eigen::Vector2d origin = ToPixel(origin_map);
    const Eigen::Vector2d x_axis =
        kLength_px * Eigen::Vector2d(std::cos(yaw_rad), -std::sin(yaw_rad));
    const Eigen::Vector2d y_axis(x_axis.y(), -x_axis.x());
    DrawArrow(origin, x_axis, look.colour);
    DrawArrow(origin, y_axis, look.colour);
    canvas_.FillCircle(origin, 4.5, {1.0, 1.0, 1.0});
    canvas_.FillCircle(origin, 3.4, look.colour);
    TextStyle style = kOverMap;
    style.colour = look.colour;
    const auto label = [&](const std::string& text, const Eigen::Vector2d& middle) {
      const double half_px = 0.5 * canvas_.TextWidth(text, style);
      const double left = std::clamp(
          middle.x() - half_px, area_.x + 3.0, area_.x + area_.width - 2.0 * half_px - 3.0);
      const double base =
          std::clamp(middle.y() + 4.0, area_.y + 14.0, area_.y + area_.height - 4.0);
      canvas_.Text(text, {left, base}, style);
    };
    label("x", origin + 1.22 * x_axis);
    label("y", origin + 1.22 * y_axis);
    label(look.name, origin - 0.35 * (x_axis + y_axis));
  }

  void DrawArrow(const Eigen::Vector2d& from, const Eigen::Vector2d& vector, const Colour& colour) {
    const Eigen::Vector2d side(0.09 * vector.y(), -0.09 * vector.x());
    const Eigen::Vector2d tip = from + vector;
    const std::array<Eigen::Vector2d, 3> head = {
        tip, from + 0.78 * vector + side, from + 0.78 * vector - side};
    canvas_.StrokeLine(from, tip, {{1.0, 1.0, 1.0, 0.85}, 4.5});
    canvas_.StrokeLine(from, from + 0.85 * vector, {colour, 2.2});
    canvas_.FillPolygon(head, colour);
  }

  void DrawTicks() {
    constexpr double kLeastStep_px = 70.0;
    double step_m = RoundStep(kLeastStep_px / px_per_m_);
    while (step_m * px_per_m_ < kLeastStep_px) step_m = RoundStep(2.5 * step_m);
    const Eigen::Vector2d max_map =
        min_map_ + Eigen::Vector2d(area_.width, area_.height) / px_per_m_;
    const double bottom = area_.y + area_.height;
    for (const double x_m : TicksBetween(min_map_.x(), max_map.x(), step_m)) {
      const std::string text = StepLabel(x_m, step_m);
      const double u = ToPixel({x_m, 0.0}).x();
      canvas_.StrokeLine({u, bottom}, {u, bottom + 5.0}, {kTextGrey, 1.0});
      canvas_.Text(text, {u - 0.5 * canvas_.TextWidth(text, kTick), bottom + 18.0}, kTick);
    }
    for (const double y_m : TicksBetween(min_map_.y(), max_map.y(), step_m)) {
      const std::string text = StepLabel(y_m, step_m);
      const double v = ToPixel({0.0, y_m}).y();
      canvas_.StrokeLine({area_.x - 5.0, v}, {area_.x, v}, {kTextGrey, 1.0});
      canvas_.Text(text, {area_.x - 8.0 - canvas_.TextWidth(text, kTick), v + 4.0}, kTick);
    }
    const std::string name = "x [m] of map to the right, y [m] up";
    canvas_.Text(name,
                 {area_.x + 0.5 * (area_.width - canvas_.TextWidth(name, kTick)), bottom + 36.0},
                 kTick);
  }

  Canvas& canvas_;
  Rect area_;
  Eigen::Vector2d min_map_;  // What the panel's lower left corner shows.
  double px_per_m_;
};

}  // namespace clearway::plot
