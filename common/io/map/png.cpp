// SPDX-License-Identifier: BSD-3-Clause
#include <array>
#include <csetjmp>
#include <cstdint>
#include <cstdio>
#include <cstring>
#include <new>
#include <utility>

#include <png.h>

#include "common/io/map/image_size.hpp"
#include "common/io/map/map_image.hpp"

namespace clearway::io {
namespace {

// libpng leaves its functions by longjmp(), over which no destructor may lie. So what calls libpng
// is a step that has no local object with a destructor, and everything lives in this class.
class PngDecoder {
 public:
  PngDecoder(std::string_view bytes, const std::string& name) : bytes_(bytes), name_(name) {
    png_ = png_create_read_struct(PNG_LIBPNG_VER_STRING, this, OnError, OnWarning);
    if (png_ != nullptr) info_ = png_create_info_struct(png_);
    if (info_ == nullptr) {
      png_destroy_read_struct(&png_, nullptr, nullptr);
      throw std::bad_alloc();
    }
  }
  ~PngDecoder() { png_destroy_read_struct(&png_, &info_, nullptr); }
  PngDecoder(const PngDecoder&) = delete;
  PngDecoder& operator=(const PngDecoder&) = delete;

  MapImage Decode() {
    Run(&PngDecoder::ReadHeader);
    CheckSize();
    Prepare();
    Run(&PngDecoder::ReadPixels);
    if (worst_index_ >= num_colours_ && color_type_ == PNG_COLOR_TYPE_PALETTE) {
      throw ErrorInFile(name_,
                        "PNG: pixel " + std::to_string(worst_index_) +
                            ": expected less than the palette's " + std::to_string(num_colours_) +
                            " colours");
    }
    return std::move(image_);
  }

 private:
  static constexpr std::size_t kMaxColours = 256;

  static void OnWarning(png_structp /*png*/, png_const_charp /*text*/) {}

  [[noreturn]] static void OnError(png_structp png, png_const_charp text) {
    auto* self = static_cast<PngDecoder*>(png_get_error_ptr(png));
    std::snprintf(self->problem_.data(), self->problem_.size(), "%s", text);
    png_longjmp(png, 1);
  }

  static void OnRead(png_structp png, png_bytep target, png_size_t length) {
    auto* self = static_cast<PngDecoder*>(png_get_io_ptr(png));
    if (length > self->bytes_.size() - self->position_) png_error(png, "the file is cut short");
    std::memcpy(target, self->bytes_.data() + self->position_, length);
    self->position_ += length;
  }

  void Run(void (PngDecoder::*step)()) {
    if (Survives(step)) return;
    for (char* letter = problem_.data(); *letter != '\0'; ++letter) {
      if (*letter < ' ' || *letter > '~') *letter = '?';
    }
    throw ErrorAtByte(
        name_, position_, std::string("PNG: ") + problem_.data() + "; expected a whole PNG file");
  }

  bool Survives(void (PngDecoder::*step)()) {
    if (setjmp(png_jmpbuf(png_)) != 0) return false;
    (this->*step)();
    return true;
  }

  void ReadHeader() {
    constexpr png_uint_32 kMaxSide = core::GridGeometry::kMaxCells;
    png_set_read_fn(png_, this, OnRead);
    png_set_user_limits(png_, kMaxSide, kMaxSide);
    png_set_chunk_malloc_max(png_, 1U << 23U);
    png_set_crc_action(png_, PNG_CRC_ERROR_QUIT, PNG_CRC_ERROR_QUIT);
    // Nothing but IHDR, PLTE, tRNS, IDAT and IEND matters: texts and profiles are not unpacked.
    png_set_keep_unknown_chunks(png_, PNG_HANDLE_CHUNK_NEVER, nullptr, -1);
    png_read_info(png_, info_);
    width_ = png_get_image_width(png_, info_);
    height_ = png_get_image_height(png_, info_);
    bit_depth_ = png_get_bit_depth(png_, info_);
    color_type_ = png_get_color_type(png_, info_);
    channels_ = png_get_channels(png_, info_);
    is_interlaced_ = png_get_interlace_type(png_, info_) != PNG_INTERLACE_NONE;
    ReadPalette();
    ReadTransparency();
  }

  void ReadPalette() {
    png_colorp colours = nullptr;
    int count = 0;
    if (png_get_PLTE(png_, info_, &colours, &count) == 0) return;
    num_colours_ = static_cast<std::size_t>(count);
    for (std::size_t i = 0; i < num_colours_ && i < kMaxColours; ++i) {
      palette_[i] = static_cast<std::uint16_t>(colours[i].red + colours[i].green + colours[i].blue);
    }
  }

  void ReadTransparency() {
    palette_opacity_.fill(255);
    png_bytep opacities = nullptr;
    int count = 0;
    png_color_16p colour = nullptr;
    if (png_get_tRNS(png_, info_, &opacities, &count, &colour) == 0) return;
    has_transparency_ = true;
    if (color_type_ == PNG_COLOR_TYPE_PALETTE) {
      for (std::size_t i = 0; i < static_cast<std::size_t>(count) && i < kMaxColours; ++i) {
        palette_opacity_[i] = opacities[i];
      }
    } else if (colour != nullptr) {
      transparent_ = color_type_ == PNG_COLOR_TYPE_GRAY
                         ? std::array<unsigned, 3>{colour->gray, 0, 0}
                         : std::array<unsigned, 3>{colour->red, colour->green, colour->blue};
    }
  }

  void CheckSize() const {
    const std::string problem = SizeProblem(width_, height_);
    if (!problem.empty()) throw ErrorInFile(name_, "PNG: " + problem);
    // zlib packs at most 1032 bytes into one.
    const std::uint64_t line = (std::uint64_t{width_} * channels_ * bit_depth_ + 7) / 8;
    if (line * height_ / 1032 > bytes_.size()) {
      throw ErrorInFile(name_,
                        "PNG: " + std::to_string(width_) + " x " + std::to_string(height_) +
                            " pixels cannot be in a file of " + std::to_string(bytes_.size()) +
                            " bytes");
    }
  }

  void Prepare() {
    const bool has_alpha = (color_type_ & PNG_COLOR_MASK_ALPHA) != 0 || has_transparency_;
    const std::size_t pixels = std::size_t{width_} * height_;
    image_.width = static_cast<int>(width_);
    image_.height = static_cast<int>(height_);
    image_.brightness.resize(pixels);
    if (has_alpha) image_.opacity.resize(pixels);
    const bool is_colour = (color_type_ & PNG_COLOR_MASK_COLOR) != 0;
    if (bit_depth_ == 16) {
      image_.full_scale = 65535;
    } else if (is_colour) {
      image_.full_scale = 765;
    } else {
      image_.full_scale = static_cast<std::uint16_t>((1U << bit_depth_) - 1);
    }
    line_.resize(std::size_t{width_} * channels_ * (bit_depth_ == 16 ? 2 : 1));
  }

  // Interlaced images are taken pass by pass, so that no second image has to be kept.
  void ReadPixels() {
    png_set_packing(png_);
    png_read_update_info(png_, info_);
    const int passes = is_interlaced_ ? PNG_INTERLACE_ADAM7_PASSES : 1;
    for (int pass = 0; pass < passes; ++pass) {
      const Pass pixels = is_interlaced_ ? PassOf(pass) : Pass{width_, height_, 0, 0, 1, 1};
      if (pixels.columns == 0) continue;
      for (png_uint_32 row = 0; row < pixels.rows; ++row) {
        png_read_row(png_, line_.data(), nullptr);
        StoreLine(pixels, pixels.first_row + row * pixels.row_step);
      }
    }
    png_read_end(png_, nullptr);
  }

  struct Pass {
    png_uint_32 columns;
    png_uint_32 rows;
    png_uint_32 first_column;
    png_uint_32 first_row;
    png_uint_32 column_step;
    png_uint_32 row_step;
  };

  [[nodiscard]] Pass PassOf(int pass) const {
    return {PNG_PASS_COLS(width_, pass),
            PNG_PASS_ROWS(height_, pass),
            static_cast<png_uint_32>(PNG_PASS_START_COL(pass)),
            static_cast<png_uint_32>(PNG_PASS_START_ROW(pass)),
            1U << static_cast<unsigned>(PNG_PASS_COL_SHIFT(pass)),
            1U << static_cast<unsigned>(PNG_PASS_ROW_SHIFT(pass))};
  }

  void StoreLine(const Pass& pass, png_uint_32 row) {
    for (png_uint_32 column = 0; column < pass.columns; ++column) {
      const std::size_t target =
          std::size_t{row} * width_ + pass.first_column + column * pass.column_step;
      const std::size_t source = std::size_t{column} * channels_;
      if (color_type_ == PNG_COLOR_TYPE_PALETTE) {
        StoreIndex(Sample(source), target);
      } else {
        StorePixel(source, target);
      }
    }
  }

  void StoreIndex(unsigned index, std::size_t target) {
    if (index > worst_index_) worst_index_ = index;
    image_.brightness[target] = palette_[index];
    if (has_transparency_) image_.opacity[target] = Opacity(palette_opacity_[index]);
  }

  void StorePixel(std::size_t source, std::size_t target) {
    const bool is_colour = (color_type_ & PNG_COLOR_MASK_COLOR) != 0;
    const std::array<unsigned, 3> colour = {
        Sample(source), is_colour ? Sample(source + 1) : 0, is_colour ? Sample(source + 2) : 0};
    unsigned brightness = colour[0] + colour[1] + colour[2];
    if (is_colour && bit_depth_ == 16) brightness = (brightness + 1) / 3;
    image_.brightness[target] = static_cast<std::uint16_t>(brightness);
    if ((color_type_ & PNG_COLOR_MASK_ALPHA) != 0) {
      image_.opacity[target] = Opacity(Sample(source + channels_ - 1));
    } else if (has_transparency_) {
      image_.opacity[target] = colour == transparent_ ? 0 : MapImage::kOpaque;
    }
  }

  [[nodiscard]] unsigned Sample(std::size_t index) const {
    if (bit_depth_ < 16) return line_[index];
    return line_[2 * index] * 256U + line_[2 * index + 1];
  }

  [[nodiscard]] std::uint16_t Opacity(unsigned sample) const {
    return static_cast<std::uint16_t>(bit_depth_ == 16 ? sample : sample * 257);
  }

  std::string_view bytes_;
  const std::string& name_;
  std::size_t position_ = 0;
  std::array<char, 200> problem_{};
  png_structp png_ = nullptr;
  png_infop info_ = nullptr;
  png_uint_32 width_ = 0;
  png_uint_32 height_ = 0;
  unsigned bit_depth_ = 0;
  unsigned channels_ = 0;
  int color_type_ = 0;
  bool is_interlaced_ = false;
  bool has_transparency_ = false;
  std::size_t num_colours_ = 0;
  std::size_t worst_index_ = 0;
  std::array<std::uint16_t, kMaxColours> palette_{};  // Sums of red, green and blue.
  std::array<std::uint8_t, kMaxColours> palette_opacity_{};
  std::array<unsigned, 3> transparent_{};  // The colour that a tRNS chunk names.
  std::vector<png_byte> line_;
  MapImage image_;
};

}  // namespace

MapImage ParsePng(std::string_view bytes, const std::string& name) {
  return PngDecoder(bytes, name).Decode();
}

}  // namespace clearway::io
