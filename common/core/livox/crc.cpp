// SPDX-License-Identifier: BSD-3-Clause
#include "common/core/livox/crc.hpp"

#include <zlib.h>

namespace clearway::core::livox {

std::uint16_t Crc16(ByteView bytes) {
  constexpr std::uint16_t kSeed = 0x4C49;
  constexpr std::uint16_t kPolynomial = 0x8408;  // 0x1021, lowest bit first.
  std::uint16_t crc = kSeed;
  for (const std::byte byte : bytes) {
    crc = static_cast<std::uint16_t>(crc ^ static_cast<std::uint16_t>(byte));
    for (int bit = 0; bit < 8; ++bit) {
      const bool carry = (crc & 1U) != 0;
      crc = static_cast<std::uint16_t>(crc >> 1U);
      if (carry) crc = static_cast<std::uint16_t>(crc ^ kPolynomial);
    }
  }
  return crc;
}

std::uint32_t Crc32(ByteView bytes) {
  constexpr uLong kSeed = 0x564F580A;
  if (bytes.empty()) return static_cast<std::uint32_t>(kSeed);  // zlib answers 0 to a null pointer.
  return static_cast<std::uint32_t>(crc32_z(
      kSeed, reinterpret_cast<const Bytef*>(bytes.data()), static_cast<z_size_t>(bytes.size())));
}

}  // namespace clearway::core::livox
