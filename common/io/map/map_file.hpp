// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>

#include "common/core/mapping/occupancy_grid.hpp"
#include "common/io/map/map_image.hpp"
#include "common/io/map/map_yaml.hpp"

namespace clearway::io {

/// A map and where it came from.
struct LoadedMap {
  core::OccupancyGrid grid;
  MapDescription description;
  std::filesystem::path image_path;
};

/// Loads a Nav2 or ROS map: a YAML file and the image that it names, whose path is relative to the
/// YAML file's folder, absolute, or below $HOME when it starts with "~/". All or nothing.
/// Throws ReadError: of the YAML file's problems one line each, else one line.
[[nodiscard]] LoadedMap LoadMap(const std::filesystem::path& yaml);

/// The cells of a map's image by the rules of Nav2's map server (nav2_map_server, map_io.cpp). The
/// image's last line becomes row 0. A pixel's shade, 0 black .. 1 white, is the mean of red, green
/// and blue; how occupied it is, `occ`, is 1 - shade, or the shade itself with negate.
///
/// - Trinary: occupied when occ > occupied_threshold, free when occ < free_threshold, else unknown.
///   If the image has an opacity channel, the mean is taken over four values, opaque counting as
///   white (so in Nav2: the shades of such an image are lighter than they look). Other than in
///   Nav2, where its colour would count, a wholly transparent pixel is unknown.
/// - Scale: unknown unless wholly opaque; 100 when occ > occupied_threshold; 0 when
///   occ < free_threshold; between them linear from 0 to 100, rounded to even. Where both
///   thresholds are equal, occ equal to them is unknown (in Nav2 it is 0/0).
/// - Raw: the shade times 255, rounded, when it is 0..100, else unknown; thresholds, negate and
///   opacity mean nothing.
///
/// @pre the image and the description come from the functions above. O(pixels).
[[nodiscard]] core::OccupancyGrid ToGrid(const MapImage& image, const MapDescription& description);

}  // namespace clearway::io
