// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>

#include "tools/plot/label_placer.hpp"
#include "tools/plot/map_underlay.hpp"
#include "tools/plot/panels.hpp"

namespace clearway::plot {

namespace {

constexpr double kLeftMargin_px = 44.0;
constexpr double kBottomMargin_px = 38.0;
constexpr double kLeastGridCell_px = 60.0;
constexpr TextStyle kTick{.size_px = 12.0, .colour = kTextGrey};
constexpr TextStyle kLabel{.size_px = 12.0, .colour = kDarkPurple, .has_halo = true};
constexpr TextStyle kTruthLabel{.size_px = 13.0,
                                .colour = kBlack,
                                .is_bold = true,
                                .has_halo = true};
constexpr TextStyle kCorridorLabel{.size_px = 13.0,
                                   .colour = kBlack,
                                   .is_bold = true,
                                   .has_halo = true};

class BirdsEye {
 public:
  BirdsEye(Canvas& canvas, const Rect& panel, const ViewRegion& region)
      : canvas_(canvas),
        area_{panel.x + kLeftMargin_px,
              panel.y,
              panel.width - kLeftMargin_px,
              panel.height - kBottomMargin_px},
        labels_(area_) {
    px_per_m_ = std::min(area_.height / (region.x_max_m - region.x_min_m),
                         area_.width / (region.y_max_m - region.y_min_m));
    x_middle_m_ = 0.5 * (region.x_min_m + region.x_max_m);
    y_middle_m_ = 0.5 * (region.y_min_m + region.y_max_m);
    report_.grid_step_m = RoundStep(kLeastGridCell_px / px_per_m_);
    while (report_.grid_step_m * px_per_m_ < kLeastGridCell_px) {
      report_.grid_step_m = RoundStep(2.5 * report_.grid_step_m);
    }
  }

  PanelReport Draw(const ScanPicture& picture) {
    canvas_.FillRect(area_, kPanel);
    if (const PictureMap* const map = MapOf(picture)) DrawMap(canvas_, area_, *map, View());
    canvas_.BeginClip(area_);
    DrawGrid();
    for (const PictureCorridor& corridor : CorridorsOf(picture)) DrawCorridor(corridor);
    for (const PictureDetection& detection : DetectionsOf(picture)) {
      canvas_.FillPolygon(ToPixels(detection.hull), kPurple.WithOpacity(0.28));
    }
    DrawPoints(picture);
    DrawAxes();
    DrawVehicle(picture);
    for (const PictureTruthBox& box : TruthBoxesOf(picture)) {
      canvas_.StrokePolygon(
          ToPixels(Corners(box.center.head<2>(), box.length_m, box.width_m, box.yaw_rad)),
          {kBlack, 1.6, true});
    }
    for (const PictureDetection& detection : DetectionsOf(picture)) DrawDetection(detection);
    DrawLabels(picture);
    canvas_.EndClip();
    canvas_.StrokeRect(area_, {kPointGrey, 1.0});
    DrawTicks();
    return report_;
  }

 private:
  [[nodiscard]] Eigen::Vector2d ToPixel(double x_m, double y_m) const {
    return {area_.x + 0.5 * area_.width - (y_m - y_middle_m_) * px_per_m_,
            area_.y + 0.5 * area_.height - (x_m - x_middle_m_) * px_per_m_};
  }

  [[nodiscard]] Eigen::Vector2d ToFloor(const Eigen::Vector2d& pixel) const {
    return {x_middle_m_ - (pixel.y() - area_.y - 0.5 * area_.height) / px_per_m_,
            y_middle_m_ - (pixel.x() - area_.x - 0.5 * area_.width) / px_per_m_};
  }

  [[nodiscard]] FloorView View() const {
    return {
        .floor_at = [this](const Eigen::Vector2d& pixel) { return ToFloor(pixel); },
        .pixel_at = [this](const Eigen::Vector2d& point) { return ToPixel(point.x(), point.y()); },
        .low = ToFloor({area_.x + area_.width, area_.y + area_.height}),
        .high = ToFloor({area_.x, area_.y})};
  }

  [[nodiscard]] std::vector<Eigen::Vector2d> ToPixels(
      const std::vector<Eigen::Vector2f>& polygon) const {
    std::vector<Eigen::Vector2d> pixels;
    pixels.reserve(polygon.size());
    for (const Eigen::Vector2f& vertex : polygon) pixels.push_back(ToPixel(vertex.x(), vertex.y()));
    return pixels;
  }

  // Calls draw(value) for every grid line between two coordinates.
  template <typename Function>
  void ForEachLine(double middle_m, double half_m, Function draw) const {
    const double step_m = report_.grid_step_m;
    const auto first = static_cast<int>(std::ceil((middle_m - half_m) / step_m));
    const auto last = static_cast<int>(std::floor((middle_m + half_m) / step_m));
    for (int i = first; i <= last; ++i) draw(i * step_m);
  }
  template <typename Function>
  void ForEachX(Function draw) const {
    ForEachLine(x_middle_m_, 0.5 * area_.height / px_per_m_, draw);
  }
  template <typename Function>
  void ForEachY(Function draw) const {
    ForEachLine(y_middle_m_, 0.5 * area_.width / px_per_m_, draw);
  }

  void DrawGrid() {
    ForEachX([&](double x_m) {
      const double v = ToPixel(x_m, 0.0).y();
      canvas_.StrokeLine({area_.x, v}, {area_.x + area_.width, v}, {kGridGrey, 1.0});
    });
    ForEachY([&](double y_m) {
      const double u = ToPixel(0.0, y_m).x();
      canvas_.StrokeLine({u, area_.y}, {u, area_.y + area_.height}, {kGridGrey, 1.0});
    });
  }

  void DrawTicks() {
    ForEachX([&](double x_m) {
      const std::string text = StepLabel(x_m, report_.grid_step_m);
      const double v = ToPixel(x_m, 0.0).y();
      if (v < area_.y + 24.0) return;  // Room for the axis' name.
      canvas_.Text(text, {area_.x - 6.0 - canvas_.TextWidth(text, kTick), v + 4.0}, kTick);
    });
    ForEachY([&](double y_m) {
      const std::string text = StepLabel(y_m, report_.grid_step_m);
      const double u = ToPixel(0.0, y_m).x() - 0.5 * canvas_.TextWidth(text, kTick);
      canvas_.Text(text, {u, area_.y + area_.height + 16.0}, kTick);
    });
    canvas_.Text("x [m]", {area_.x - kLeftMargin_px + 4.0, area_.y + 12.0}, kTick);
    const std::string name = "y [m]  (left of the vehicle is positive)";
    canvas_.Text(name,
                 {area_.x + 0.5 * (area_.width - canvas_.TextWidth(name, kTick)),
                  area_.y + area_.height + 33.0},
                 kTick);
  }

  void DrawPoints(const ScanPicture& picture) {
    std::vector<Eigen::Vector2f> pixels;
    for (const PointLayer& layer : LayersOf(picture)) {
      pixels.clear();
      for (const Eigen::Vector3f& p : *layer.points) {
        pixels.push_back(ToPixel(p.x(), p.y()).cast<float>());
        if (layer.points == &picture.raw_points && !IsInside(pixels.back())) {
          ++report_.num_points_outside;
        }
      }
      canvas_.Dots(pixels, layer.colour, layer.size_px, area_);
    }
  }

  [[nodiscard]] bool IsInside(const Eigen::Vector2f& pixel) const {
    return pixel.x() >= static_cast<float>(area_.x) &&
           pixel.x() < static_cast<float>(area_.x + area_.width) &&
           pixel.y() >= static_cast<float>(area_.y) &&
           pixel.y() < static_cast<float>(area_.y + area_.height);
  }

  void DrawCorridor(const PictureCorridor& corridor) {
    const CorridorLook look = LookOf(corridor.state);
    const std::vector<Eigen::Vector2d> polygon = ToPixels(corridor.polygon);
    canvas_.FillPolygon(polygon, look.fill);
    canvas_.StrokePolygon(polygon, look.outline);
  }

  // The vehicle frame's axes, about 45 px long.
  void DrawAxes() {
    const double length_m = 45.0 / px_per_m_;
    const Eigen::Vector2d origin = ToPixel(0.0, 0.0);
    canvas_.StrokeLine(origin, ToPixel(length_m, 0.0), {kBlack, 2.2});
    canvas_.StrokeLine(origin, ToPixel(0.0, length_m), {kBlack, 2.2});
    DrawAxisName("x", ToPixel(length_m, 0.0) + Eigen::Vector2d(-4.0, -5.0));
    DrawAxisName("y", ToPixel(0.0, length_m) + Eigen::Vector2d(-12.0, 4.0));
  }

  void DrawAxisName(const std::string& name, const Eigen::Vector2d& left_base) {
    canvas_.Text(name, left_base, kCorridorLabel);
    labels_.Reserve({left_base.x() - 2.0, left_base.y() - 13.0, 13.0, 16.0});
  }

  void DrawVehicle(const ScanPicture& picture) {
    const std::vector<Eigen::Vector2d> footprint = ToPixels(picture.footprint);
    canvas_.FillPolygon(footprint, kBlack.WithOpacity(0.12));
    canvas_.StrokePolygon(footprint, {kBlack, 1.8});
    const Eigen::Vector2d sensor = ToPixel(picture.sensor_origin.x(), picture.sensor_origin.y());
    canvas_.FillCircle(sensor, 4.5, {1.0, 1.0, 1.0});
    canvas_.FillCircle(sensor, 3.2, kBlack);
  }

  void DrawDetection(const PictureDetection& detection) {
    canvas_.StrokePolygon(ToPixels(detection.hull), {kDarkPurple, 1.6});
    canvas_.StrokePolygon(
        ToPixels(
            Corners(detection.center, detection.length_m, detection.width_m, detection.yaw_rad)),
        {kDarkPurple, 1.0, true});
    const Eigen::Vector2d c = ToPixel(detection.centroid.x(), detection.centroid.y());
    canvas_.StrokeLine(c - Eigen::Vector2d(4.0, 0.0), c + Eigen::Vector2d(4.0, 0.0), {kBlack, 1.4});
    canvas_.StrokeLine(c - Eigen::Vector2d(0.0, 4.0), c + Eigen::Vector2d(0.0, 4.0), {kBlack, 1.4});
  }

  // Corridors and ground truth first, then the nearest detections: they matter most.
  void DrawLabels(const ScanPicture& picture) {
    for (const PictureCorridor& corridor : CorridorsOf(picture)) {
      if (corridor.polygon.empty()) continue;
      // Beside the right edge, half way.
      Eigen::Vector2f lowest = corridor.polygon.front();
      Eigen::Vector2f highest = lowest;
      for (const Eigen::Vector2f& vertex : corridor.polygon) {
        lowest = lowest.cwiseMin(vertex);
        highest = highest.cwiseMax(vertex);
      }
      PlaceLabel(corridor.label, {0.5F * (lowest.x() + highest.x()), lowest.y()}, kCorridorLabel);
    }
    for (const PictureTruthBox& box : TruthBoxesOf(picture)) {
      PlaceLabel(box.label, box.center.head<2>(), kTruthLabel);
    }
    std::vector<const PictureDetection*> nearest;
    for (const PictureDetection& detection : DetectionsOf(picture)) nearest.push_back(&detection);
    std::stable_sort(nearest.begin(), nearest.end(), [](const auto* a, const auto* b) {
      return a->center.squaredNorm() < b->center.squaredNorm();
    });
    for (const PictureDetection* detection : nearest) {
      PlaceLabel(detection->label, detection->center, kLabel);
    }
  }

  void PlaceLabel(const std::string& text, const Eigen::Vector2f& at, const TextStyle& style) {
    const Eigen::Vector2d pixel = ToPixel(at.x(), at.y());
    if (!IsInside(pixel.cast<float>())) return;
    if (!labels_.Place(canvas_, text, pixel, style)) ++report_.num_labels_left_out;
  }

  Canvas& canvas_;
  Rect area_;
  LabelPlacer labels_;
  double px_per_m_ = 1.0;
  double x_middle_m_ = 0.0;
  double y_middle_m_ = 0.0;
  PanelReport report_;
};

}  // namespace

PanelReport DrawBirdsEye(Canvas& canvas,
                         const Rect& panel,
                         const ScanPicture& picture,
                         const ViewRegion& region) {
  return BirdsEye(canvas, panel, region).Draw(picture);
}

}  // namespace clearway::plot
