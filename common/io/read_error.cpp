// SPDX-License-Identifier: BSD-3-Clause
#include "common/io/read_error.hpp"

namespace clearway::io {

ReadError ErrorInFile(const std::string& file, const std::string& text) {
  return ReadError(file + ": " + text);
}

ReadError ErrorInLine(const std::string& file, std::size_t line, const std::string& text) {
  return ReadError(file + ":" + std::to_string(line) + ": " + text);
}

ReadError ErrorInColumn(const std::string& file,
                        std::size_t line,
                        std::size_t column,
                        const std::string& text) {
  return ErrorInLine(file + ":" + std::to_string(line), column, text);
}

ReadError ErrorAtByte(const std::string& file, std::size_t byte, const std::string& text) {
  return ReadError(file + ": byte " + std::to_string(byte) + ": " + text);
}

std::string Quoted(std::string_view value) {
  constexpr std::size_t kMaxShown = 40;
  constexpr std::string_view kHex = "0123456789abcdef";
  std::string quoted = "\"";
  for (const char character : value.substr(0, kMaxShown)) {
    const auto code = static_cast<unsigned char>(character);
    if (code >= 0x20 && code < 0x7f) {
      quoted += character;
    } else {
      quoted += "\\x";
      quoted += kHex[code >> 4U];
      quoted += kHex[code & 0xfU];
    }
  }
  return quoted + (value.size() > kMaxShown ? "...\"" : "\"");
}

}  // namespace clearway::io
