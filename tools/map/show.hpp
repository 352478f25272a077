// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <string>

#include "common/io/map/map_file.hpp"

namespace clearway::map_tool {

/// Size, resolution, origin, mode and counts of cells as JSON.
[[nodiscard]] std::string FormatJson(const io::LoadedMap& map);

/// The same as one line for people.
[[nodiscard]] std::string FormatLine(const io::LoadedMap& map);

/// Draws the map as a PNG. Throws std::runtime_error when it cannot be written.
void DrawMap(const io::LoadedMap& map,
             const std::filesystem::path& yaml,
             const std::filesystem::path& output);

}  // namespace clearway::map_tool
