// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace clearway::core::procman {

/// A command line, taken apart. No shell is involved: no globs, pipes, `;` or `~`.
struct ExecLine {
  /// Settings for the child's environment, in order: leading words with '=' in them.
  std::vector<std::pair<std::string, std::string>> environment;
  /// Program and arguments, variables expanded.
  std::vector<std::string> arguments;
  friend bool operator==(const ExecLine&, const ExecLine&) = default;
};

/// Either a line or what is wrong with the text.
struct ParsedExecLine {
  std::optional<ExecLine> line;
  std::string problem;  ///< One sentence; empty when there is a line.
};

/// Longer texts are refused [bytes].
inline constexpr std::size_t kMaxExecBytes = 16384;

/// Likewise once variables have their values [bytes]: a short text may name a long value often.
inline constexpr std::size_t kMaxExpandedExecBytes = 131072;

/// The value of a variable of the deputy's environment; nothing when it is not set.
using LookupVariable = std::function<std::optional<std::string>(const std::string& name)>;

/// Grammar of the reference procman: white space separates words; '..' and ".." join them, also in
/// the middle of a word; a backslash takes the next character literally, also inside both quotes.
/// Leading words with '=' set the child's environment and are not expanded. In all others $NAME and
/// ${NAME} become the variable's value, also within quotes; a name that is not set, and a dollar
/// that was taken literally (`\$`), stay as they are written. A value is never split into words.
/// Quotes only join: `$NA"ME"` is $NAME. A character after a backslash is no part of a name.
/// Refused: an open quote, a backslash at the end, a NUL, no program, a setting without a name, too
/// long a text.
/// O(n) time, n with the values.
[[nodiscard]] ParsedExecLine ParseExecLine(std::string_view text, const LookupVariable& lookup);

/// The text that is parsed into this line, whatever variables are set: paths with blanks, quotes,
/// dollars and backslashes survive. Throws std::invalid_argument for what the grammar cannot say: a
/// NUL, no program, a program with '=' in it, a setting without a name or with '=' in it.
[[nodiscard]] std::string FormatExecLine(const ExecLine& line);

}  // namespace clearway::core::procman
