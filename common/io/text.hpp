// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string_view>
#include <vector>

namespace clearway::io {

/// Walks over the lines of a text; '\n' ends a line, the last one may lack it.
class LineReader {
 public:
  /// @param first_line number of the line that `text` starts in, for messages.
  explicit LineReader(std::string_view text, std::size_t first_line = 1)
      : text_(text), next_line_(first_line) {}

  /// The next line without its '\n' (a '\r' before it is still there), nothing after the last.
  std::optional<std::string_view> Next();

  /// Number of the line that Next() gave last.
  [[nodiscard]] std::size_t line() const { return next_line_ - 1; }

  /// Where the line after that one starts, in bytes from the start of the text.
  [[nodiscard]] std::size_t position() const { return position_; }

 private:
  std::string_view text_;
  std::size_t position_ = 0;
  std::size_t next_line_;
};

/// Without blanks, tabs and carriage returns at both ends.
[[nodiscard]] std::string_view Trim(std::string_view text);

/// The words of a line, separated by blanks, tabs or carriage returns.
[[nodiscard]] std::vector<std::string_view> SplitWords(std::string_view line);

/// A whole number of decimal digits, nothing else. Nothing when it is not, or is beyond 64 bits.
[[nodiscard]] std::optional<std::uint64_t> ParseWhole(std::string_view word);

/// A decimal number in the C locale, also `nan`, `-nan`, `inf`, and with a leading '+'. Nothing
/// when the word is anything else, or when a double cannot hold it.
[[nodiscard]] std::optional<double> ParseNumber(std::string_view word);

}  // namespace clearway::io
