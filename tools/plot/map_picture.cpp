// SPDX-License-Identifier: BSD-3-Clause
#include "tools/plot/map_picture.hpp"

#include <algorithm>
#include <array>
#include <cerrno>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <stdexcept>
#include <system_error>

#include "tools/plot/canvas.hpp"
#include "tools/plot/palette.hpp"
#include "tools/plot/view_region.hpp"

namespace clearway::plot {
namespace {

using core::GridGeometry;
using core::OccupancyGrid;
using Eigen::Vector2d;

constexpr double kMaxPanelWidth_px = 1200.0;
constexpr double kMaxPanelHeight_px = 900.0;
constexpr double kLeastPanel_px = 320.0;
constexpr double kLeft_px = 56.0;
constexpr double kTop_px = 44.0;
constexpr double kBottom_px = 44.0;
constexpr double kGap_px = 20.0;
constexpr double kLegendWidth_px = 300.0;
constexpr double kRow_px = 20.0;
constexpr double kMarginShare = 0.03;

constexpr Colour kOffMap{0.97, 0.94, 0.86};
constexpr Colour kUnknownCell{0.72, 0.76, 0.82};
constexpr TextStyle kTitle{.size_px = 16.0, .colour = kBlack, .is_bold = true};
constexpr TextStyle kText{.size_px = 13.0, .colour = kTextGrey};
constexpr TextStyle kTick{.size_px = 12.0, .colour = kTextGrey};
constexpr TextStyle kOverMap{.size_px = 13.0, .colour = kBlack, .is_bold = true, .has_halo = true};

// A pixel that shows no cell.
constexpr std::uint8_t kNoCell = 254;

std::string Format(const char* format, double a, double b = 0.0) {
  std::array<char, 120> text{};
  std::snprintf(text.data(), text.size(), format, a, b);
  return text.data();
}

// Corner of the grid `column` and `row` cells from the origin, in map.
Vector2d CornerOf(const GridGeometry& geometry, int column, int row) {
  // CenterOf() takes cells beyond the grid; a corner is half a cell's diagonal from a centre.
  return 0.5 * (geometry.CenterOf({column, row}) + geometry.CenterOf({column - 1, row - 1}));
}

Colour ColourOf(std::uint8_t cell) {
  if (cell == OccupancyGrid::kUnknown) return kUnknownCell;
  const double shade = 1.0 - cell / 100.0;
  return {shade, shade, shade};
}

std::vector<double> TicksBetween(double low_m, double high_m, double step_m) {
  std::vector<double> ticks;
  const double first = std::ceil(low_m / step_m);
  const auto count = static_cast<int>(std::floor(high_m / step_m) - first) + 1;
  for (int i = 0; i < count; ++i) ticks.push_back((first + i) * step_m);
  return ticks;
}

class MapPanel {
 public:
  MapPanel(Canvas& canvas, const Rect& area, const Vector2d& min_map, double px_per_m)
      : canvas_(canvas), area_(area), min_map_(min_map), px_per_m_(px_per_m) {}

  void Draw(const OccupancyGrid& grid) {
    canvas_.FillRect(area_, kOffMap);
    DrawCells(grid);
    canvas_.BeginClip(area_);
    const GridGeometry& geometry = grid.geometry;
    const std::array<Vector2d, 4> corners = {
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

  [[nodiscard]] bool Shows(const Vector2d& point_map) const {
    const Vector2d pixel = ToPixel(point_map);
    return area_.Contains({pixel.x(), pixel.y(), 0.0, 0.0});
  }

 private:
  struct AxesLook {
    const char* name;
    Colour colour;
  };

  [[nodiscard]] Vector2d ToPixel(const Vector2d& point_map) const {
    const Vector2d offset_px = px_per_m_ * (point_map - min_map_);
    return {area_.x + offset_px.x(), area_.y + area_.height - offset_px.y()};
  }
  [[nodiscard]] Vector2d ToMap(const Vector2d& pixel) const {
    return min_map_ + Vector2d(pixel.x() - area_.x, area_.y + area_.height - pixel.y()) / px_per_m_;
  }

  void DrawCells(const OccupancyGrid& grid) {
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
  [[nodiscard]] std::vector<std::uint8_t> CellPixels(const OccupancyGrid& grid) const {
    const auto columns = static_cast<std::size_t>(area_.width);
    const auto rows = static_cast<std::size_t>(area_.height);
    std::vector<std::uint8_t> pixels(columns * rows, kNoCell);
    for (std::size_t i = 0; i < pixels.size(); ++i) {
      const Vector2d pixel(area_.x + static_cast<double>(i % columns) + 0.5,
                           area_.y + static_cast<double>(i / columns) + 0.5);
      if (const auto cell = grid.geometry.CellAt(ToMap(pixel))) pixels[i] = grid.At(*cell);
    }
    for (int row = 0; row < grid.geometry.height; ++row) {
      for (int column = 0; column < grid.geometry.width; ++column) {
        const std::uint8_t cell = grid.At({column, row});
        if (cell == OccupancyGrid::kFree || cell > OccupancyGrid::kOccupied) continue;
        const Vector2d pixel = ToPixel(grid.geometry.CenterOf({column, row}));
        const double u = std::floor(pixel.x() - area_.x);
        const double v = std::floor(pixel.y() - area_.y);
        if (!(u >= 0.0 && u < area_.width && v >= 0.0 && v < area_.height)) continue;
        std::uint8_t& shown =
            pixels[static_cast<std::size_t>(v) * columns + static_cast<std::size_t>(u)];
        if (shown > OccupancyGrid::kOccupied || cell > shown) shown = cell;
      }
    }
    return pixels;
  }

  void DrawAxes(const Vector2d& origin_map, double yaw_rad, const AxesLook& look) {
    constexpr double kLength_px = 48.0;
    if (!Shows(origin_map)) return;
    const Vector2d origin = ToPixel(origin_map);
    const Vector2d x_axis = kLength_px * Vector2d(std::cos(yaw_rad), -std::sin(yaw_rad));
    const Vector2d y_axis(x_axis.y(), -x_axis.x());
    DrawArrow(origin, x_axis, look.colour);
    DrawArrow(origin, y_axis, look.colour);
    canvas_.FillCircle(origin, 4.5, {1.0, 1.0, 1.0});
    canvas_.FillCircle(origin, 3.4, look.colour);
    TextStyle style = kOverMap;
    style.colour = look.colour;
    const auto label = [&](const std::string& text, const Vector2d& middle) {
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

  void DrawArrow(const Vector2d& from, const Vector2d& vector, const Colour& colour) {
    const Vector2d side(0.09 * vector.y(), -0.09 * vector.x());
    const Vector2d tip = from + vector;
    const std::array<Vector2d, 3> head = {
        tip, from + 0.78 * vector + side, from + 0.78 * vector - side};
    canvas_.StrokeLine(from, tip, {{1.0, 1.0, 1.0, 0.85}, 4.5});
    canvas_.StrokeLine(from, from + 0.85 * vector, {colour, 2.2});
    canvas_.FillPolygon(head, colour);
  }

  void DrawTicks() {
    constexpr double kLeastStep_px = 70.0;
    double step_m = RoundStep(kLeastStep_px / px_per_m_);
    while (step_m * px_per_m_ < kLeastStep_px) step_m = RoundStep(2.5 * step_m);
    const Vector2d max_map = min_map_ + Vector2d(area_.width, area_.height) / px_per_m_;
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
  Vector2d min_map_;  // What the panel's lower left corner shows.
  double px_per_m_;
};

// 12345 -> "12 345".
std::string Grouped(std::size_t number) {
  std::string digits = std::to_string(number);
  for (auto at = static_cast<std::ptrdiff_t>(digits.size()) - 3; at > 0; at -= 3) {
    digits.insert(static_cast<std::size_t>(at), "\u2009");
  }
  return digits;
}

class Legend {
 public:
  Legend(Canvas& canvas, const Rect& column) : canvas_(canvas), column_(column), y_(column.y) {}

  void AddKey(const Colour& colour, const std::string& text) {
    const Rect sign{column_.x, y_ + 2.0, 22.0, 13.0};
    canvas_.FillRect(sign, colour);
    canvas_.StrokeRect(sign, {kPointGrey, 1.0});
    AddText(text, 32.0);
  }
  void AddCount(const Colour& colour, const char* name, std::size_t count, std::size_t all) {
    const double percent = 100.0 * static_cast<double>(count) / static_cast<double>(all);
    AddKey(colour, std::string(name) + "  " + Grouped(count) + Format("  (%.1f %%)", percent));
  }
  void AddText(const std::string& text, double indent_px = 0.0) {
    if (y_ + kRow_px > column_.y + column_.height) return;
    canvas_.Text(canvas_.Shorten(text, kText, column_.width - indent_px),
                 {column_.x + indent_px, y_ + 14.0},
                 kText);
    y_ += kRow_px;
  }
  void AddGap() { y_ += 0.5 * kRow_px; }

 private:
  Canvas& canvas_;
  Rect column_;
  double y_;
};

void DrawLegend(Legend legend,
                const OccupancyGrid& grid,
                const MapPictureText& text,
                const std::vector<std::string>& remarks) {
  const GridGeometry& geometry = grid.geometry;
  const CellCounts counts = CountCells(grid);
  const std::size_t all = grid.cells.size();
  legend.AddText(Grouped(static_cast<std::size_t>(geometry.width)) + " x " +
                 Grouped(static_cast<std::size_t>(geometry.height)) + " cells, " +
                 Format("%.4g m x %.4g m",
                        geometry.width * geometry.resolution_m,
                        geometry.height * geometry.resolution_m));
  legend.AddText(Format("resolution %.6g m", geometry.resolution_m));
  legend.AddText(
      Format("grid's origin x %.6g m, y %.6g m", geometry.origin_x_m, geometry.origin_y_m));
  legend.AddText(Format(
      "yaw %.6g rad (%.4g deg)", geometry.origin_yaw_rad, geometry.origin_yaw_rad * 180.0 / M_PI));
  legend.AddGap();
  legend.AddCount(ColourOf(OccupancyGrid::kFree), "free", counts.free, all);
  legend.AddCount(ColourOf(OccupancyGrid::kOccupied), "occupied", counts.occupied, all);
  if (counts.between > 0) legend.AddCount(ColourOf(50), "between", counts.between, all);
  legend.AddCount(kUnknownCell, "unknown", counts.unknown, all);
  legend.AddKey(kOffMap, "off the map");
  legend.AddGap();
  for (const std::string& line : remarks) legend.AddText(line);
  legend.AddGap();
  for (const std::string& line : text.lines) legend.AddText(line);
}

// At the lower left corner of `place`.
void DrawScaleBar(Canvas& canvas, const Rect& place, double px_per_m) {
  constexpr double kHeight_px = 6.0;
  const double length_m = RoundStep(place.width / px_per_m);
  const double length_px = length_m * px_per_m;
  const double top = place.y + place.height - kHeight_px;
  canvas.FillRect({place.x, top, length_px, kHeight_px}, kBlack);
  canvas.FillRect({place.x + 0.5 * length_px, top + 1.0, 0.5 * length_px - 1.0, kHeight_px - 2.0},
                  {1.0, 1.0, 1.0});
  canvas.Text(StepLabel(length_m, length_m) + " m", {place.x, top - 6.0}, kText);
}

// The part of map that the picture shows, and how large.
struct View {
  Vector2d min_map;
  double px_per_m = 1.0;
  double width_px = 0.0;
  double height_px = 0.0;
};

View ViewOf(const GridGeometry& geometry) {
  Vector2d low = CornerOf(geometry, 0, 0);
  Vector2d high = low;
  for (const auto& [column, row] : {std::pair(geometry.width, 0),
                                    std::pair(0, geometry.height),
                                    std::pair(geometry.width, geometry.height)}) {
    low = low.cwiseMin(CornerOf(geometry, column, row));
    high = high.cwiseMax(CornerOf(geometry, column, row));
  }
  const double margin_m = kMarginShare * (high - low).maxCoeff();
  low -= Vector2d::Constant(margin_m);
  high += Vector2d::Constant(margin_m);
  View view;
  const Vector2d size_m = high - low;
  view.px_per_m = std::min(kMaxPanelWidth_px / size_m.x(), kMaxPanelHeight_px / size_m.y());
  view.width_px = std::max(kLeastPanel_px, std::ceil(view.px_per_m * size_m.x()));
  view.height_px = std::max(kLeastPanel_px, std::ceil(view.px_per_m * size_m.y()));
  // In the middle of a panel that is larger than the grid needs.
  view.min_map = 0.5 * (low + high) - 0.5 / view.px_per_m * Vector2d(view.width_px, view.height_px);
  return view;
}

// Beyond these limits the picture's coordinates are no longer exact to a pixel.
void CheckScale(const GridGeometry& geometry) {
  constexpr double kFinest_m = 1e-4;
  constexpr double kFarthest_m = 1e8;
  const double side_m = geometry.resolution_m * std::max(geometry.width, geometry.height);
  const double origin_m = std::max(std::abs(geometry.origin_x_m), std::abs(geometry.origin_y_m));
  if (geometry.resolution_m >= kFinest_m && side_m <= kFarthest_m && origin_m <= kFarthest_m)
    return;
  throw std::runtime_error(
      "cannot draw a map of resolution " + Format("%.6g m", geometry.resolution_m) +
      Format(" with its origin at (%.6g, %.6g) m", geometry.origin_x_m, geometry.origin_y_m) +
      ": expected a resolution of at least 0.0001 m, and size and origin up to 1e8 m");
}

void WriteFile(const std::vector<unsigned char>& bytes, const std::filesystem::path& path) {
  errno = 0;
  std::ofstream file(path, std::ios::binary);
  file.write(reinterpret_cast<const char*>(bytes.data()),
             static_cast<std::streamsize>(bytes.size()));
  file.close();
  if (!file) {
    throw std::runtime_error(
        path.string() + ": cannot write the picture: " + std::generic_category().message(errno));
  }
}

}  // namespace

CellCounts CountCells(const OccupancyGrid& grid) {
  CellCounts counts;
  for (const std::uint8_t cell : grid.cells) {
    if (cell > OccupancyGrid::kOccupied) {
      ++counts.unknown;
    } else if (cell == OccupancyGrid::kOccupied) {
      ++counts.occupied;
    } else if (cell == OccupancyGrid::kFree) {
      ++counts.free;
    } else {
      ++counts.between;
    }
  }
  return counts;
}

void WriteMapPng(const OccupancyGrid& grid,
                 const MapPictureText& text,
                 const std::filesystem::path& path) {
  CheckScale(grid.geometry);
  const View view = ViewOf(grid.geometry);
  const Rect area{kLeft_px, kTop_px, view.width_px, view.height_px};
  const double width_px = kLeft_px + view.width_px + kGap_px + kLegendWidth_px + kGap_px;
  const double height_px = kTop_px + view.height_px + kBottom_px;
  Canvas canvas(static_cast<int>(width_px), static_cast<int>(height_px));
  canvas.Text(
      canvas.Shorten(text.title, kTitle, width_px - 2.0 * kGap_px), {kLeft_px, 28.0}, kTitle);
  MapPanel panel(canvas, area, view.min_map, view.px_per_m);
  panel.Draw(grid);

  std::vector<std::string> remarks;
  const double cell_px = view.px_per_m * grid.geometry.resolution_m;
  remarks.push_back(cell_px >= 1.0 ? Format("a cell is %.3g pixels wide", cell_px)
                                   : Format("a pixel is %.3g cells wide", 1.0 / cell_px));
  remarks.emplace_back("red axes: map; blue: the grid's own");
  if (!panel.Shows({0.0, 0.0})) remarks.emplace_back("the origin of map is out of view");
  DrawLegend(
      Legend(canvas,
             {area.x + area.width + kGap_px, kTop_px, kLegendWidth_px, view.height_px - 40.0}),
      grid,
      text,
      remarks);
  DrawScaleBar(canvas,
               {area.x + area.width + kGap_px, area.y + area.height - 30.0, 200.0, 30.0},
               view.px_per_m);
  WriteFile(canvas.EncodePng(), path);
}

}  // namespace clearway::plot
