// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

namespace clearway::io::internal {

/// Of a text; both count from 1, a column is a byte.
struct PmdPlace {
  std::size_t line = 1;
  std::size_t column = 1;
};

struct PmdToken {
  enum class Kind {
    kWord,        ///< A letter or '_', then letters, digits, '_' and '-'.
    kString,      ///< Its text has no quotes, and escapes are resolved.
    kOpenString,  ///< The same, but its line ends before the second quote comes.
    kInteger,     ///< Digits.
    kSymbol,      ///< One of = ; { }
    kEnd,         ///< Of the file. Nothing comes after it but itself.
    kUnknown,     ///< Bytes that belong to none of the others.
  };
  Kind kind = Kind::kEnd;
  std::string text;
  PmdPlace place;  ///< Of its first byte.
};

/// What is there, for a message: the token's kind and its text.
[[nodiscard]] std::string Described(const PmdToken& token);

/// Splits a deployment into tokens. Everything is a token: nothing is an error here.
class PmdLexer {
 public:
  explicit PmdLexer(std::string_view text) : text_(text) {}

  PmdToken Next();

 private:
  void SkipBlanksAndComments();
  PmdToken TakeString();
  template <typename Predicate>
  std::string TakeWhile(Predicate belongs);

  std::string_view text_;
  std::size_t at_ = 0;
  std::size_t line_ = 1;
  std::size_t line_start_ = 0;
};

}  // namespace clearway::io::internal
