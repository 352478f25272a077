// SPDX-License-Identifier: BSD-3-Clause
#include "common/messages/encoding.hpp"

#include <cstring>
#include <random>

#include <gtest/gtest.h>

#include "common/messages/channels.hpp"

namespace clearway::messages {
namespace {

lidar_points_t SomePoints() {
  lidar_points_t message{};
  message.sensor = "front";
  message.n = 3;
  message.x = {1.0F, 2.0F, 3.0F};
  message.y = message.x;
  message.z = message.x;
  message.intensity = {1, 2, 3};
  message.tag = {0, 0, 0};
  message.time_offset_us = {0, 10, 20};
  return message;
}

status_t SomeStatus() {
  status_t message{};
  message.process = "preprocessor";
  message.text = "works";
  message.counters.resize(2);
  message.n = 2;
  return message;
}

TEST(EncodingTest, ADecodedMessageEncodesToTheSameBytes) {
  const auto bytes = Encode(SomePoints());

  const auto decoded = Decode<lidar_points_t>(bytes);

  ASSERT_TRUE(decoded.has_value());
  EXPECT_EQ(Encode(*decoded), bytes);
}

TEST(EncodingTest, AStringWithANulInsideEndsThereAndTheMessageStaysWhole) {
  status_t message = SomeStatus();
  message.text = std::string("works\0not", 9);

  const auto decoded = Decode<status_t>(Encode(message));

  ASSERT_TRUE(decoded.has_value());
  EXPECT_EQ(decoded->text, "works");
  EXPECT_EQ(decoded->n, message.n);
}

TEST(EncodingTest, RefusesAnotherTypesMessageAndLeftOverBytes) {
  auto bytes = Encode(SomePoints());

  EXPECT_FALSE(Decode<status_t>(bytes).has_value());
  bytes.push_back(std::byte{0});
  EXPECT_FALSE(Decode<lidar_points_t>(bytes).has_value());
}

template <typename Message>
void ExpectEveryTruncationIsRefused(const Message& message) {
  const auto bytes = Encode(message);
  for (std::size_t size = 0; size < bytes.size(); ++size) {
    // A copy of its own, so that the address sanitizer sees a read beyond the end.
    const std::vector<std::byte> cut(bytes.begin(),
                                     bytes.begin() + static_cast<std::ptrdiff_t>(size));
    EXPECT_FALSE(Decode<Message>(cut).has_value()) << size;
  }
}

TEST(EncodingTest, RefusesEveryTruncation) {
  ExpectEveryTruncationIsRefused(SomePoints());
  ExpectEveryTruncationIsRefused(SomeStatus());
}

// Offset of the length field that counts the points: everything before the arrays.
constexpr std::size_t kArrayBytes = 3 * (3 * 4 + 1 + 1 + 4);

TEST(EncodingTest, RefusesLengthsThatTheMessageCannotHold) {
  for (const std::uint32_t length :
       {0xFFFFFFFFU, 0x80000000U, 0x40000000U, 0x20000000U, 0x7FFFFFFFU, 4U, 100U}) {
    auto bytes = Encode(SomePoints());
    const std::size_t at = bytes.size() - kArrayBytes - 4;
    for (std::size_t i = 0; i < 4; ++i) {
      bytes[at + i] = static_cast<std::byte>(length >> (24 - 8 * i));
    }

    EXPECT_FALSE(Decode<lidar_points_t>(bytes).has_value()) << length;
  }
}

TEST(EncodingTest, NoFlippedBitsCrashTheDecoder) {
  std::mt19937 random(20240517);
  const auto original = Encode(SomeStatus());
  for (int round = 0; round < 20000; ++round) {
    auto bytes = original;
    for (int flips = 0; flips < 3; ++flips) {
      bytes[8 + random() % (bytes.size() - 8)] ^= static_cast<std::byte>(1U << (random() % 8));
    }

    const auto decoded = Decode<status_t>(bytes);

    if (decoded) {
      EXPECT_LE(decoded->text.size(), bytes.size());
    }
  }
}

}  // namespace
}  // namespace clearway::messages
