// SPDX-License-Identifier: BSD-3-Clause
// Any bytes as the image of a map: read as a whole and turned into cells in every mode, or refused
// with one line. A PNG file is tried as it is and with its chunks' checksums mended, since random
// changes would hardly ever pass them.
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <string>
#include <string_view>

#include "common/io/map/map_file.hpp"

namespace {

using clearway::io::MapDescription;
using clearway::io::MapImage;
using clearway::io::MapMode;

constexpr std::size_t kSignatureBytes = 8;
constexpr std::size_t kMaxPixels = 1'000'000;

void Require(bool holds) {
  if (!holds) std::abort();
}

std::uint32_t Load(const std::string& file, std::size_t at) {
  std::uint32_t value = 0;
  for (std::size_t i = at; i < at + 4; ++i) {
    value = (value << 8U) | static_cast<unsigned char>(file[i]);
  }
  return value;
}

// CRC-32 of a chunk's type and data (PNG specification, annex D).
std::uint32_t ChecksumOf(std::string_view bytes) {
  std::uint32_t crc = ~0U;
  for (const char byte : bytes) {
    crc ^= static_cast<unsigned char>(byte);
    for (int bit = 0; bit < 8; ++bit) crc = (crc >> 1U) ^ ((crc & 1U) != 0U ? 0xedb88320U : 0U);
  }
  return ~crc;
}

std::string WithMendedChecksums(std::string file) {
  std::size_t at = kSignatureBytes;
  while (at + 12 <= file.size()) {
    const std::size_t length = Load(file, at);
    if (length > file.size() - at - 12) break;
    const std::uint32_t crc = ChecksumOf(std::string_view(file).substr(at + 4, length + 4));
    for (std::size_t i = 0; i < 4; ++i) {
      file[at + 8 + length + i] = static_cast<char>(crc >> (24U - 8U * static_cast<unsigned>(i)));
    }
    at += 12 + length;
  }
  return file;
}

// A small PNG file may rightly hold a very large image: slow, and not what is looked for here.
bool IsLarge(const std::string& file) {
  constexpr std::size_t kWidth = 16;
  constexpr std::size_t kHeight = 20;
  if (file.size() < kHeight + 4 || file.compare(1, 3, "PNG") != 0) return false;
  return std::size_t{1} * Load(file, kWidth) * Load(file, kHeight) > kMaxPixels;
}

void CheckCells(const MapImage& image) {
  MapDescription description;
  description.resolution_m = 0.05;
  for (const MapMode mode : {MapMode::kTrinary, MapMode::kScale, MapMode::kRaw}) {
    description.mode = mode;
    description.negate = image.width % 2 == 0;
    const auto grid = clearway::io::ToGrid(image, description);
    Require(grid.geometry.IsValid() && grid.cells.size() == grid.geometry.num_cells());
    Require(std::all_of(grid.cells.begin(), grid.cells.end(), [](std::uint8_t cell) {
      return cell <= 100 || cell == 255;
    }));
  }
}

void Check(const std::string& file) {
  try {
    const MapImage image = clearway::io::ParseMapImage(file, "fuzz.png");
    Require(image.width > 0 && image.height > 0);
    Require(std::size_t{1} * static_cast<std::size_t>(image.width) *
                static_cast<std::size_t>(image.height) ==
            image.num_pixels());
    Require(image.opacity.empty() || image.opacity.size() == image.num_pixels());
    for (const std::uint16_t value : image.brightness) Require(value <= image.full_scale);
    CheckCells(image);
  } catch (const clearway::io::ReadError& error) {
    const std::string_view message = error.what();
    Require(message.substr(0, 9) == "fuzz.png:");
    for (const char letter : message) Require(letter >= ' ' && letter <= '~');
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string file(reinterpret_cast<const char*>(data), size);
  if (IsLarge(file)) return -1;
  Check(file);
  if (size > 4 && file.compare(1, 3, "PNG") == 0) Check(WithMendedChecksums(file));
  return 0;
}
