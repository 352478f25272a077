// SPDX-License-Identifier: BSD-3-Clause
#include <cstdint>
#include <random>
#include <string>
#include <tuple>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "common/io/map/map_image.hpp"
#include "tests/unit/io/map/refusal.hpp"

namespace clearway::io {
namespace {

using test::IsOneLine;
using test::RefusalOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::StartsWith;

struct Pixels {
  int width = 0;
  int height = 0;
  std::uint16_t maxval = 0;
  std::vector<std::uint16_t> values;
};

Pixels RandomPixels(std::mt19937& random, std::uint16_t maxval) {
  Pixels pixels;
  pixels.width = 1 + static_cast<int>(random() % 12);
  pixels.height = 1 + static_cast<int>(random() % 12);
  pixels.maxval = maxval;
  for (int i = 0; i < pixels.width * pixels.height; ++i) {
    pixels.values.push_back(static_cast<std::uint16_t>(random() % (maxval + 1U)));
  }
  return pixels;
}

std::string Sizes(const Pixels& pixels) {
  return std::to_string(pixels.width) + " " + std::to_string(pixels.height) + "\n" +
         std::to_string(pixels.maxval) + "\n";
}

std::string Plain(const Pixels& pixels) {
  std::string text = "P2\n" + Sizes(pixels);
  for (const std::uint16_t value : pixels.values) text += std::to_string(value) + " ";
  return text;
}

std::string Raw(const Pixels& pixels) {
  std::string bytes = "P5\n" + Sizes(pixels);
  for (const std::uint16_t value : pixels.values) {
    if (pixels.maxval > 255) bytes += static_cast<char>(value / 256);
    bytes += static_cast<char>(value % 256);
  }
  return bytes;
}

TEST(Pgm, PlainAndRawFilesOfTheSamePixelsGiveThemBack) {
  std::mt19937 random(7);
  for (const int maxval : {1, 2, 15, 100, 254, 255, 256, 257, 4095, 65534, 65535}) {
    for (int round = 0; round < 20; ++round) {
      const Pixels pixels = RandomPixels(random, static_cast<std::uint16_t>(maxval));

      const MapImage plain = ParsePgm(Plain(pixels), "a.pgm");
      const MapImage raw = ParseMapImage(Raw(pixels), "a.pgm");

      for (const MapImage* image : {&plain, &raw}) {
        ASSERT_EQ(std::tie(image->width, image->height), std::tie(pixels.width, pixels.height));
        ASSERT_EQ(image->full_scale, pixels.maxval);
        ASSERT_EQ(image->brightness, pixels.values);
        ASSERT_TRUE(image->opacity.empty());
      }
    }
  }
}

TEST(Pgm, ReadsPixelsOfTwoBytesWithTheHighOneFirst) {
  const MapImage image = ParsePgm(std::string("P5 2 1 65535\n\x01\x02\xff\xfe", 17), "a.pgm");

  EXPECT_THAT(image.brightness, ElementsAre(0x0102, 0xfffe));
}

TEST(Pgm, AllowsCommentsAndBlanksAnywhereInTheHeader) {
  for (const std::string header : {"P5\n# made by hand\n2 1\n255\n",
                                   "P5#\n#\n2#width\n#\n 1 # height\n255\n",
                                   "P5 2 1 255 ",
                                   "P5\r\n2 1\r\n255\r",
                                   "P5\t2\v1\f# 9 9 9\n255\n",
                                   "P5 2 1 255# right behind\n"}) {
    EXPECT_THAT(ParsePgm(header + "#\n", "a.pgm").brightness, ElementsAre('#', '\n')) << header;
  }
}

TEST(Pgm, AllowsCommentsBetweenPlainPixels) {
  const MapImage image =
      ParsePgm("P2 # 1\n2 # 2\n2 7 # 3\n0 1#4\n# 5 6\n6\n\n7 # the end", "a.pgm");

  EXPECT_THAT(image.brightness, ElementsAre(0, 1, 6, 7));
}

TEST(Pgm, AllowsWhiteSpaceAfterTheLastPixel) {
  EXPECT_EQ(ParsePgm("P5 2 1 255\nab\n", "a.pgm").num_pixels(), 2U);
  EXPECT_EQ(ParsePgm("P2 2 1 255\n1 2\r\n\n", "a.pgm").num_pixels(), 2U);
}

TEST(Pgm, NoBeginningOfAFileIsReadAsAFile) {
  std::mt19937 random(11);
  for (const int maxval : {255, 65535}) {
    const Pixels pixels = RandomPixels(random, static_cast<std::uint16_t>(maxval));
    std::string plain = Plain(pixels);
    plain.pop_back();
    const std::string raw = Raw(pixels);
    // The last pixel of a plain file may lose digits and still be one.
    const std::size_t last_word = plain.rfind(' ') + 1;
    for (std::size_t size = 0; size < raw.size(); ++size) {
      EXPECT_TRUE(IsOneLine(RefusalOf([&] { return ParsePgm(raw.substr(0, size), "a.pgm"); })));
    }
    for (std::size_t size = 0; size <= last_word; ++size) {
      EXPECT_TRUE(IsOneLine(RefusalOf([&] { return ParsePgm(plain.substr(0, size), "a.pgm"); })));
    }
  }
}

struct BadPgm {
  std::string bytes;
  std::string message;
};

TEST(Pgm, SaysWhereAFileIsWrongAndWhatIsAllowed) {
  const std::vector<BadPgm> cases = {
      {"P7 1 1 1\n0", "a.pgm:1: starts with \"P7\": expected \"P2\" or \"P5\""},
      {"P55 1 255\nabc", "a.pgm:1: starts with \"5\": expected white space after the magic"},
      {"P5\n# c\n-3 1\n255\na", "a.pgm:3: width \"-3\": expected width from 1 to 100000000"},
      {"P5\n0 1\n255\na", "a.pgm:2: width \"0\": expected width from 1 to 100000000"},
      {"P5\n1 x\n255\na", "a.pgm:2: height \"x\": expected height from 1 to 100000000"},
      {"P5\n1 1\n0\na", "a.pgm:3: maxval \"0\": expected maxval from 1 to 65535"},
      {"P5\n1 1\n65536\nab", "a.pgm:3: maxval \"65536\": expected maxval from 1 to 65535"},
      {"P5\n1 1\n", "a.pgm:3: the file ends here: expected maxval from 1 to 65535"},
      {"P5 10001 10000 255\n",
       "a.pgm:1: 10001 x 10000 pixels: expected at least 1 x 1 and at most 100000000 pixels"},
      {"P5 10000 10000 255\nab",
       "a.pgm: byte 21: is cut short: expected 10000 x 10000 pixels in 100000000 bytes, 2 are "
       "there"},
      {"P2 10000 10000 255\n1 2",
       "a.pgm: is cut short: expected 10000 x 10000 pixels do not fit into 4 bytes"},
      {"P2 2 2 255\n1 2    \n3", "a.pgm:3: is cut short: expected 2 x 2 pixels, 3 are there"},
      {"P2 2 1 7\n1\n8\n", "a.pgm:3: pixel \"8\": expected pixel from 0 to 7"},
      {"P2 2 1 7\n1\n1.5\n", "a.pgm:3: pixel \"1.5\": expected pixel from 0 to 7"},
      {"P2 2 1 7\n1 2\n3",
       "a.pgm:3: \"3\" after the last pixel: expected 2 x 1 pixels and "
       "nothing but white space after them"},
      {"P5 2 1 7\n\x01\x08", "a.pgm: byte 10: pixel 8: expected 0 to the maxval 7"},
      {"P5 2 1 255\nabc",
       "a.pgm: byte 13: 1 bytes after the last pixel: expected 2 x 1 pixels "
       "and nothing but white space after them"},
  };
  for (const BadPgm& bad : cases) {
    EXPECT_EQ(RefusalOf([&] { return ParsePgm(bad.bytes, "a.pgm"); }), bad.message);
  }
}

TEST(MapImage, SaysWhatAFileIsThatIsNeitherPgmNorPng) {
  const std::string allowed = "; allowed are PGM (P2, P5) and PNG";
  EXPECT_EQ(RefusalOf([] { return ParseMapImage("BM\x76\x01", "a.pgm"); }),
            "a.pgm: is a BMP image" + allowed);
  EXPECT_EQ(RefusalOf([] { return ParseMapImage("\xff\xd8\xff\xe0", "a"); }),
            "a: is a JPEG image" + allowed);
  EXPECT_EQ(RefusalOf([] { return ParseMapImage("P6 1 1 255\nabc", "a"); }),
            "a: is a PPM image (P6)" + allowed);
  EXPECT_EQ(RefusalOf([] { return ParseMapImage("", "a"); }), "a: is empty (0 bytes)" + allowed);
  EXPECT_EQ(RefusalOf([] { return ParseMapImage("\n\x01zz", "a"); }),
            "a: starts with \"\\x0a\\x01zz\", which is no image known here" + allowed);
}

}  // namespace
}  // namespace clearway::io
