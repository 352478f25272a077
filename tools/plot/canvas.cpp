// SPDX-License-Identifier: BSD-3-Clause
#include "tools/plot/canvas.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <stdexcept>

#include <cairo.h>

namespace clearway::plot {

namespace {

// cairo computes in 24.8 fixed point: what lies far outside is moved in.
constexpr double kFarthest_px = 100'000.0;

Eigen::Vector2d Tame(const Eigen::Vector2d& point) {
  return point.cwiseMax(-kFarthest_px).cwiseMin(kFarthest_px);
}

bool AreFinite(std::span<const Eigen::Vector2d> points) {
  return std::all_of(points.begin(), points.end(), [](const auto& p) { return p.allFinite(); });
}

// Length of the UTF-8 sequence that starts here, 0 where none does.
std::size_t SequenceLength(const std::string& text, std::size_t at) {
  const auto byte = [&](std::size_t i) { return static_cast<unsigned char>(text[i]); };
  const unsigned char first = byte(at);
  const std::size_t length = first < 0x80                     ? 1
                             : first >= 0xC2 && first <= 0xDF ? 2
                             : first >= 0xE0 && first <= 0xEF ? 3
                             : first >= 0xF0 && first <= 0xF4 ? 4
                                                              : 0;
  if (length == 0 || at + length > text.size()) return 0;
  for (std::size_t i = 1; i < length; ++i) {
    if ((byte(at + i) & 0xC0U) != 0x80U) return 0;
  }
  // Overlong forms, surrogates and what lies beyond U+10FFFF.
  if (first == 0xE0 && byte(at + 1) < 0xA0) return 0;
  if (first == 0xED && byte(at + 1) > 0x9F) return 0;
  if (first == 0xF0 && byte(at + 1) < 0x90) return 0;
  if (first == 0xF4 && byte(at + 1) > 0x8F) return 0;
  return length;
}

// cairo stops drawing for good at the first byte that is not UTF-8.
std::string Printable(const std::string& text) {
  std::string result;
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t length = SequenceLength(text, at);
    if (length == 1 && static_cast<unsigned char>(text[at]) < 0x20) {
      result += ' ';
    } else if (length == 0) {
      result += '?';
    } else {
      result.append(text, at, length);
    }
    at += std::max<std::size_t>(length, 1);
  }
  return result;
}

std::uint8_t Blend(std::uint8_t below, double above, double opacity) {
  return static_cast<std::uint8_t>(std::lround(below * (1.0 - opacity) + 255.0 * above * opacity));
}

cairo_status_t AppendBytes(void* closure, const unsigned char* data, unsigned int length) {
  auto* bytes = static_cast<std::vector<unsigned char>*>(closure);
  bytes->insert(bytes->end(), data, data + length);
  return CAIRO_STATUS_SUCCESS;
}

}  // namespace

bool Rect::Contains(const Rect& other) const {
  return other.x >= x && other.y >= y && other.x + other.width <= x + width &&
         other.y + other.height <= y + height;
}

bool Rect::Overlaps(const Rect& other) const {
  return other.x < x + width && x < other.x + other.width && other.y < y + height &&
         y < other.y + other.height;
}

struct Canvas::Cairo {
  Cairo(int width_px, int height_px)
      : surface(cairo_image_surface_create(CAIRO_FORMAT_RGB24, width_px, height_px)),
        context(cairo_create(surface)) {}
  ~Cairo() {
    cairo_destroy(context);
    cairo_surface_destroy(surface);
  }
  Cairo(const Cairo&) = delete;
  Cairo& operator=(const Cairo&) = delete;

  cairo_surface_t* surface;
  cairo_t* context;
};

Canvas::Canvas(int width_px, int height_px) : cairo_(std::make_unique<Cairo>(width_px, height_px)) {
  FillRect({0.0, 0.0, static_cast<double>(width_px), static_cast<double>(height_px)},
           {1.0, 1.0, 1.0});
}

Canvas::~Canvas() = default;

void Canvas::BeginClip(const Rect& rect) {
  cairo_save(cairo_->context);
  cairo_rectangle(cairo_->context, rect.x, rect.y, rect.width, rect.height);
  cairo_clip(cairo_->context);
}

void Canvas::EndClip() {
  cairo_restore(cairo_->context);
}

void Canvas::UsePen(const Pen& pen) {
  constexpr double kDash_px[] = {5.0, 4.0};
  cairo_t* context = cairo_->context;
  cairo_set_source_rgba(
      context, pen.colour.red, pen.colour.green, pen.colour.blue, pen.colour.opacity);
  cairo_set_line_width(context, pen.width_px);
  cairo_set_line_join(context, CAIRO_LINE_JOIN_ROUND);
  cairo_set_dash(context, kDash_px, pen.is_dashed ? 2 : 0, 0.0);
}

void Canvas::FillRect(const Rect& rect, const Colour& colour) {
  UsePen({colour});
  cairo_rectangle(cairo_->context, rect.x, rect.y, rect.width, rect.height);
  cairo_fill(cairo_->context);
}

void Canvas::StrokeRect(const Rect& rect, const Pen& pen) {
  UsePen(pen);
  cairo_rectangle(cairo_->context, rect.x, rect.y, rect.width, rect.height);
  cairo_stroke(cairo_->context);
}

void Canvas::Trace(std::span<const Eigen::Vector2d> polygon) {
  cairo_new_path(cairo_->context);
  for (const Eigen::Vector2d& vertex : polygon) {
    const Eigen::Vector2d p = Tame(vertex);
    cairo_line_to(cairo_->context, p.x(), p.y());
  }
  cairo_close_path(cairo_->context);
}

void Canvas::FillPolygon(std::span<const Eigen::Vector2d> polygon, const Colour& colour) {
  if (polygon.size() < 3 || !AreFinite(polygon)) return;
  UsePen({colour});
  Trace(polygon);
  cairo_fill(cairo_->context);
}

void Canvas::StrokePolygon(std::span<const Eigen::Vector2d> polygon, const Pen& pen) {
  if (polygon.size() < 2 || !AreFinite(polygon)) return;
  UsePen(pen);
  Trace(polygon);
  cairo_stroke(cairo_->context);
}

void Canvas::StrokeLine(const Eigen::Vector2d& from, const Eigen::Vector2d& to, const Pen& pen) {
  const Eigen::Vector2d ends[] = {from, to};
  StrokePolygon(ends, pen);
}

void Canvas::FillCircle(const Eigen::Vector2d& center, double radius_px, const Colour& colour) {
  if (!center.allFinite() || Tame(center) != center) return;
  UsePen({colour});
  cairo_new_path(cairo_->context);
  cairo_arc(cairo_->context, center.x(), center.y(), radius_px, 0.0, 2.0 * M_PI);
  cairo_fill(cairo_->context);
}

void Canvas::Dots(std::span<const Eigen::Vector2f> centers,
                  const Colour& colour,
                  int size_px,
                  const Rect& clip) {
  cairo_surface_flush(cairo_->surface);
  unsigned char* data = cairo_image_surface_get_data(cairo_->surface);
  if (data == nullptr) return;
  const int stride = cairo_image_surface_get_stride(cairo_->surface);
  const auto left = static_cast<float>(clip.x);
  const auto top = static_cast<float>(clip.y);
  const auto right = static_cast<float>(clip.x + clip.width - size_px);
  const auto bottom = static_cast<float>(clip.y + clip.height - size_px);
  const float half = 0.5F * static_cast<float>(size_px);
  for (const Eigen::Vector2f& center : centers) {
    const float x = std::floor(center.x() - half + 0.5F);
    const float y = std::floor(center.y() - half + 0.5F);
    if (!(x >= left && x <= right && y >= top && y <= bottom)) continue;
    for (int row = 0; row < size_px; ++row) {
      unsigned char* pixel = data + (static_cast<int>(y) + row) * stride + static_cast<int>(x) * 4;
      for (int column = 0; column < size_px; ++column, pixel += 4) {
        std::uint32_t value = 0;  // 0x00RRGGBB in the machine's byte order.
        std::memcpy(&value, pixel, 4);
        const auto channel = [&](unsigned shift, double above) {
          const auto below = static_cast<std::uint8_t>(value >> shift);
          return static_cast<std::uint32_t>(Blend(below, above, colour.opacity)) << shift;
        };
        value = channel(16, colour.red) | channel(8, colour.green) | channel(0, colour.blue);
        std::memcpy(pixel, &value, 4);
      }
    }
  }
  cairo_surface_mark_dirty(cairo_->surface);
}

void Canvas::UseStyle(const TextStyle& style) {
  cairo_select_font_face(cairo_->context,
                         "sans-serif",
                         CAIRO_FONT_SLANT_NORMAL,
                         style.is_bold ? CAIRO_FONT_WEIGHT_BOLD : CAIRO_FONT_WEIGHT_NORMAL);
  cairo_set_font_size(cairo_->context, style.size_px);
}

double Canvas::TextWidth(const std::string& text, const TextStyle& style) {
  UseStyle(style);
  cairo_text_extents_t extents;
  cairo_text_extents(cairo_->context, Printable(text).c_str(), &extents);
  return extents.x_advance;
}

std::string Canvas::Shorten(const std::string& text, const TextStyle& style, double max_width_px) {
  // No line that fits is longer; keeps the work bounded for a text of any size.
  constexpr std::size_t kLongest = 400;
  std::string rest = Printable(text.substr(0, kLongest));
  if (text.size() <= kLongest && TextWidth(rest, style) <= max_width_px) return rest;
  while (!rest.empty() && TextWidth(rest + "\u2026", style) > max_width_px) {
    while (!rest.empty() && (static_cast<unsigned char>(rest.back()) & 0xC0U) == 0x80U) {
      rest.pop_back();
    }
    if (!rest.empty()) rest.pop_back();
  }
  return rest + "\u2026";
}

void Canvas::Text(const std::string& text,
                  const Eigen::Vector2d& left_base,
                  const TextStyle& style) {
  cairo_t* context = cairo_->context;
  UseStyle(style);
  cairo_new_path(context);
  cairo_move_to(context, left_base.x(), left_base.y());
  cairo_text_path(context, Printable(text).c_str());
  if (style.has_halo) {
    UsePen({{1.0, 1.0, 1.0, 0.85}, 3.0});
    cairo_stroke_preserve(context);
  }
  UsePen({style.colour});
  cairo_fill(context);
}

std::vector<unsigned char> Canvas::EncodePng() {
  std::vector<unsigned char> bytes;
  cairo_status_t status = cairo_status(cairo_->context);
  if (status == CAIRO_STATUS_SUCCESS) {
    status = cairo_surface_write_to_png_stream(cairo_->surface, AppendBytes, &bytes);
  }
  if (status != CAIRO_STATUS_SUCCESS) {
    throw std::runtime_error(std::string("cannot draw the picture: ") +
                             cairo_status_to_string(status));
  }
  return bytes;
}

}  // namespace clearway::plot
