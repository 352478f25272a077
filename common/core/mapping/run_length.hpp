// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace clearway::core {

/// Cells as pairs of bytes (count 1..255, value). O(n).
[[nodiscard]] std::vector<std::uint8_t> EncodeRuns(std::span<const std::uint8_t> cells);

/// Bytes that EncodeRuns() would give, without making them. O(n).
[[nodiscard]] std::size_t EncodedSize(std::span<const std::uint8_t> cells);

/// The cells of EncodeRuns(). Nothing when the bytes are not pairs, a count is 0, or they do not
/// give exactly `num_cells` cells. Never allocates more than num_cells.
[[nodiscard]] std::optional<std::vector<std::uint8_t>> DecodeRuns(
    std::span<const std::uint8_t> bytes,
    std::size_t num_cells);

/// CRC-32 (IEEE 802.3, as zlib) of cells.
[[nodiscard]] std::uint32_t Checksum(std::span<const std::uint8_t> cells);

}  // namespace clearway::core
