// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdint>
#include <initializer_list>
#include <utility>

namespace clearway::plot {

/// Parts of a picture of a scan that can be left out.
enum class Layer : std::uint8_t {
  kRaw,
  kFloor,
  kRemovedByMap,
  kOutliers,
  kObstacles,
  kDetections,
  kMap,
  kCorridor,
  kLabels,
};

/// As the command line calls them.
inline constexpr std::array<std::pair<const char*, Layer>, 9> kLayerNames = {{
    {"raw", Layer::kRaw},
    {"floor", Layer::kFloor},
    {"removed_by_map", Layer::kRemovedByMap},
    {"outliers", Layer::kOutliers},
    {"obstacles", Layer::kObstacles},
    {"detections", Layer::kDetections},
    {"map", Layer::kMap},
    {"corridor", Layer::kCorridor},
    {"labels", Layer::kLabels},
}};

/// Some of the layers; none at first.
class LayerSet {
 public:
  constexpr LayerSet() = default;
  constexpr LayerSet(std::initializer_list<Layer> layers) {
    for (const Layer layer : layers) Add(layer);
  }

  constexpr void Add(Layer layer) { bits_ |= Bit(layer); }
  constexpr void Remove(Layer layer) { bits_ &= ~Bit(layer); }
  [[nodiscard]] constexpr bool Contains(Layer layer) const { return (bits_ & Bit(layer)) != 0; }

  friend constexpr bool operator==(const LayerSet&, const LayerSet&) = default;

 private:
  static constexpr std::uint32_t Bit(Layer layer) {
    return std::uint32_t{1} << static_cast<unsigned>(layer);
  }

  std::uint32_t bits_ = 0;
};

}  // namespace clearway::plot
