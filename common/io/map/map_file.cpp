// SPDX-License-Identifier: BSD-3-Clause
#include "common/io/map/map_file.hpp"

#include <cstdlib>
#include <string>
#include <system_error>

#include "common/io/file_bytes.hpp"

namespace clearway::io {
namespace {

std::string ReadYamlBytes(const std::filesystem::path& yaml) {
  std::error_code error;
  const std::uintmax_t size = std::filesystem::file_size(yaml, error);
  if (!error && size > kMaxMapYamlBytes) {
    throw ErrorInFile(yaml.string(),
                      "has " + std::to_string(size) +
                          " bytes: expected the YAML file of a map, at most " +
                          std::to_string(kMaxMapYamlBytes));
  }
  return ReadFileBytes(yaml);
}

std::filesystem::path ImagePath(const std::filesystem::path& yaml, const MapDescription& map) {
  if (!map.image.starts_with("~/")) return yaml.parent_path() / map.image;
  const char* home = std::getenv("HOME");
  if (home == nullptr || *home == '\0') {
    throw ErrorInLine(
        yaml.string(),
        map.image_line,
        "image " + Quoted(map.image) + ": $HOME is not set: expected a path that does not need it");
  }
  return std::filesystem::path(home) / map.image.substr(2);
}

}  // namespace

LoadedMap LoadMap(const std::filesystem::path& yaml) {
  LoadedMap map;
  map.description = ParseMapYaml(ReadYamlBytes(yaml), yaml.string());
  map.image_path = ImagePath(yaml, map.description);
  try {
    const MapImage image = ParseMapImage(ReadFileBytes(map.image_path), map.image_path.string());
    map.grid = ToGrid(image, map.description);
  } catch (const ReadError& error) {
    throw ErrorInLine(yaml.string(),
                      map.description.image_line,
                      "image " + Quoted(map.description.image) + ": " + error.what());
  }
  return map;
}

}  // namespace clearway::io
