// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <functional>

#include "tools/plot/panels.hpp"

namespace clearway::plot {

namespace {

constexpr double kRow_px = 19.0;
constexpr double kKeyColumn_px = 248.0;
constexpr TextStyle kText{.size_px = 13.0, .colour = kTextGrey};

const std::string kMissing = "\u2013 not known";

// A sign and its meaning.
struct Key {
  std::string text;
  std::function<void(Canvas&, const Rect&)> draw;
};

// 12345 -> "12 345".
std::string Grouped(std::size_t number) {
  std::string digits = std::to_string(number);
  for (auto at = static_cast<std::ptrdiff_t>(digits.size()) - 3; at > 0; at -= 3) {
    digits.insert(static_cast<std::size_t>(at), "\u2009");
  }
  return digits;
}

std::vector<Eigen::Vector2d> Polygon(const Rect& r) {
  return {{r.x, r.y}, {r.x + r.width, r.y}, {r.x + r.width, r.y + r.height}, {r.x, r.y + r.height}};
}

void AddPointKeys(const ScanPicture& picture, std::vector<Key>& keys) {
  for (const PointLayer& layer : LayersOf(picture)) {
    const Colour colour = layer.colour.WithOpacity(1.0);
    const bool is_missing = picture.missing.Contains(layer.layer);
    const bool is_below = layer.points == &picture.below_floor_points;
    if (is_missing && is_below) continue;  // It comes with the obstacle points.
    keys.push_back(
        {std::string(layer.name) + "  " + (is_missing ? kMissing : Grouped(layer.points->size())),
         [colour](Canvas& canvas, const Rect& sign) {
           for (const double share : {0.15, 0.4, 0.65, 0.9}) {
             const double lift = share > 0.3 && share < 0.8 ? 0.3 : 0.7;
             canvas.FillRect(
                 {sign.x + share * sign.width - 1.5, sign.y + lift * sign.height - 1.5, 3.0, 3.0},
                 colour);
           }
         }});
  }
}

void AddShapeKeys(const ScanPicture& picture, std::vector<Key>& keys) {
  if (!picture.hidden.Contains(Layer::kDetections)) {
    const bool is_missing = picture.missing.Contains(Layer::kDetections);
    keys.push_back(
        {"detections  " +
             (is_missing ? kMissing : Grouped(picture.detections.size()) + ": hull, box, + mean"),
         [](Canvas& canvas, const Rect& sign) {
           canvas.FillPolygon(Polygon(sign), kPurple.WithOpacity(0.35));
           canvas.StrokePolygon(Polygon(sign), {kDarkPurple, 1.6});
         }});
  }
  if (!TruthBoxesOf(picture).empty()) {
    keys.push_back(
        {"labels  " + Grouped(TruthBoxesOf(picture).size()), [](Canvas& canvas, const Rect& sign) {
           canvas.StrokePolygon(Polygon(sign), {kBlack, 1.4, true});
         }});
  }
  for (const CorridorState state :
       {CorridorState::kFree, CorridorState::kLimited, CorridorState::kStop}) {
    const auto count = std::count_if(CorridorsOf(picture).begin(),
                                     CorridorsOf(picture).end(),
                                     [&](const auto& c) { return c.state == state; });
    if (count == 0) continue;
    const CorridorLook look = LookOf(state);
    keys.push_back(
        {"corridor: " + std::string(look.name), [look](Canvas& canvas, const Rect& sign) {
           canvas.FillPolygon(Polygon(sign), look.fill);
           canvas.StrokePolygon(Polygon(sign), look.outline);
         }});
  }
  keys.push_back(
      {picture.footprint.empty() ? "sensor" : "sensor, footprint",
       [](Canvas& canvas, const Rect& sign) {
         canvas.FillCircle({sign.x + 0.5 * sign.width, sign.y + 0.5 * sign.height}, 3.2, kBlack);
       }});
}

void AddMapKeys(const ScanPicture& picture, std::vector<Key>& keys) {
  if (picture.hidden.Contains(Layer::kMap)) return;
  if (!picture.map) {
    if (picture.missing.Contains(Layer::kMap)) {
      keys.push_back({"map  " + kMissing, [](Canvas& canvas, const Rect& sign) {
                        canvas.FillRect(sign, kOccupiedGrey);
                      }});
    }
    return;
  }
  keys.push_back({"map: occupied",
                  [](Canvas& canvas, const Rect& sign) { canvas.FillRect(sign, kOccupiedGrey); }});
  keys.push_back({"map: unknown, or off it", [](Canvas& canvas, const Rect& sign) {
                    canvas.FillRect(sign, kUnknownTint);
                    for (double x = 0.0; x + 9.0 < sign.width; x += 7.0) {
                      canvas.StrokeLine({sign.x + x, sign.y + sign.height},
                                        {sign.x + x + 12.0, sign.y},
                                        {kUnknownHatch, 1.2});
                    }
                  }});
}

// Lines from top to bottom, with a note in the last row where they do not fit.
void DrawLines(Canvas& canvas, const Rect& column, const std::vector<std::string>& lines) {
  const auto rows = static_cast<std::size_t>(std::max(1.0, column.height / kRow_px));
  const std::size_t shown = lines.size() <= rows ? lines.size() : rows - 1;
  double base = column.y + 14.0;
  for (std::size_t i = 0; i < shown; ++i, base += kRow_px) {
    canvas.Text(canvas.Shorten(lines[i], kText, column.width), {column.x, base}, kText);
  }
  if (shown == lines.size()) return;
  canvas.Text(
      "\u2026 " + std::to_string(lines.size() - shown) + " more lines", {column.x, base}, kText);
}

}  // namespace

void DrawLegend(Canvas& canvas,
                const Rect& strip,
                const ScanPicture& picture,
                const std::vector<std::string>& remarks) {
  std::vector<Key> keys;
  AddPointKeys(picture, keys);
  AddShapeKeys(picture, keys);
  AddMapKeys(picture, keys);
  const auto rows = static_cast<std::size_t>(strip.height / kRow_px);
  for (std::size_t i = 0; i < keys.size(); ++i) {
    const double x = strip.x + kKeyColumn_px * static_cast<double>(i / rows);
    const double y = strip.y + kRow_px * static_cast<double>(i % rows);
    keys[i].draw(canvas, {x, y + 3.0, 22.0, 12.0});
    canvas.Text(keys[i].text, {x + 32.0, y + 14.0}, kText);
  }
  const double keys_px = kKeyColumn_px * static_cast<double>((keys.size() + rows - 1) / rows);
  const double half_px = 0.5 * strip.width;
  DrawLines(canvas, {strip.x + keys_px, strip.y, half_px - keys_px - 20.0, strip.height}, remarks);
  DrawLines(canvas, {strip.x + half_px, strip.y, half_px, strip.height}, picture.text_lines);
}

}  // namespace clearway::plot
