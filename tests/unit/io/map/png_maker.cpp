// SPDX-License-Identifier: BSD-3-Clause
#include "tests/unit/io/map/png_maker.hpp"

#include <stdexcept>

#include <png.h>

namespace clearway::test {
namespace {

[[noreturn]] void OnError(png_structp /*png*/, png_const_charp text) {
  // Only for tests: what libpng leaves behind does not matter.
  throw std::runtime_error(text);
}

void OnWrite(png_structp png, png_bytep data, png_size_t length) {
  static_cast<std::string*>(png_get_io_ptr(png))->append(reinterpret_cast<char*>(data), length);
}

void OnFlush(png_structp /*png*/) {}

std::vector<png_byte> PackedLine(const PngContent& content, std::size_t line) {
  const std::size_t count =
      std::size_t{content.width} * static_cast<std::size_t>(ChannelsOf(content.color_type));
  const auto depth = static_cast<std::size_t>(content.bit_depth);
  std::vector<png_byte> bytes((count * depth + 7) / 8);
  for (std::size_t i = 0; i < count; ++i) {
    const unsigned sample = content.samples[line * count + i];
    if (depth == 16) {
      bytes[2 * i] = static_cast<png_byte>(sample >> 8U);
      bytes[2 * i + 1] = static_cast<png_byte>(sample & 255U);
    } else {
      const std::size_t bit = i * depth;
      const std::size_t shift = 8 - depth - bit % 8;
      bytes[bit / 8] = static_cast<png_byte>(bytes[bit / 8] | (sample << shift));
    }
  }
  return bytes;
}

void SetColours(png_structp png, png_infop info, const PngContent& content) {
  std::vector<png_color> palette;
  for (const auto& [red, green, blue] : content.palette) palette.push_back({red, green, blue});
  if (!palette.empty()) png_set_PLTE(png, info, palette.data(), static_cast<int>(palette.size()));
  if (!content.palette_opacity.empty()) {
    png_set_tRNS(png,
                 info,
                 content.palette_opacity.data(),
                 static_cast<int>(content.palette_opacity.size()),
                 nullptr);
  }
  if (content.transparent_colour) {
    const auto& [red, green, blue] = *content.transparent_colour;
    const png_color_16 colour{0, red, green, blue, red};
    png_set_tRNS(png, info, nullptr, 0, &colour);
  }
}

}  // namespace

int ChannelsOf(int color_type) {
  switch (color_type) {
    case PNG_COLOR_TYPE_RGB:
      return 3;
    case PNG_COLOR_TYPE_GRAY_ALPHA:
      return 2;
    case PNG_COLOR_TYPE_RGB_ALPHA:
      return 4;
    default:
      return 1;
  }
}

std::string MakePng(const PngContent& content) {
  std::string file;
  png_structp png = png_create_write_struct(PNG_LIBPNG_VER_STRING, nullptr, OnError, nullptr);
  png_infop info = png_create_info_struct(png);
  png_set_write_fn(png, &file, OnWrite, OnFlush);
  png_set_check_for_invalid_index(png, 0);
  png_set_IHDR(png,
               info,
               content.width,
               content.height,
               content.bit_depth,
               content.color_type,
               content.is_interlaced ? PNG_INTERLACE_ADAM7 : PNG_INTERLACE_NONE,
               PNG_COMPRESSION_TYPE_DEFAULT,
               PNG_FILTER_TYPE_DEFAULT);
  SetColours(png, info, content);
  png_write_info(png, info);
  std::vector<std::vector<png_byte>> lines;
  std::vector<png_bytep> pointers;
  for (std::size_t line = 0; line < content.height; ++line) {
    lines.push_back(PackedLine(content, line));
  }
  for (std::vector<png_byte>& line : lines) pointers.push_back(line.data());
  png_write_image(png, pointers.data());
  png_write_end(png, info);
  png_destroy_write_struct(&png, &info);
  return file;
}

}  // namespace clearway::test
