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
#include "tools/plot/map_panel.hpp"
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
