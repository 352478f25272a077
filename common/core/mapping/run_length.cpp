// SPDX-License-Identifier: BSD-3-Clause
#include "common/core/mapping/run_length.hpp"

#include <algorithm>

#include <zlib.h>

namespace clearway::core {
namespace {

constexpr std::size_t kMaxRun = 255;

// Length of the run that starts at `first`, at most kMaxRun.
std::size_t RunLength(std::span<const std::uint8_t> cells, std::size_t first) {
  const std::size_t end = std::min(cells.size(), first + kMaxRun);
  std::size_t last = first + 1;
  while (last < end && cells[last] == cells[first]) ++last;
  return last - first;
}

}  // namespace

std::vector<std::uint8_t> EncodeRuns(std::span<const std::uint8_t> cells) {
  std::vector<std::uint8_t> bytes;
  for (std::size_t i = 0; i < cells.size();) {
    const std::size_t length = RunLength(cells, i);
    bytes.push_back(static_cast<std::uint8_t>(length));
    bytes.push_back(cells[i]);
    i += length;
  }
  return bytes;
}

std::size_t EncodedSize(std::span<const std::uint8_t> cells) {
  std::size_t size = 0;
  for (std::size_t i = 0; i < cells.size(); i += RunLength(cells, i)) size += 2;
  return size;
}

std::optional<std::vector<std::uint8_t>> DecodeRuns(std::span<const std::uint8_t> bytes,
                                                    std::size_t num_cells) {
  if (bytes.size() % 2 != 0) return std::nullopt;
  std::size_t total = 0;
  for (std::size_t i = 0; i < bytes.size(); i += 2) {
    if (bytes[i] == 0) return std::nullopt;
    total += bytes[i];
  }
  if (total != num_cells) return std::nullopt;  // Before anything is allocated.

  std::vector<std::uint8_t> cells;
  cells.reserve(num_cells);
  for (std::size_t i = 0; i < bytes.size(); i += 2)
    cells.insert(cells.end(), bytes[i], bytes[i + 1]);
  return cells;
}

std::uint32_t Checksum(std::span<const std::uint8_t> cells) {
  return static_cast<std::uint32_t>(crc32_z(crc32_z(0, nullptr, 0), cells.data(), cells.size()));
}

}  // namespace clearway::core
