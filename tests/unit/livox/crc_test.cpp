// SPDX-License-Identifier: BSD-3-Clause
#include "common/core/livox/crc.hpp"

#include <gtest/gtest.h>

#include "tests/unit/livox/protocol_maker.hpp"

namespace clearway::core::livox {
namespace {

TEST(LivoxCrc, HasTheCheckValuesOfTheVendorsCode) {
  const Bytes digits = test::FromText("123456789");
  const Bytes zero(1);

  EXPECT_EQ(Crc16(digits), 0xAB4E);
  EXPECT_EQ(Crc32(digits), 0xB08DB5B1U);
  EXPECT_EQ(Crc16({}), 0x4C49);
  EXPECT_EQ(Crc32({}), 0x564F580AU);
  EXPECT_EQ(Crc16(zero), 0xDF89);
  EXPECT_EQ(Crc32(zero), 0x328149CBU);
}

TEST(LivoxCrc, OfAHeaderWithItsOwnChecksumIsZero) {
  const Bytes header = test::FromHex("aa 01 0f 00 00 03 00 6c fd");

  EXPECT_EQ(Crc16(header), 0);
}

// Oracle: the CRC-32 that shifts one bit at a time.
TEST(LivoxCrc, AgreesWithABitwiseCrc32) {
  std::mt19937 random(1);
  for (std::size_t size = 0; size < 300; ++size) {
    const Bytes bytes = test::RandomBytes(random, size);
    std::uint32_t expected = ~0x564F580AU;
    for (const std::byte byte : bytes) {
      expected ^= static_cast<std::uint32_t>(byte);
      for (int bit = 0; bit < 8; ++bit) {
        expected = (expected >> 1U) ^ ((expected & 1U) != 0 ? 0xEDB88320U : 0U);
      }
    }

    EXPECT_EQ(Crc32(bytes), ~expected) << size;
  }
}

}  // namespace
}  // namespace clearway::core::livox
