// SPDX-License-Identifier: BSD-3-Clause
#include "common/core/procman/exec_string.hpp"

#include <cstddef>
#include <stdexcept>

#include "common/core/procman/exec_words.hpp"

namespace clearway::core::procman {
namespace {

using internal::ExecWord;

bool IsLetter(char character) {
  return (character >= 'a' && character <= 'z') || (character >= 'A' && character <= 'Z') ||
         character == '_';
}

bool IsDigit(char character) {
  return character >= '0' && character <= '9';
}

// A variable in a word.
struct Mention {
  std::string name;
  std::size_t end = 0;  // Behind it and its brace.
};

class Expander {
 public:
  Expander(const ExecWord& word, const LookupVariable& lookup) : word_(word), lookup_(lookup) {}

  // Stops once the result is longer than `limit`.
  [[nodiscard]] std::string Expand(std::size_t limit) const {
    std::string expanded;
    std::size_t at = 0;
    while (at < word_.text.size() && expanded.size() <= limit) {
      const std::optional<Mention> mention = MentionAt(at);
      const std::optional<std::string> value = mention ? lookup_(mention->name) : std::nullopt;
      if (value) {
        expanded += *value;
        at = mention->end;
      } else {
        expanded += word_.text[at++];
      }
    }
    return expanded;
  }

 private:
  // A character that a backslash made literal is no part of a variable.
  [[nodiscard]] bool Is(std::size_t at, char character) const {
    return at < word_.text.size() && !word_.is_literal[at] && word_.text[at] == character;
  }

  [[nodiscard]] std::size_t EndOfName(std::size_t begin) const {
    std::size_t end = begin;
    while (end < word_.text.size() && !word_.is_literal[end] &&
           (IsLetter(word_.text[end]) || (end > begin && IsDigit(word_.text[end])))) {
      ++end;
    }
    return end;
  }

  [[nodiscard]] std::optional<Mention> MentionAt(std::size_t at) const {
    if (!Is(at, '$')) return std::nullopt;
    const bool has_braces = Is(at + 1, '{');
    const std::size_t begin = at + (has_braces ? 2 : 1);
    const std::size_t end = EndOfName(begin);
    if (end == begin || (has_braces && !Is(end, '}'))) return std::nullopt;
    return Mention{word_.text.substr(begin, end - begin), end + (has_braces ? 1 : 0)};
  }

  const ExecWord& word_;
  const LookupVariable& lookup_;
};

ParsedExecLine Refused(std::string problem) {
  return {.line = std::nullopt, .problem = std::move(problem)};
}

ParsedExecLine Assemble(const std::vector<ExecWord>& words, const LookupVariable& lookup) {
  ExecLine line;
  std::size_t bytes = 0;
  for (const ExecWord& word : words) {
    const std::size_t equals = word.text.find('=');
    if (line.arguments.empty() && equals != std::string::npos) {
      if (equals == 0) return Refused("a setting has no variable's name before its =");
      line.environment.emplace_back(word.text.substr(0, equals), word.text.substr(equals + 1));
      continue;
    }
    line.arguments.push_back(Expander(word, lookup).Expand(kMaxExpandedExecBytes - bytes));
    bytes += line.arguments.back().size();
    if (bytes > kMaxExpandedExecBytes) {
      return Refused("with its variables' values it has more than " +
                     std::to_string(kMaxExpandedExecBytes) + " bytes");
    }
  }
  if (line.arguments.empty() || line.arguments.front().empty()) {
    return Refused("it names no program");
  }
  return {.line = std::move(line), .problem = {}};
}

void Append(const std::string& word, std::string& text) {
  if (word.find('\0') != std::string::npos) throw std::invalid_argument("a NUL in a command line");
  if (!text.empty()) text += ' ';
  text += internal::QuoteExecWord(word);
}

}  // namespace

ParsedExecLine ParseExecLine(std::string_view text, const LookupVariable& lookup) {
  if (text.size() > kMaxExecBytes) {
    return Refused("it has " + std::to_string(text.size()) + " bytes: at most " +
                   std::to_string(kMaxExecBytes) + " are allowed");
  }
  internal::SplitExecWords split = internal::SplitIntoExecWords(text);
  if (!split.problem.empty()) return Refused(std::move(split.problem));
  return Assemble(split.words, lookup);
}

std::string FormatExecLine(const ExecLine& line) {
  const bool has_program = !line.arguments.empty() && !line.arguments.front().empty() &&
                           line.arguments.front().find('=') == std::string::npos;
  if (!has_program) {
    throw std::invalid_argument("a command line needs a program, and without '=' in it");
  }
  std::string text;
  for (const auto& [name, value] : line.environment) {
    if (name.empty() || name.find('=') != std::string::npos) {
      throw std::invalid_argument("a setting needs a name, and without '=' in it");
    }
    Append(name + '=' + value, text);
  }
  for (const std::string& argument : line.arguments) Append(argument, text);
  return text;
}

}  // namespace clearway::core::procman
