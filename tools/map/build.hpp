// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <filesystem>
#include <string>

#include "common/core/mapping/map_builder.hpp"

namespace clearway::map_tool {

/// What `clearway-map build` is asked for.
struct BuildSettings {
  std::filesystem::path log;     ///< Holds LOCAL_MAP.
  std::filesystem::path output;  ///< The YAML file; the image goes beside it.
  std::string channel_prefix;
  core::MapBuilderConfig rules;
  double wall_depth_m = 0.15;  ///< See core::WithWallDepth().
};

/// What came of it.
struct BuildReport {
  std::size_t scans = 0;           ///< With at least one usable slice of LOCAL_MAP.
  std::size_t slices_invalid = 0;  ///< Do not decode, or break a rule of the type.
  std::size_t slices_refused = 0;  ///< Of another resolution, or too far away.
  std::size_t cells_deepened = 0;  ///< Unknown ones that the wall depth made occupied.
  core::OccupancyGrid map;
};

/// Builds a map from the LOCAL_MAPs of a log. Throws io::ReadError when the log cannot be read or
/// holds none that could be used, with what to do about it.
[[nodiscard]] BuildReport BuildMap(const BuildSettings& settings);

/// What a person reads about it.
[[nodiscard]] std::string Describe(const BuildReport& report);

}  // namespace clearway::map_tool
