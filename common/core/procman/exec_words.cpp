// SPDX-License-Identifier: BSD-3-Clause
#include "common/core/procman/exec_words.hpp"

#include <cstddef>
#include <utility>

namespace clearway::core::procman::internal {
namespace {

// What isspace() takes in the C locale.
constexpr std::string_view kWhiteSpace = " \t\n\v\f\r";
constexpr char kNoQuote = '\0';
// Besides white space: what does not mean itself unless a backslash stands before it.
constexpr std::string_view kSpecial = "'\"\\$";

std::string AtByte(std::size_t index) {
  return "byte " + std::to_string(index + 1);
}

class WordSplitter {
 public:
  explicit WordSplitter(std::string_view text) : text_(text) {}

  SplitExecWords Split() {
    for (std::size_t at = 0; at < text_.size(); ++at) {
      if (text_[at] == '\0') return Refused(AtByte(at) + " is NUL");
      if (text_[at] != '\\') {
        TakeCharacter(at);
        continue;
      }
      ++at;
      if (at == text_.size()) return Refused("it ends in a backslash");
      if (text_[at] == '\0') return Refused(AtByte(at) + " is NUL");
      Append(text_[at], true);
    }
    if (quote_ != kNoQuote) {
      return Refused(std::string("the quote ") + quote_ + " at " + AtByte(quote_at_) +
                     " is not closed");
    }
    return std::move(result_);
  }

 private:
  static SplitExecWords Refused(std::string problem) {
    return {.words = {}, .problem = std::move(problem)};
  }

  void TakeCharacter(std::size_t at) {
    const char character = text_[at];
    if (quote_ == kNoQuote && (character == '\'' || character == '"')) {
      quote_ = character;
      quote_at_ = at;
      BeginWord();
    } else if (quote_ != kNoQuote && character == quote_) {
      quote_ = kNoQuote;
    } else if (quote_ == kNoQuote && kWhiteSpace.find(character) != std::string_view::npos) {
      is_in_word_ = false;
    } else {
      Append(character, false);
    }
  }

  void BeginWord() {
    if (!is_in_word_) result_.words.emplace_back();
    is_in_word_ = true;
  }

  void Append(char character, bool is_literal) {
    BeginWord();
    result_.words.back().text += character;
    result_.words.back().is_literal.push_back(is_literal);
  }

  std::string_view text_;
  char quote_ = kNoQuote;
  std::size_t quote_at_ = 0;
  bool is_in_word_ = false;
  SplitExecWords result_;
};

}  // namespace

SplitExecWords SplitIntoExecWords(std::string_view text) {
  return WordSplitter(text).Split();
}

std::string QuoteExecWord(std::string_view word) {
  if (word.empty()) return "''";
  std::string quoted;
  for (const char character : word) {
    const bool is_plain = kWhiteSpace.find(character) == std::string_view::npos &&
                          kSpecial.find(character) == std::string_view::npos;
    if (!is_plain) quoted += '\\';
    quoted += character;
  }
  return quoted;
}

}  // namespace clearway::core::procman::internal
