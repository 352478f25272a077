// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>

#include "common/core/livox/little_endian.hpp"

namespace clearway::core::livox {

/// CRC of a control frame's first seven bytes: CRC-16/MCRF4XX (polynomial 0x1021, reflected) that
/// starts with 0x4C49 ("IL"). Crc16("123456789") = 0xAB4E. O(n).
[[nodiscard]] std::uint16_t Crc16(ByteView bytes);

/// CRC of a whole control frame: the CRC-32 of zlib, carried on from 0x564F580A ("\nXOV").
/// Crc32("123456789") = 0xB08DB5B1. O(n).
[[nodiscard]] std::uint32_t Crc32(ByteView bytes);

}  // namespace clearway::core::livox
