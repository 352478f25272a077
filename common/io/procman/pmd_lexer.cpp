// SPDX-License-Identifier: BSD-3-Clause
#include "common/io/procman/pmd_lexer.hpp"

#include <algorithm>
#include <utility>

#include "common/io/read_error.hpp"

namespace clearway::io::internal {
namespace {

using Kind = PmdToken::Kind;

constexpr std::string_view kBlanks = " \t\r\n\v\f";
constexpr std::string_view kSymbols = "=;{}";

bool IsIn(std::string_view set, char character) {
  return set.find(character) != std::string_view::npos;
}

bool IsDigit(char character) {
  return character >= '0' && character <= '9';
}

bool BeginsWord(char character) {
  return (character >= 'a' && character <= 'z') || (character >= 'A' && character <= 'Z') ||
         character == '_';
}

bool BelongsToWord(char character) {
  return BeginsWord(character) || IsDigit(character) || character == '-';
}

bool IsUnknown(char character) {
  return !BeginsWord(character) && !IsDigit(character) && !IsIn(kBlanks, character) &&
         !IsIn(kSymbols, character) && character != '"' && character != '#';
}

char Unescaped(char character) {
  switch (character) {
    case 'n':
      return '\n';
    case 'r':
      return '\r';
    case 't':
      return '\t';
    default:
      return character;
  }
}

// The string between two quotes.
std::string Unescaped(std::string_view raw) {
  std::string text;
  for (std::size_t i = 0; i < raw.size(); ++i) {
    const bool is_escape = raw[i] == '\\' && i + 1 < raw.size();
    text += is_escape ? Unescaped(raw[++i]) : raw[i];
  }
  return text;
}

}  // namespace

std::string Described(const PmdToken& token) {
  switch (token.kind) {
    case Kind::kString:
      return "string " + Quoted(token.text);
    case Kind::kOpenString:
      return "string " + Quoted(token.text) + " without its second quote";
    case Kind::kEnd:
      return "end of the file";
    case Kind::kSymbol:
      return "'" + token.text + "'";
    case Kind::kWord:
    case Kind::kInteger:
    case Kind::kUnknown:
      break;
  }
  return Quoted(token.text);
}

PmdToken PmdLexer::Next() {
  SkipBlanksAndComments();
  const PmdPlace place{line_, at_ - line_start_ + 1};
  if (at_ == text_.size()) return {Kind::kEnd, "", place};
  const char first = text_[at_];
  if (first == '"') return TakeString();
  if (BeginsWord(first)) return {Kind::kWord, TakeWhile(BelongsToWord), place};
  if (IsDigit(first)) return {Kind::kInteger, TakeWhile(IsDigit), place};
  if (IsIn(kSymbols, first)) return {Kind::kSymbol, std::string(1, text_[at_++]), place};
  return {Kind::kUnknown, TakeWhile(IsUnknown), place};
}

void PmdLexer::SkipBlanksAndComments() {
  while (at_ < text_.size()) {
    if (text_[at_] == '#') {
      at_ = std::min(text_.find('\n', at_), text_.size());
    } else if (!IsIn(kBlanks, text_[at_])) {
      return;
    } else if (text_[at_++] == '\n') {
      ++line_;
      line_start_ = at_;
    }
  }
}

PmdToken PmdLexer::TakeString() {
  const PmdPlace place{line_, at_ - line_start_ + 1};
  const std::size_t begin = ++at_;
  const std::size_t line_end = std::min(text_.find('\n', begin), text_.size());
  while (at_ < line_end && text_[at_] != '"') at_ += text_[at_] == '\\' ? 2 : 1;
  if (at_ < line_end) {
    const std::string_view raw = text_.substr(begin, at_ - begin);
    ++at_;
    return {Kind::kString, Unescaped(raw), place};
  }
  // Where the second quote was forgotten, the line's last symbols are hardly part of the string.
  const std::string_view line = text_.substr(begin, line_end - begin);
  const std::size_t last = line.find_last_not_of(" \t\r;{}");
  const std::string_view raw = line.substr(0, last == std::string_view::npos ? 0 : last + 1);
  at_ = begin + raw.size();
  return {Kind::kOpenString, Unescaped(raw), place};
}

template <typename Predicate>
std::string PmdLexer::TakeWhile(Predicate belongs) {
  const std::size_t begin = at_;
  while (at_ < text_.size() && belongs(text_[at_])) ++at_;
  return std::string(text_.substr(begin, at_ - begin));
}

}  // namespace clearway::io::internal
