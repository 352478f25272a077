// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace clearway::core::procman::internal {

/// A word of a command line or of a rule about command lines, its quotes taken off.
struct ExecWord {
  std::string text;
  /// As long as the text: true where a backslash stood before the character, so that it means
  /// itself and nothing else.
  std::vector<bool> is_literal;
};

/// Either words or what is wrong with the text.
struct SplitExecWords {
  std::vector<ExecWord> words;
  std::string problem;  ///< Empty when there is none.
};

/// Splits by the quoting that exec_string.hpp describes; expands nothing. Refused: an open quote, a
/// backslash at the end, a NUL. Empty quotes make an empty word. O(n) time.
[[nodiscard]] SplitExecWords SplitIntoExecWords(std::string_view text);

/// The same word as text that is split into it alone, with nothing in it that would be expanded.
/// @pre no NUL.
[[nodiscard]] std::string QuoteExecWord(std::string_view word);

}  // namespace clearway::core::procman::internal
