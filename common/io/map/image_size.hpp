// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <string>

#include "common/core/mapping/occupancy_grid.hpp"

namespace clearway::io {

/// What is wrong with the size that an image's header states, empty when nothing is.
/// @pre both are at most 2^32.
[[nodiscard]] inline std::string SizeProblem(std::uint64_t width, std::uint64_t height) {
  constexpr auto kMax = static_cast<std::uint64_t>(core::GridGeometry::kMaxCells);
  if (width >= 1 && height >= 1 && width <= kMax && height <= kMax && width * height <= kMax) {
    return {};
  }
  return std::to_string(width) + " x " + std::to_string(height) +
         " pixels: expected at least 1 x 1 and at most " + std::to_string(kMax) + " pixels";
}

}  // namespace clearway::io
