// SPDX-License-Identifier: BSD-3-Clause
#include "common/core/livox/control_frame.hpp"

#include <set>
#include <string>

#include <gtest/gtest.h>

#include "common/core/livox/crc.hpp"
#include "tests/unit/livox/protocol_maker.hpp"

namespace clearway::core::livox {
namespace {

Bytes RandomFrame(std::mt19937& random, std::size_t data_bytes, Bytes& data) {
  data = test::RandomBytes(random, data_bytes);
  return PackFrame({.type = static_cast<FrameType>(test::Random(random, 3)),
                    .sequence = static_cast<std::uint16_t>(test::Random(random, 65536)),
                    .command_set = static_cast<std::uint8_t>(test::Random(random, 256)),
                    .command_id = static_cast<std::uint8_t>(test::Random(random, 256)),
                    .data = data});
}

TEST(ControlFrame, ComesBackFromItsBytes) {
  std::mt19937 random(2);
  for (std::size_t data_bytes = 0; data_bytes <= kMaxFrameBytes - kFrameOverhead;
       data_bytes += 13) {
    const Bytes data = test::RandomBytes(random, data_bytes);
    const ControlFrame frame{.type = static_cast<FrameType>(test::Random(random, 3)),
                             .sequence = static_cast<std::uint16_t>(test::Random(random, 65536)),
                             .command_set = static_cast<std::uint8_t>(test::Random(random, 256)),
                             .command_id = static_cast<std::uint8_t>(test::Random(random, 256)),
                             .data = data};

    const Bytes bytes = PackFrame(frame);
    const ParsedFrame parsed = ParseFrame(bytes);

    ASSERT_EQ(parsed.defect, FrameDefect::kNone);
    EXPECT_EQ(parsed.frame->type, frame.type);
    EXPECT_EQ(parsed.frame->sequence, frame.sequence);
    EXPECT_EQ(parsed.frame->command_set, frame.command_set);
    EXPECT_EQ(parsed.frame->command_id, frame.command_id);
    EXPECT_TRUE(
        std::equal(parsed.frame->data.begin(), parsed.frame->data.end(), data.begin(), data.end()));
  }
}

TEST(ControlFrame, WithAnyOneBitFlippedIsRefused) {
  std::mt19937 random(3);
  for (const std::size_t data_bytes : {0U, 1U, 10U, 25U, 120U}) {
    Bytes data;
    Bytes bytes = RandomFrame(random, data_bytes, data);
    for (std::size_t bit = 0; bit < 8 * bytes.size(); ++bit) {
      const auto mask = static_cast<std::byte>(1U << (bit % 8));
      bytes[bit / 8] ^= mask;

      const ParsedFrame parsed = ParseFrame(bytes);

      EXPECT_FALSE(parsed.frame) << "bit " << bit << " of " << bytes.size() << " bytes";
      EXPECT_NE(parsed.defect, FrameDefect::kNone);
      bytes[bit / 8] ^= mask;
    }
  }
}

TEST(ControlFrame, CutShortAnywhereIsRefused) {
  std::mt19937 random(4);
  Bytes data;
  const Bytes bytes = RandomFrame(random, 100, data);
  for (std::size_t size = 0; size < bytes.size(); ++size) {
    const ParsedFrame parsed = ParseFrame(ByteView(bytes).first(size));

    EXPECT_EQ(parsed.defect, size < kFrameOverhead ? FrameDefect::kTooShort : FrameDefect::kLength);
    EXPECT_FALSE(parsed.frame);
  }
}

TEST(ControlFrame, WithBytesBehindItIsRefused) {
  Bytes bytes = test::FromHex("aa 01 0f 00 00 03 00 6c fd 00 03 4c d4 51 41");
  bytes.push_back(std::byte{0});

  EXPECT_EQ(ParseFrame(bytes).defect, FrameDefect::kLength);
}

// One such datagram makes the vendor's programs deaf: their parser waits for 8000 bytes.
TEST(ControlFrame, ThatStatesALengthFarBeyondItsDatagramIsRefused) {
  const Bytes bytes = test::FromHex("aa 01 40 1f 02 00 00 3a b8 00 00");
  Bytes long_enough = bytes;
  long_enough.resize(kFrameOverhead);

  EXPECT_EQ(ParseFrame(bytes).defect, FrameDefect::kTooShort);
  EXPECT_EQ(ParseFrame(long_enough).defect, FrameDefect::kLength);
}

// And this one crashes them: the length of the data becomes negative.
TEST(ControlFrame, ThatStatesALengthBelowThatOfAFrameIsRefused) {
  const Bytes bytes = test::FromHex("aa 01 01 00 02 00 00 04 03 00 00");
  Bytes long_enough = bytes;
  long_enough.resize(kFrameOverhead);

  EXPECT_EQ(ParseFrame(bytes).defect, FrameDefect::kTooShort);
  EXPECT_EQ(ParseFrame(long_enough).defect, FrameDefect::kLength);
}

// A frame whose checksums hold for whatever else is changed.
Bytes WithMendedChecksums(Bytes bytes) {
  Store(std::span(bytes), 7, Crc16(ByteView(bytes).first(7)));
  Store(std::span(bytes), bytes.size() - 4, Crc32(ByteView(bytes).first(bytes.size() - 4)));
  return bytes;
}

TEST(ControlFrame, OfAnotherProtocolIsRefusedWithTheReason) {
  const Bytes good = test::FromHex("aa 01 0f 00 00 03 00 6c fd 00 03 4c d4 51 41");
  const auto with = [&good](std::size_t at, unsigned value) {
    Bytes bytes = good;
    bytes[at] = static_cast<std::byte>(value);
    return WithMendedChecksums(bytes);
  };

  EXPECT_EQ(ParseFrame(with(0, 0xAB)).defect, FrameDefect::kStart);
  EXPECT_EQ(ParseFrame(with(1, 0)).defect, FrameDefect::kVersion);
  EXPECT_EQ(ParseFrame(with(1, 2)).defect, FrameDefect::kVersion);
  EXPECT_EQ(ParseFrame(with(2, 0x10)).defect, FrameDefect::kLength);
  EXPECT_EQ(ParseFrame(with(3, 0x01)).defect, FrameDefect::kLength);
  EXPECT_EQ(ParseFrame(with(4, 3)).defect, FrameDefect::kType);
  EXPECT_EQ(ParseFrame(with(4, 255)).defect, FrameDefect::kType);
}

TEST(ControlFrame, HasWordsForEachDefect) {
  std::set<std::string> texts;
  for (std::size_t i = 0; i < kNumFrameDefects; ++i) {
    texts.insert(DefectText(static_cast<FrameDefect>(i)));
  }

  EXPECT_EQ(texts.size(), kNumFrameDefects);
}

}  // namespace
}  // namespace clearway::core::livox
