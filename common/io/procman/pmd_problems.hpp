// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "common/io/procman/pmd_lexer.hpp"

namespace clearway::io::internal {

/// The problems of one deployment file.
class PmdProblems {
 public:
  /// @pre the name outlives the object.
  explicit PmdProblems(const std::string& file) : file_(file) {}

  /// A problem of meaning: the text could be read.
  void Add(PmdPlace place, const std::string& text);

  /// The text could not be read. Only the first of a line is kept: what comes behind it follows
  /// from it more often than not.
  void AddSyntax(PmdPlace place, const std::string& text);

  [[nodiscard]] bool has_syntax_problem() const { return last_syntax_line_ > 0; }

  /// Throws ReadError with all of them in the file's order.
  void ThrowIfAny() const;

 private:
  struct Problem {
    PmdPlace place;
    std::string text;
  };

  const std::string& file_;
  std::vector<Problem> problems_;
  std::size_t last_syntax_line_ = 0;
};

}  // namespace clearway::io::internal
