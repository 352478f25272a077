// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include "common/io/read_error.hpp"

namespace clearway::io {

/// How the pixels of a map's image become cells: see ToGrid().
enum class MapMode {
  kTrinary,
  kScale,
  kRaw,
};

/// As in the YAML file: "trinary", "scale" or "raw".
[[nodiscard]] const char* NameOf(MapMode mode);

/// What the YAML file of a map says.
struct MapDescription {
  std::string image;                 ///< As written; relative to the YAML file's folder.
  std::size_t image_line = 0;        ///< Where it is written, for messages; 0: nowhere.
  double resolution_m = 0.0;         ///< Side of a pixel [m], above 0.
  std::array<double, 3> origin{};    ///< Lower left corner of the image in map: x m, y m, yaw rad.
  bool negate = false;               ///< White is occupied, black is free.
  double occupied_threshold = 0.65;  ///< Occupied above it, 0..1.
  double free_threshold = 0.196;     ///< Free below it, 0..occupied_threshold.
  MapMode mode = MapMode::kTrinary;  ///< Trinary where the file says nothing.
  std::vector<std::string> ignored_keys;  ///< Keys that mean nothing here, in the file's order.
};

/// A longer file is refused: it is no map's, and the parser's time grows with it.
inline constexpr std::size_t kMaxMapYamlBytes = 65'536;

/// Reads the YAML file of a Nav2 or ROS map: image, resolution, origin, negate, occupied_thresh,
/// free_thresh, and mode, which may be missing. Other keys are noted and ignored. `name` is the
/// file for messages. Throws ReadError with all problems, one line each: the file and its line, the
/// key, the value and what is allowed.
[[nodiscard]] MapDescription ParseMapYaml(std::string_view text, const std::string& name);

}  // namespace clearway::io
