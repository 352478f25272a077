// SPDX-License-Identifier: BSD-3-Clause
#include "common/io/map/map_image.hpp"

#include <array>

namespace clearway::io {
namespace {

using std::string_view_literals::operator""sv;

constexpr std::string_view kPngSignature = "\x89PNG\r\n\x1a\n"sv;

struct Format {
  std::string_view magic;
  std::string_view name;
};

// What maps are sometimes stored as, for a message that helps.
constexpr std::array kOtherFormats = {Format{"BM"sv, "a BMP image"},
                                      Format{"\xff\xd8\xff"sv, "a JPEG image"},
                                      Format{"GIF8"sv, "a GIF image"},
                                      Format{"II*\0"sv, "a TIFF image"},
                                      Format{"MM\0*"sv, "a TIFF image"},
                                      Format{"P1"sv, "a PBM image (P1)"},
                                      Format{"P4"sv, "a PBM image (P4)"},
                                      Format{"P3"sv, "a PPM image (P3)"},
                                      Format{"P6"sv, "a PPM image (P6)"},
                                      Format{"P7"sv, "a PAM image (P7)"},
                                      Format{"RIFF"sv, "a RIFF file (WebP?)"}};

std::string Describe(std::string_view bytes) {
  if (bytes.empty()) return "is empty (0 bytes)";
  for (const Format& format : kOtherFormats) {
    if (bytes.starts_with(format.magic)) return "is " + std::string(format.name);
  }
  return "starts with " + Quoted(bytes.substr(0, 8)) + ", which is no image known here";
}

}  // namespace

MapImage ParseMapImage(std::string_view bytes, const std::string& name) {
  if (bytes.starts_with("P2") || bytes.starts_with("P5")) return ParsePgm(bytes, name);
  // A damaged signature is told by the PNG reader.
  if (bytes.starts_with(kPngSignature.substr(0, 4))) return ParsePng(bytes, name);
  throw ErrorInFile(name, Describe(bytes) + "; allowed are PGM (P2, P5) and PNG");
}

}  // namespace clearway::io
