// SPDX-License-Identifier: BSD-3-Clause
// Any bytes as a PCD file: read as a whole, or refused with one line.
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <string_view>

#include "common/io/pcd_reader.hpp"

namespace {

void Require(bool holds) {
  if (!holds) std::abort();
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view bytes(reinterpret_cast<const char*>(data), size);
  try {
    const clearway::io::PcdFile file = clearway::io::ParsePcd(bytes, "fuzz.pcd", 255.0);
    const std::size_t points = file.cloud.size();
    Require(file.cloud.y.size() == points && file.cloud.z.size() == points);
    Require(file.cloud.intensity.size() == points && file.cloud.tag.size() == points);
    Require(file.cloud.time_offset_us.size() == points);
    Require(file.width * file.height == points);
  } catch (const clearway::io::ReadError& error) {
    const std::string_view message = error.what();
    Require(message.substr(0, 9) == "fuzz.pcd:");
    for (const char letter : message) Require(letter >= ' ' && letter <= '~');
  }
  return 0;
}
