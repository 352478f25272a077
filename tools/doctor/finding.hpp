// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <utility>
#include <vector>

namespace clearway::doctor {

enum class State {
  kOk,
  kWarning,     ///< Works, and may surprise.
  kProblem,     ///< Does not work, or loses messages.
  kNotChecked,  ///< The text says why.
};

/// What one check says. Commands that need it begin with "sudo ".
struct Finding {
  std::string check;  ///< e.g. "multicast_route"; stable names, see README.md.
  State state = State::kOk;
  std::string text;  ///< One sentence, one line.
  std::vector<std::string>
      mend;  ///< Commands, or lines for a file after a comment that says which.
  friend bool operator==(const Finding&, const Finding&) = default;
};

using Findings = std::vector<Finding>;

inline void Append(Findings& findings, Findings more) {
  for (Finding& finding : more) findings.push_back(std::move(finding));
}

/// A word of a shell's command line.
[[nodiscard]] std::string ShellWord(const std::string& text);

/// The same commands for who is root already: a robot's system need not have sudo.
[[nodiscard]] Finding ForRoot(Finding finding);

/// "a, b, c"; of many the first eight "and N more".
[[nodiscard]] std::string Join(const std::vector<std::string>& words);

}  // namespace clearway::doctor
