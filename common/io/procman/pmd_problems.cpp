// SPDX-License-Identifier: BSD-3-Clause
#include "common/io/procman/pmd_problems.hpp"

#include <algorithm>
#include <tuple>

#include "common/io/procman/pmd_reader.hpp"

namespace clearway::io::internal {

void PmdProblems::Add(PmdPlace place, const std::string& text) {
  if (problems_.size() < kMaxPmdProblems) problems_.push_back({place, text});
}

void PmdProblems::AddSyntax(PmdPlace place, const std::string& text) {
  if (place.line == last_syntax_line_) return;
  last_syntax_line_ = place.line;
  Add(place, text);
}

void PmdProblems::ThrowIfAny() const {
  if (problems_.empty()) return;
  std::vector<Problem> sorted = problems_;
  std::stable_sort(sorted.begin(), sorted.end(), [](const Problem& a, const Problem& b) {
    return std::tie(a.place.line, a.place.column) < std::tie(b.place.line, b.place.column);
  });
  std::string all;
  for (const auto& [place, text] : sorted) {
    if (!all.empty()) all += '\n';
    all += ErrorInColumn(file_, place.line, place.column, text).what();
  }
  throw ReadError(all);
}

}  // namespace clearway::io::internal
