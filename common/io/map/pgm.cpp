// SPDX-License-Identifier: BSD-3-Clause
#include <cstdint>
#include <optional>

#include "common/io/map/image_size.hpp"
#include "common/io/map/map_image.hpp"
#include "common/io/text.hpp"

namespace clearway::io {
namespace {

// Blanks of the C locale, as netpbm has them.
bool IsBlank(char character) {
  return character == ' ' || (character >= '\t' && character <= '\r');
}

class PgmReader {
 public:
  PgmReader(std::string_view bytes, const std::string& name) : bytes_(bytes), name_(name) {}

  MapImage Read() {
    const std::string_view magic = bytes_.substr(0, 2);
    if (magic != "P2" && magic != "P5") {
      throw ErrorInLine(name_, 1, "starts with " + Quoted(magic) + ": expected \"P2\" or \"P5\"");
    }
    position_ = 2;
    if (!AtEnd() && !IsBlank(bytes_[2]) && bytes_[2] != '#') {
      throw ErrorInLine(
          name_, 1, "starts with " + Quoted(Word()) + ": expected white space after the magic");
    }
    const MapImage header = ReadHeader();
    return magic == "P2" ? ReadPlain(header) : ReadRaw(header);
  }

 private:
  MapImage ReadHeader() {
    constexpr std::uint64_t kMaxSide = core::GridGeometry::kMaxCells;
    MapImage image;
    const std::uint64_t width = Number("width", 1, kMaxSide);
    const std::uint64_t height = Number("height", 1, kMaxSide);
    const std::string problem = SizeProblem(width, height);
    if (!problem.empty()) throw ErrorInLine(name_, line_, problem);
    image.width = static_cast<int>(width);
    image.height = static_cast<int>(height);
    image.full_scale = static_cast<std::uint16_t>(Number("maxval", 1, 65535));
    num_pixels_ = static_cast<std::size_t>(width * height);
    return image;
  }

  MapImage ReadPlain(MapImage image) {
    // Each value takes a digit and, but for the last, something that ends it.
    if (bytes_.size() - position_ < 2 * num_pixels_) {
      throw ErrorInFile(name_,
                        "is cut short: " + Expectation(image) + " do not fit into " +
                            std::to_string(bytes_.size() - position_) + " bytes");
    }
    image.brightness.reserve(num_pixels_);
    while (image.brightness.size() < num_pixels_) {
      SkipBlanks();
      if (AtEnd()) {
        throw ErrorInLine(name_,
                          line_,
                          "is cut short: " + Expectation(image) + ", " +
                              std::to_string(image.brightness.size()) + " are there");
      }
      image.brightness.push_back(static_cast<std::uint16_t>(Number("pixel", 0, image.full_scale)));
    }
    SkipBlanks();
    if (!AtEnd()) {
      throw ErrorInLine(name_,
                        line_,
                        Quoted(Word()) + " after the last pixel: " + Expectation(image) +
                            " and nothing but white space after them");
    }
    return image;
  }

  MapImage ReadRaw(MapImage image) {
    // A comment right behind maxval ends in the one blank that separates it from the pixels.
    if (!AtEnd() && bytes_[position_] == '#') SkipComment();
    if (!AtEnd()) ++position_;
    const std::size_t bytes_per_pixel = image.full_scale > 255 ? 2 : 1;
    const std::size_t needed = num_pixels_ * bytes_per_pixel;
    const std::string_view pixels = bytes_.substr(position_, needed);
    if (pixels.size() < needed) {
      throw ErrorAtByte(name_,
                        bytes_.size(),
                        "is cut short: " + Expectation(image) + " in " + std::to_string(needed) +
                            " bytes, " + std::to_string(pixels.size()) + " are there");
    }
    RefuseTail(position_ + needed, image);
    image.brightness.reserve(num_pixels_);
    for (std::size_t i = 0; i < needed; i += bytes_per_pixel) {
      unsigned value = static_cast<unsigned char>(pixels[i]);
      if (bytes_per_pixel == 2) value = value * 256 + static_cast<unsigned char>(pixels[i + 1]);
      if (value > image.full_scale) {
        throw ErrorAtByte(name_,
                          position_ + i,
                          "pixel " + std::to_string(value) + ": expected 0 to the maxval " +
                              std::to_string(image.full_scale));
      }
      image.brightness.push_back(static_cast<std::uint16_t>(value));
    }
    return image;
  }

  void RefuseTail(std::size_t end, const MapImage& image) const {
    for (std::size_t i = end; i < bytes_.size(); ++i) {
      if (IsBlank(bytes_[i])) continue;
      throw ErrorAtByte(name_,
                        end,
                        std::to_string(bytes_.size() - end) + " bytes after the last pixel: " +
                            Expectation(image) + " and nothing but white space after them");
    }
  }

  [[nodiscard]] std::string Expectation(const MapImage& image) const {
    return "expected " + std::to_string(image.width) + " x " + std::to_string(image.height) +
           " pixels";
  }

  // The number that starts at the next thing that is neither blank nor comment.
  std::uint64_t Number(const std::string& what, std::uint64_t low, std::uint64_t high) {
    SkipBlanks();
    const std::string allowed =
        ": expected " + what + " from " + std::to_string(low) + " to " + std::to_string(high);
    if (AtEnd()) throw ErrorInLine(name_, line_, "the file ends here" + allowed);
    const std::string_view word = Word();
    const std::optional<std::uint64_t> value = ParseWhole(word);
    if (!value || *value < low || *value > high) {
      throw ErrorInLine(name_, line_, what + " " + Quoted(word) + allowed);
    }
    position_ += word.size();
    return *value;
  }

  [[nodiscard]] std::string_view Word() const {
    std::size_t end = position_;
    while (end < bytes_.size() && !IsBlank(bytes_[end]) && bytes_[end] != '#') ++end;
    return bytes_.substr(position_, end - position_);
  }

  void SkipBlanks() {
    for (; !AtEnd(); ++position_) {
      if (bytes_[position_] == '#') SkipComment();
      if (AtEnd() || !IsBlank(bytes_[position_])) return;
      if (bytes_[position_] == '\n') ++line_;
    }
  }

  // Goes to the line's end, at which a comment ends, or to that of the file.
  void SkipComment() {
    while (!AtEnd() && bytes_[position_] != '\n') ++position_;
  }

  [[nodiscard]] bool AtEnd() const { return position_ >= bytes_.size(); }

  std::string_view bytes_;
  const std::string& name_;
  std::size_t position_ = 0;
  std::size_t line_ = 1;
  std::size_t num_pixels_ = 0;
};

}  // namespace

MapImage ParsePgm(std::string_view bytes, const std::string& name) {
  return PgmReader(bytes, name).Read();
}

}  // namespace clearway::io
