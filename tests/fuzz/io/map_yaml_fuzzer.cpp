// SPDX-License-Identifier: BSD-3-Clause
// Any bytes as the YAML file of a map: a description within its bounds, or problems of one line
// each that begin with the file.
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <string_view>

#include "common/io/map/map_yaml.hpp"

namespace {

void Require(bool holds) {
  if (!holds) std::abort();
}

void RequireMessage(std::string_view message) {
  while (!message.empty()) {
    const std::string_view line = message.substr(0, message.find('\n'));
    Require(line.substr(0, 10) == "fuzz.yaml:");
    for (const char letter : line) Require(letter >= ' ' && letter <= '~');
    message.remove_prefix(line.size());
    if (!message.empty()) message.remove_prefix(1);
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view bytes(reinterpret_cast<const char*>(data), size);
  try {
    const clearway::io::MapDescription map = clearway::io::ParseMapYaml(bytes, "fuzz.yaml");
    Require(!map.image.empty() && map.image_line > 0);
    Require(std::isfinite(map.resolution_m) && map.resolution_m > 0.0);
    for (const double value : map.origin) Require(std::isfinite(value));
    Require(map.free_threshold >= 0.0 && map.free_threshold <= map.occupied_threshold);
    Require(map.occupied_threshold <= 1.0);
  } catch (const clearway::io::ReadError& error) {
    RequireMessage(error.what());
  }
  return 0;
}
