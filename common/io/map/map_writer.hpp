// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>

#include "common/core/mapping/occupancy_grid.hpp"

namespace clearway::io {

// What SaveMap() makes of a cell, 0..100.
inline constexpr int kLeastOccupied = 65;  ///< Occupied from here.
inline constexpr int kMostFree = 19;       ///< Free up to here; unknown between them.

/// Writes a trinary Nav2 map as map_saver does: a raw PGM image (0 occupied, 254 free, 205
/// unknown) beside the YAML file, with its name but for the ending `.pgm`, and the YAML file
/// itself. LoadMap() gives back the same geometry, bit by bit, and the same cells, each free,
/// occupied or unknown.
///
/// Each file is written under a temporary name in the same folder, brought to the disk and renamed:
/// first the image, then the YAML file, so that at no time a YAML file names an image that is not
/// whole. Replacing a map by one of another size or place is two renames: who needs more gives the
/// new map a new name.
///
/// Throws std::runtime_error with the file and the system's reason: then no temporary file is left,
/// and each of both files is the old one or the new one. Throws std::invalid_argument when the
/// grid's geometry is not valid, its cells do not fit it, or the YAML file's name ends in `.pgm`.
void SaveMap(const core::OccupancyGrid& grid, const std::filesystem::path& yaml);

}  // namespace clearway::io
