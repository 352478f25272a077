// SPDX-License-Identifier: BSD-3-Clause
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "common/io/map/map_file.hpp"

namespace clearway::io {
namespace {

using core::OccupancyGrid;

// The rules for one pixel.
class CellRule {
 public:
  explicit CellRule(const MapDescription& description) : description_(description) {}

  // `opacity` is 0..1.
  [[nodiscard]] std::uint8_t With(double shade, double opacity) const {
    switch (description_.mode) {
      case MapMode::kTrinary:
        return opacity > 0.0 ? Trinary((3.0 * shade + opacity) / 4.0) : OccupancyGrid::kUnknown;
      case MapMode::kScale:
        return opacity < 1.0 ? OccupancyGrid::kUnknown : Scale(shade);
      case MapMode::kRaw:
        return Raw(shade);
    }
    return OccupancyGrid::kUnknown;
  }

  // Of an image without an opacity channel.
  [[nodiscard]] std::uint8_t Without(double shade) const {
    switch (description_.mode) {
      case MapMode::kTrinary:
        return Trinary(shade);
      case MapMode::kScale:
        return Scale(shade);
      case MapMode::kRaw:
        return Raw(shade);
    }
    return OccupancyGrid::kUnknown;
  }

 private:
  [[nodiscard]] double Occupancy(double shade) const {
    return description_.negate ? shade : 1.0 - shade;
  }

  [[nodiscard]] std::uint8_t Trinary(double shade) const {
    const double occupancy = Occupancy(shade);
    if (occupancy > description_.occupied_threshold) return OccupancyGrid::kOccupied;
    if (occupancy < description_.free_threshold) return OccupancyGrid::kFree;
    return OccupancyGrid::kUnknown;
  }

  [[nodiscard]] std::uint8_t Scale(double shade) const {
    const std::uint8_t outside = Trinary(shade);
    const double range = description_.occupied_threshold - description_.free_threshold;
    if (outside != OccupancyGrid::kUnknown || !(range > 0.0)) return outside;
    const double share = (Occupancy(shade) - description_.free_threshold) / range;
    return static_cast<std::uint8_t>(std::rint(share * 100.0));
  }

  [[nodiscard]] static std::uint8_t Raw(double shade) {
    const double value = std::round(shade * 255.0);
    return value <= OccupancyGrid::kOccupied ? static_cast<std::uint8_t>(value)
                                             : OccupancyGrid::kUnknown;
  }

  const MapDescription& description_;
};

// The cells in the order of the image's pixels.
class PixelCells {
 public:
  PixelCells(const MapImage& image, const MapDescription& description)
      : image_(image), rule_(description) {
    if (!image.opacity.empty()) return;
    // Each brightness is worked out once.
    table_.resize(std::size_t{image.full_scale} + 1);
    for (std::size_t i = 0; i < table_.size(); ++i) table_[i] = rule_.Without(Shade(i));
  }

  [[nodiscard]] std::uint8_t At(std::size_t pixel) const {
    const std::uint16_t brightness = image_.brightness[pixel];
    if (!table_.empty()) return table_[brightness];
    return rule_.With(Shade(brightness),
                      static_cast<double>(image_.opacity[pixel]) / MapImage::kOpaque);
  }

 private:
  [[nodiscard]] double Shade(std::size_t brightness) const {
    return static_cast<double>(brightness) / image_.full_scale;
  }

  const MapImage& image_;
  CellRule rule_;
  std::vector<std::uint8_t> table_;
};

}  // namespace

OccupancyGrid ToGrid(const MapImage& image, const MapDescription& description) {
  OccupancyGrid grid;
  grid.geometry = {.width = image.width,
                   .height = image.height,
                   .resolution_m = description.resolution_m,
                   .origin_x_m = description.origin[0],
                   .origin_y_m = description.origin[1],
                   .origin_yaw_rad = description.origin[2]};
  grid.cells.reserve(image.num_pixels());
  const PixelCells cells(image, description);
  const auto width = static_cast<std::size_t>(image.width);
  for (std::size_t line = image.num_pixels(); line > 0; line -= width) {
    for (std::size_t pixel = line - width; pixel < line; ++pixel) {
      grid.cells.push_back(cells.At(pixel));
    }
  }
  return grid;
}

}  // namespace clearway::io
