// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <memory>
#include <vector>

#include <cairo.h>

#include "tools/plot/canvas.hpp"

namespace clearway::test {

/// The pixels of a PNG file, row by row from the top, as 0xRRGGBB; 0 x 0 when it cannot be read.
struct PngPixels {
  int width = 0;
  int height = 0;
  std::vector<std::uint32_t> colours;

  [[nodiscard]] std::uint32_t At(int x, int y) const {
    return colours[static_cast<std::size_t>(y) * static_cast<std::size_t>(width) +
                   static_cast<std::size_t>(x)];
  }

  /// Pixels of a colour within a rectangle; each channel may differ by the tolerance.
  [[nodiscard]] std::size_t Count(std::uint32_t colour,
                                  const plot::Rect& rect,
                                  int tolerance = 0) const {
    std::size_t count = 0;
    for (int y = static_cast<int>(rect.y); y < static_cast<int>(rect.y + rect.height); ++y) {
      for (int x = static_cast<int>(rect.x); x < static_cast<int>(rect.x + rect.width); ++x) {
        bool is_near = true;
        for (const unsigned shift : {0U, 8U, 16U}) {
          const auto channel = [shift](std::uint32_t code) {
            return static_cast<int>(code >> shift & 0xFFU);
          };
          is_near &= std::abs(channel(At(x, y)) - channel(colour)) <= tolerance;
        }
        if (is_near) ++count;
      }
    }
    return count;
  }
};

/// A colour, blended over another.
inline plot::Colour Over(const plot::Colour& above, const plot::Colour& below) {
  const auto blend = [&](double a, double b) {
    return a * above.opacity + b * (1.0 - above.opacity);
  };
  return {
      blend(above.red, below.red), blend(above.green, below.green), blend(above.blue, below.blue)};
}

/// An opaque colour as a picture holds it.
inline std::uint32_t ColourCode(const plot::Colour& colour) {
  const auto byte = [](double share) { return static_cast<std::uint32_t>(255.0 * share + 0.5); };
  return byte(colour.red) * 65536U + byte(colour.green) * 256U + byte(colour.blue);
}

inline PngPixels ReadPng(const std::filesystem::path& path) {
  const std::unique_ptr<cairo_surface_t, decltype(&cairo_surface_destroy)> surface(
      cairo_image_surface_create_from_png(path.c_str()), cairo_surface_destroy);
  PngPixels pixels;
  if (cairo_surface_status(surface.get()) != CAIRO_STATUS_SUCCESS) return pixels;
  pixels.width = cairo_image_surface_get_width(surface.get());
  pixels.height = cairo_image_surface_get_height(surface.get());
  const int stride = cairo_image_surface_get_stride(surface.get());
  const unsigned char* data = cairo_image_surface_get_data(surface.get());
  for (int y = 0; y < pixels.height; ++y) {
    for (int x = 0; x < pixels.width; ++x) {
      std::uint32_t value = 0;  // 0x00RRGGBB in the machine's byte order.
      std::memcpy(&value, data + y * stride + 4 * x, 4);
      pixels.colours.push_back(value & 0xFFFFFFU);
    }
  }
  return pixels;
}

}  // namespace clearway::test
