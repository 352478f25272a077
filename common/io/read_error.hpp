// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <stdexcept>
#include <string>
#include <string_view>

namespace clearway::io {

/// A file that cannot be read as what it claims to be. what() is one line: the file, where in it
/// (a line of text or a byte of binary data), what is there, and what was expected.
class ReadError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// `file: text`, for what concerns the file as a whole.
[[nodiscard]] ReadError ErrorInFile(const std::string& file, const std::string& text);

/// `file:line: text`. Lines count from 1.
[[nodiscard]] ReadError ErrorInLine(const std::string& file,
                                    std::size_t line,
                                    const std::string& text);

/// `file:line:column: text`. Both count from 1; a column is a byte.
[[nodiscard]] ReadError ErrorInColumn(const std::string& file,
                                      std::size_t line,
                                      std::size_t column,
                                      const std::string& text);

/// `file: byte N: text`. Bytes count from 0, at the start of the file.
[[nodiscard]] ReadError ErrorAtByte(const std::string& file,
                                    std::size_t byte,
                                    const std::string& text);

/// The value in quotes, fit for one line of a message: bytes that do not print become \xNN, and
/// what is longer than 40 characters is cut and ends in "...".
[[nodiscard]] std::string Quoted(std::string_view value);

}  // namespace clearway::io
