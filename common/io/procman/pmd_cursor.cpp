// SPDX-License-Identifier: BSD-3-Clause
#include "common/io/procman/pmd_cursor.hpp"

#include <cstdint>
#include <utility>

#include "common/io/procman/pmd_reader.hpp"
#include "common/io/text.hpp"

namespace clearway::io::internal {

using Kind = PmdToken::Kind;

bool PmdCursor::IsWord(std::string_view word) const {
  return token_.kind == Kind::kWord && token_.text == word;
}

bool PmdCursor::IsSymbol(char symbol) const {
  return token_.kind == Kind::kSymbol && token_.text[0] == symbol;
}

bool PmdCursor::IsBlock(std::string_view word) const {
  return IsWord(word) && (next_.kind == Kind::kString || next_.kind == Kind::kOpenString);
}

PmdToken PmdCursor::Take() {
  return std::exchange(token_, std::exchange(next_, lexer_.Next()));
}

bool PmdCursor::TakeWord(std::string_view word) {
  if (!IsWord(word)) return false;
  Take();
  return true;
}

bool PmdCursor::ExpectSymbol(char symbol) {
  if (!IsSymbol(symbol)) {
    Fail(std::string("'") + symbol + "'");
    return false;
  }
  Take();
  return true;
}

std::optional<PmdToken> PmdCursor::ExpectString(const std::string& expected) {
  if (token_.kind == Kind::kOpenString) {
    Fail("'\"' in the same line");
    return Take();
  }
  if (token_.kind != Kind::kString) {
    Fail(expected + ", in double quotes");
    return std::nullopt;
  }
  if (token_.text.find('\0') != std::string::npos) {
    problems_.Add(token_.place, Described(token_) + ": expected a text without NUL");
  }
  return Take();
}

std::optional<PmdToken> PmdCursor::ExpectName(const std::string& expected) {
  std::optional<PmdToken> name = ExpectString(expected);
  if (!name || name->kind == Kind::kOpenString) return name;
  if (name->text.find_first_not_of(" \t\r\n\v\f") == std::string::npos) {
    problems_.Add(name->place, Described(*name) + ": expected " + expected + ", not blank");
  }
  if (name->text.size() > kMaxPmdNameBytes) {
    problems_.Add(name->place,
                  Described(*name) + ": expected " + expected + " of at most " +
                      std::to_string(kMaxPmdNameBytes) + " bytes");
    name->text.resize(kMaxPmdNameBytes);
  }
  return name;
}

std::optional<PmdToken> PmdCursor::ExpectNameWithoutSlash(const std::string& expected) {
  std::optional<PmdToken> name = ExpectName(expected);
  if (name && name->kind == Kind::kString && name->text.find('/') != std::string::npos) {
    problems_.Add(name->place, Described(*name) + ": expected " + expected + " without '/'");
  }
  return name;
}

std::optional<int> PmdCursor::ExpectInteger(const std::string& expected, int least, int most) {
  if (token_.kind != Kind::kInteger) {
    Fail(expected);
    return std::nullopt;
  }
  const PmdToken number = Take();
  const std::optional<std::uint64_t> value = ParseWhole(number.text);
  const auto lowest = static_cast<std::uint64_t>(least);
  const auto highest = static_cast<std::uint64_t>(most);
  if (!value || *value < lowest || *value > highest) {
    problems_.Add(number.place, Described(number) + ": expected " + expected);
    return least;
  }
  return static_cast<int>(*value);
}

bool PmdCursor::ExpectEndOfStatement() {
  if (IsSymbol(';')) {
    Take();
    return true;
  }
  Fail("';'");
  return token_.kind == Kind::kWord || IsSymbol('}');
}

void PmdCursor::Fail(const std::string& expected) {
  problems_.AddSyntax(token_.place, Described(token_) + ": expected " + expected);
}

void PmdCursor::FailUnclosed(const std::string& block, std::size_t line) {
  if (problems_.has_syntax_problem()) return;
  Fail("'}' of the " + block + " of line " + std::to_string(line));
}

void PmdCursor::SkipStatement() {
  std::size_t depth = 0;
  while (!IsAtEnd()) {
    if (depth == 0 && IsSymbol('}')) return;
    const PmdToken token = Take();
    if (token.kind != Kind::kSymbol) continue;
    if (token.text[0] == '{') ++depth;
    if (token.text[0] == '}') --depth;
    if (depth == 0 && (token.text[0] == '}' || token.text[0] == ';')) return;
  }
}

}  // namespace clearway::io::internal
