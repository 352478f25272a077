// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cstdint>
#include <random>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "common/io/map/map_image.hpp"
#include "tests/unit/io/map/png_maker.hpp"
#include "tests/unit/io/map/refusal.hpp"

namespace clearway::io {
namespace {

using test::ChannelsOf;
using test::IsOneLine;
using test::MakePng;
using test::PngContent;
using test::RefusalOf;
using testing::ElementsAre;
using testing::EndsWith;
using testing::HasSubstr;
using testing::StartsWith;

constexpr int kGray = 0;
constexpr int kColour = 2;
constexpr int kPalette = 3;
constexpr int kGrayAlpha = 4;
constexpr int kColourAlpha = 6;

struct Kind {
  int color_type;
  int bit_depth;
};

constexpr Kind kKinds[] = {{kGray, 1},
                           {kGray, 2},
                           {kGray, 4},
                           {kGray, 8},
                           {kGray, 16},
                           {kPalette, 1},
                           {kPalette, 2},
                           {kPalette, 4},
                           {kPalette, 8},
                           {kColour, 8},
                           {kColour, 16},
                           {kGrayAlpha, 8},
                           {kGrayAlpha, 16},
                           {kColourAlpha, 8},
                           {kColourAlpha, 16}};

PngContent RandomContent(std::mt19937& random, const Kind& kind) {
  PngContent content;
  content.width = static_cast<std::uint32_t>(1 + random() % 17);
  content.height = static_cast<std::uint32_t>(1 + random() % 17);
  content.bit_depth = kind.bit_depth;
  content.color_type = kind.color_type;
  content.is_interlaced = random() % 2 == 0;
  const std::size_t samples = std::size_t{content.width} * content.height *
                              static_cast<std::size_t>(ChannelsOf(kind.color_type));
  for (std::size_t i = 0; i < samples; ++i) {
    // Few values, so that the transparent colour turns up.
    const auto sample = random() % 3 == 0 ? random() : 0x5555U * (random() % 2);
    content.samples.push_back(static_cast<std::uint16_t>(sample % (1U << kind.bit_depth)));
  }
  const bool has_transparency = random() % 2 == 0;
  const auto byte = [&] { return static_cast<std::uint8_t>(random() % 256); };
  if (kind.color_type == kPalette) {
    for (int i = 0; i < (1 << kind.bit_depth); ++i) {
      content.palette.push_back({byte(), byte(), byte()});
      if (has_transparency && content.palette_opacity.size() < 5) {
        content.palette_opacity.push_back(byte());
      }
    }
  } else if (has_transparency && (kind.color_type == kGray || kind.color_type == kColour)) {
    const auto value = static_cast<std::uint16_t>(0x5555U % (1U << kind.bit_depth));
    content.transparent_colour = {value, value, value};
  }
  return content;
}

// What a pixel is, by the words of the PNG specification.
struct Pixel {
  double shade = 0.0;
  double opacity = 1.0;
};

Pixel PixelOf(const PngContent& content, std::size_t index) {
  const auto channels = static_cast<std::size_t>(ChannelsOf(content.color_type));
  const std::uint16_t* sample = &content.samples[index * channels];
  const double most = (1 << content.bit_depth) - 1;
  if (content.color_type == kPalette) {
    const auto& [red, green, blue] = content.palette[*sample];
    const bool is_listed = *sample < content.palette_opacity.size();
    return {(red + green + blue) / 765.0,
            is_listed ? content.palette_opacity[*sample] / 255.0 : 1.0};
  }
  const bool is_colour = (content.color_type & 2) != 0;
  Pixel pixel{is_colour ? (sample[0] + sample[1] + sample[2]) / (3.0 * most) : sample[0] / most,
              1.0};
  if ((content.color_type & 4) != 0) pixel.opacity = sample[channels - 1] / most;
  if (content.transparent_colour) {
    const auto& colour = *content.transparent_colour;
    const bool is_equal = std::equal(sample, sample + channels, colour.begin());
    pixel.opacity = is_equal ? 0.0 : 1.0;
  }
  return pixel;
}

TEST(Png, EveryKindGivesTheShadeAndOpacityThatItsSamplesStandFor) {
  // Half a step of 16 bits, to which the mean of deep colours is rounded.
  constexpr double kTolerance = 0.5 / 65535 + 1e-12;
  std::mt19937 random(23);
  for (std::size_t round = 0; round < 300; ++round) {
    const PngContent content = RandomContent(random, kKinds[round % std::size(kKinds)]);

    const MapImage image = ParseMapImage(MakePng(content), "a.png");

    ASSERT_EQ(image.width, static_cast<int>(content.width));
    ASSERT_EQ(image.height, static_cast<int>(content.height));
    ASSERT_EQ(image.num_pixels(), std::size_t{content.width} * content.height);
    const bool has_opacity = (content.color_type & 4) != 0 || content.transparent_colour ||
                             !content.palette_opacity.empty();
    ASSERT_EQ(image.opacity.size(), has_opacity ? image.num_pixels() : 0U);
    for (std::size_t i = 0; i < image.num_pixels(); ++i) {
      const Pixel expected = PixelOf(content, i);
      ASSERT_NEAR(
          image.brightness[i] / static_cast<double>(image.full_scale), expected.shade, kTolerance)
          << "kind " << content.color_type << ", " << content.bit_depth << " bits, pixel " << i;
      if (has_opacity) {
        ASSERT_NEAR(
            image.opacity[i] / static_cast<double>(MapImage::kOpaque), expected.opacity, 1e-12);
      }
    }
  }
}

TEST(Png, ShadesOfEightBitsAreExact) {
  PngContent content{.width = 3, .height = 1, .color_type = kColour};
  content.samples = {0, 0, 0, 205, 205, 205, 255, 254, 0};

  const MapImage image = ParsePng(MakePng(content), "a.png");

  EXPECT_EQ(image.full_scale, 765);
  EXPECT_THAT(image.brightness, ElementsAre(0, 615, 509));
}

TEST(Png, NoBeginningOfAFileIsReadAsAFile) {
  std::mt19937 random(31);
  for (const Kind& kind : {Kind{kGray, 1}, Kind{kColourAlpha, 16}, Kind{kPalette, 4}}) {
    const std::string file = MakePng(RandomContent(random, kind));
    for (std::size_t size = 0; size < file.size(); ++size) {
      const std::string message =
          RefusalOf([&] { return ParsePng(file.substr(0, size), "a.png"); });
      EXPECT_TRUE(IsOneLine(message)) << size;
      EXPECT_THAT(message, StartsWith("a.png: "));
    }
  }
}

TEST(Png, DamageInAnyByteIsRefused) {
  std::mt19937 random(37);
  const std::string file = MakePng(RandomContent(random, {kColour, 8}));
  for (std::size_t at = 0; at < file.size(); ++at) {
    std::string damaged = file;
    damaged[at] = static_cast<char>(damaged[at] ^ 0x10);
    EXPECT_TRUE(IsOneLine(RefusalOf([&] { return ParsePng(damaged, "a.png"); }))) << at;
  }
}

TEST(Png, IgnoresWhatFollowsTheLastChunk) {
  std::mt19937 random(41);
  const std::string file = MakePng(RandomContent(random, {kGray, 8}));

  EXPECT_EQ(ParsePng(file + "more", "a.png").brightness, ParsePng(file, "a.png").brightness);
}

TEST(Png, RefusesAPixelThatThePaletteDoesNotHave) {
  PngContent content{.width = 2, .height = 1, .color_type = kPalette};
  content.palette = {{0, 0, 0}, {1, 1, 1}};
  content.samples = {1, 7};

  EXPECT_EQ(RefusalOf([&] { return ParsePng(MakePng(content), "a.png"); }),
            "a.png: PNG: pixel 7: expected less than the palette's 2 colours");
}

// Puts a size into the header and mends its checksum.
std::string WithSize(std::string file, std::uint32_t width, std::uint32_t height) {
  const auto store = [&](std::size_t at, std::uint32_t value) {
    for (std::size_t i = 0; i < 4; ++i) {
      file[at + i] = static_cast<char>(value >> (24U - 8U * static_cast<unsigned>(i)));
    }
  };
  constexpr std::size_t kType = 12;
  constexpr std::size_t kCrc = 29;
  store(16, width);
  store(20, height);
  std::uint32_t crc = ~0U;
  for (std::size_t i = kType; i < kCrc; ++i) {
    crc ^= static_cast<unsigned char>(file[i]);
    for (int bit = 0; bit < 8; ++bit) crc = (crc >> 1U) ^ ((crc & 1U) != 0U ? 0xedb88320U : 0U);
  }
  store(kCrc, ~crc);
  return file;
}

TEST(Png, RefusesSizesBeforeItAllocates) {
  const std::string file = MakePng({.width = 1, .height = 1, .samples = {3}});

  const auto refusal = [&](std::uint32_t width, std::uint32_t height) {
    return RefusalOf([&] { return ParsePng(WithSize(file, width, height), "a.png"); });
  };

  EXPECT_EQ(refusal(1, 1), "");
  EXPECT_THAT(
      refusal(10'001, 10'000),
      EndsWith("10001 x 10000 pixels: expected at least 1 x 1 and at most 100000000 pixels"));
  EXPECT_THAT(refusal(10'000, 10'000), HasSubstr("10000 x 10000 pixels cannot be in a file of"));
  EXPECT_THAT(refusal(0, 1), HasSubstr("PNG: "));
  EXPECT_THAT(refusal(0x7fffffff, 0x7fffffff), HasSubstr("PNG: "));
  EXPECT_THAT(refusal(0xffffffff, 1), HasSubstr("PNG: "));
}

}  // namespace
}  // namespace clearway::io
