// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <limits>
#include <set>
#include <string>
#include <vector>

#include "common/config/schema.hpp"

namespace clearway::config::internal {

/// Sorts behind all lines of the file.
inline constexpr int kNoLine = std::numeric_limits<int>::max();

struct Problem {
  int line = kNoLine;
  std::string element;  ///< Path of the element it is in.
  std::string value;    ///< Path of the value that a --set can mend; empty: none.
  std::string text;     ///< One line.
};

/// What is wrong with a configuration.
class Problems {
 public:
  void Add(Problem problem) { problems_.push_back(std::move(problem)); }

  /// Forgets what the file had wrong at this value.
  void Mend(const std::string& value);

  [[nodiscard]] bool Concern(const std::string& value) const;

  /// Paths of the elements that have a problem in them or below.
  [[nodiscard]] std::set<std::string> BrokenElements() const;

  /// Texts in the order of the file; what has no line stands last, in order of discovery.
  [[nodiscard]] std::vector<std::string> Texts() const;

 private:
  std::vector<Problem> problems_;
};

/// Values that must be given and are not, then the rules of each element whose values are sound
/// (a rule about a value that was refused cannot be judged).
void CheckRules(const Element& root, const std::string& file, Problems& problems);

}  // namespace clearway::config::internal
