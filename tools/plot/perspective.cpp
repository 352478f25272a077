// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

#include <Eigen/Core>

#include "tools/plot/camera.hpp"
#include "tools/plot/label_placer.hpp"
#include "tools/plot/map_underlay.hpp"
#include "tools/plot/panels.hpp"

namespace clearway::plot {

namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr TextStyle kTick{.size_px = 12.0, .colour = kTextGrey, .has_halo = true};
constexpr TextStyle kLabel{.size_px = 12.0, .colour = kDarkPurple, .has_halo = true};

std::vector<Vector3d> Lift(const std::vector<Eigen::Vector2f>& polygon, double z_m) {
  std::vector<Vector3d> lifted;
  lifted.reserve(polygon.size());
  for (const Eigen::Vector2f& vertex : polygon) lifted.emplace_back(vertex.x(), vertex.y(), z_m);
  return lifted;
}

class Perspective {
 public:
  Perspective(Canvas& canvas, const Rect& panel, const ViewRegion& region)
      : canvas_(canvas), area_(panel), region_(region), camera_(panel, region), labels_(panel) {
    const double span_m =
        std::max(region.x_max_m - region.x_min_m, region.y_max_m - region.y_min_m);
    report_.grid_step_m = RoundStep(span_m / 5.0);
  }

  PanelReport Draw(const ScanPicture& picture) {
    canvas_.FillRect(area_, kPanel);
    if (const PictureMap* const map = MapOf(picture)) DrawMap(canvas_, area_, *map, View());
    canvas_.BeginClip(area_);
    DrawGrid();
    for (const PictureCorridor& corridor : CorridorsOf(picture)) DrawCorridor(corridor);
    DrawTops(picture);
    DrawPoints(picture);
    DrawVehicle(picture);
    for (const PictureTruthBox& box : TruthBoxesOf(picture)) {
      const float half_m = 0.5F * box.height_m;
      DrawPrism(Corners(box.center.head<2>(), box.length_m, box.width_m, box.yaw_rad),
                box.center.z() - half_m,
                box.center.z() + half_m,
                {kBlack, 1.4, true});
    }
    DrawDetections(picture);
    DrawRanges();
    canvas_.EndClip();
    canvas_.StrokeRect(area_, {kPointGrey, 1.0});
    return report_;
  }

 private:
  void DrawSegment(const Vector3d& from, const Vector3d& to, const Pen& pen) {
    const std::vector<Vector2d> ends = camera_.ProjectPolygon({from, to});
    canvas_.StrokePolygon(ends, pen);
  }

  // The floor within the region and half as much again on each side: a map ends less abruptly.
  [[nodiscard]] FloorView View() const {
    const Vector2d low(region_.x_min_m, region_.y_min_m);
    const Vector2d high(region_.x_max_m, region_.y_max_m);
    const Vector2d margin = 0.5 * (high - low);
    const Vector2d outer_low = low - margin;
    const Vector2d outer_high = high + margin;
    return {.floor_at =
                [this, outer_low, outer_high](const Vector2d& pixel) -> std::optional<Vector2d> {
              const std::optional<Vector2d> point = camera_.FloorAt(pixel);
              const bool is_shown = point && (point->array() >= outer_low.array()).all() &&
                                    (point->array() <= outer_high.array()).all();
              return is_shown ? point : std::nullopt;
            },
            .pixel_at =
                [this](const Vector2d& point) {
                  return camera_.Project({point.x(), point.y(), 0.0});
                },
            .low = outer_low,
            .high = outer_high};
  }

  // The floor's grid, over the region.
  void DrawGrid() {
    const double step_m = report_.grid_step_m;
    const auto first = [&](double m) { return static_cast<int>(std::ceil(m / step_m)); };
    const auto last = [&](double m) { return static_cast<int>(std::floor(m / step_m)); };
    for (int i = first(region_.x_min_m); i <= last(region_.x_max_m); ++i) {
      DrawSegment(
          {i * step_m, region_.y_min_m, 0.0}, {i * step_m, region_.y_max_m, 0.0}, {kGridGrey, 1.0});
    }
    for (int i = first(region_.y_min_m); i <= last(region_.y_max_m); ++i) {
      DrawSegment(
          {region_.x_min_m, i * step_m, 0.0}, {region_.x_max_m, i * step_m, 0.0}, {kGridGrey, 1.0});
    }
  }

  // Distances along x, beside the right end of the grid's cross lines.
  void DrawRanges() {
    const double step_m = report_.grid_step_m;
    for (int i = static_cast<int>(std::ceil(region_.x_min_m / step_m));
         i * step_m <= region_.x_max_m;
         ++i) {
      const auto pixel = camera_.Project({i * step_m, region_.y_min_m, 0.0});
      if (!pixel) continue;
      const Vector2d inside(std::min(pixel->x(), area_.x + area_.width - 60.0), pixel->y());
      labels_.Place(canvas_, StepLabel(i * step_m, step_m) + " m", inside, kTick);
    }
  }

  void DrawPoints(const ScanPicture& picture) {
    std::vector<Eigen::Vector2f> pixels;
    for (const PointLayer& layer : LayersOf(picture)) {
      pixels.clear();
      for (const Eigen::Vector3f& p : *layer.points) {
        const auto pixel = camera_.Project(p.cast<double>());
        const bool is_inside = pixel && pixel->x() >= area_.x && pixel->y() >= area_.y &&
                               pixel->x() < area_.x + area_.width &&
                               pixel->y() < area_.y + area_.height;
        if (is_inside) pixels.push_back(pixel->cast<float>());
        if (!is_inside && layer.points == &picture.raw_points) ++report_.num_points_outside;
      }
      canvas_.Dots(pixels, layer.colour, layer.size_px, area_);
    }
  }

  void DrawCorridor(const PictureCorridor& corridor) {
    const CorridorLook look = LookOf(corridor.state);
    const std::vector<Vector2d> polygon = camera_.ProjectPolygon(Lift(corridor.polygon, 0.0));
    canvas_.FillPolygon(polygon, look.fill);
    canvas_.StrokePolygon(polygon, look.outline);
  }

  void DrawVehicle(const ScanPicture& picture) {
    const std::vector<Vector2d> footprint = camera_.ProjectPolygon(Lift(picture.footprint, 0.0));
    canvas_.FillPolygon(footprint, kBlack.WithOpacity(0.12));
    canvas_.StrokePolygon(footprint, {kBlack, 1.8});
    const Vector3d sensor = picture.sensor_origin.cast<double>();
    DrawSegment({sensor.x(), sensor.y(), 0.0}, sensor, {kBlack, 1.6});
    if (const auto pixel = camera_.Project(sensor)) {
      canvas_.FillCircle(*pixel, 4.5, {1.0, 1.0, 1.0});
      canvas_.FillCircle(*pixel, 3.2, kBlack);
    }
    const double length_m = 0.08 * (region_.x_max_m - region_.x_min_m);
    DrawAxis("x", Vector3d::UnitX() * length_m);
    DrawAxis("y", Vector3d::UnitY() * length_m);
    DrawAxis("z", Vector3d::UnitZ() * length_m);
  }

  void DrawAxis(const std::string& name, const Vector3d& tip) {
    DrawSegment(Vector3d::Zero(), tip, {kBlack, 2.0});
    const auto pixel = camera_.Project(1.2 * tip);
    if (!pixel) return;
    const Vector2d left_base = *pixel + Vector2d(-4.0, 4.0);
    canvas_.Text(
        name, left_base, {.size_px = 13.0, .colour = kBlack, .is_bold = true, .has_halo = true});
    labels_.Reserve({left_base.x() - 2.0, left_base.y() - 13.0, 13.0, 17.0});
  }

  void DrawPrism(const std::vector<Eigen::Vector2f>& base,
                 double z_min,
                 double z_max,
                 const Pen& pen) {
    const std::vector<Vector3d> lower = Lift(base, z_min);
    const std::vector<Vector3d> upper = Lift(base, z_max);
    canvas_.StrokePolygon(camera_.ProjectPolygon(lower), pen);
    canvas_.StrokePolygon(camera_.ProjectPolygon(upper), pen);
    for (std::size_t i = 0; i < base.size(); ++i) DrawSegment(lower[i], upper[i], pen);
  }

  // Upper faces, below the points so that these keep their colours.
  void DrawTops(const ScanPicture& picture) {
    for (const PictureDetection& d : DetectionsOf(picture)) {
      const auto corners = Corners(d.center, d.length_m, d.width_m, d.yaw_rad);
      canvas_.FillPolygon(camera_.ProjectPolygon(Lift(corners, d.z_max_m)),
                          kPurple.WithOpacity(0.22));
    }
  }

  // Far ones first, so that near ones lie on top; labels from near to far.
  void DrawDetections(const ScanPicture& picture) {
    std::vector<const PictureDetection*> order;
    for (const PictureDetection& detection : DetectionsOf(picture)) order.push_back(&detection);
    std::stable_sort(order.begin(), order.end(), [](const auto* a, const auto* b) {
      return a->center.x() > b->center.x();
    });
    for (const PictureDetection* d : order) {
      DrawPrism(Corners(d->center, d->length_m, d->width_m, d->yaw_rad),
                d->z_min_m,
                d->z_max_m,
                {kDarkPurple, 1.4});
    }
    for (auto d = order.rbegin(); d != order.rend(); ++d) {
      const auto pixel = camera_.Project({(*d)->center.x(), (*d)->center.y(), (*d)->z_max_m});
      if (!pixel || !labels_.IsInArea(*pixel)) continue;
      if (!labels_.Place(canvas_, (*d)->label, *pixel, kLabel)) ++report_.num_labels_left_out;
    }
  }

  Canvas& canvas_;
  Rect area_;
  ViewRegion region_;
  Camera camera_;
  LabelPlacer labels_;
  PanelReport report_;
};

}  // namespace

PanelReport DrawPerspective(Canvas& canvas,
                            const Rect& panel,
                            const ScanPicture& picture,
                            const ViewRegion& region) {
  return Perspective(canvas, panel, region).Draw(picture);
}

}  // namespace clearway::plot
