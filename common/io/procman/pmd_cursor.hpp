// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>

#include "common/io/procman/pmd_lexer.hpp"
#include "common/io/procman/pmd_problems.hpp"

namespace clearway::io::internal {

/// Walks over the tokens of a deployment, one at a time, and notes what it does not find.
class PmdCursor {
 public:
  PmdCursor(std::string_view text, PmdProblems& problems)
      : lexer_(text), problems_(problems), token_(lexer_.Next()), next_(lexer_.Next()) {}

  [[nodiscard]] const PmdToken& token() const { return token_; }
  [[nodiscard]] PmdProblems& problems() { return problems_; }
  [[nodiscard]] bool IsWord(std::string_view word) const;
  [[nodiscard]] bool IsSymbol(char symbol) const;
  /// A word with a string behind it, as a block begins.
  [[nodiscard]] bool IsBlock(std::string_view word) const;
  [[nodiscard]] bool IsAtEnd() const { return token_.kind == PmdToken::Kind::kEnd; }

  /// The current token; the next one is current then.
  PmdToken Take();
  /// Takes the word if it is there.
  bool TakeWord(std::string_view word);

  // Each takes what it is named after, or notes that it was expected and takes nothing.
  bool ExpectSymbol(char symbol);
  std::optional<PmdToken> ExpectString(const std::string& expected);
  /// A name: not blank, not too long, and, where it becomes a level of a path, without '/'.
  /// What is wrong with it is noted, but it is taken, since the text can be read.
  std::optional<PmdToken> ExpectName(const std::string& expected);
  std::optional<PmdToken> ExpectNameWithoutSlash(const std::string& expected);
  /// @param expected with the bounds; a number beyond them is noted too, but taken and clamped,
  /// since the text can be read.
  std::optional<int> ExpectInteger(const std::string& expected, int least, int most);
  /// The ';' after a statement. Where only that is missing, reading goes on as if it was there.
  bool ExpectEndOfStatement();

  /// Notes that something else was expected than the current token.
  void Fail(const std::string& expected);
  /// Notes that the file ends within a block that began in this line, unless a problem before it
  /// may be the reason.
  void FailUnclosed(const std::string& block, std::size_t line);
  /// Goes behind the end of a statement: its ';', or the '}' of its block. Stays in front of a '}'
  /// that belongs to what is around the statement.
  void SkipStatement();

 private:
  PmdLexer lexer_;
  PmdProblems& problems_;
  PmdToken token_;
  PmdToken next_;
};

}  // namespace clearway::io::internal
