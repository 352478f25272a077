// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "common/core/procman/exec_string.hpp"

namespace clearway::core::procman {

/// One rule of what a host's owner lets sheriffs run. XML element: <allow>.
/// Patterns are matched with the words of a command as the program would get them: quotes taken
/// off, variables expanded. In a pattern only * and ? are special, also within quotes and also
/// where they meet a '/' or a '='; after a backslash they mean themselves. A pattern of a variable
/// is matched name by name and value by value, so that `*_LEVEL=debug` says nothing about
/// `LD_PRELOAD=x_LEVEL=debug`; without '=' any value is meant. No variable is special: LD_PRELOAD
/// and PATH may be set where a pattern matches them, as a bare * does.
struct AllowRule {
  std::string program;
  std::string arguments;
  std::string environment;

  template <typename Self, typename Visitor>
  static void Visit(Self& self, Visitor& visitor) {
    visitor.Text("program",
                 self.program,
                 "The program, exactly as the command names it: a path, or a name that is found "
                 "beside the deputy or in its PATH.");
    visitor.Text("arguments",
                 self.arguments,
                 "Pattern of the arguments, word by word: * stands for any characters within one "
                 "argument, ? for one, a last word ... for any further arguments. Quotes as in a "
                 "command. Empty: no argument.");
    visitor.Text("environment",
                 self.environment,
                 "Patterns of the variables that the command may set, e.g. LCM_DEFAULT_URL=* "
                 "CLEARWAY_*=*. Empty: none but those that the deputy itself reads "
                 "(CLEARWAY_STATUS_CHANNEL, CLEARWAY_RESTART_UNHEALTHY).");
  }

  /// Problems of the patterns, one sentence each.
  [[nodiscard]] std::vector<std::string> Validate() const;
};

/// Which commands a host runs.
class AllowList {
 public:
  /// @pre the rules have been validated.
  explicit AllowList(const std::vector<AllowRule>& rules);

  /// Empty: allowed, since one rule lets the program, all arguments and all variables pass. Else
  /// why not, in one sentence that names the program, the argument or the variable; of several
  /// rules for the program it is the one that came furthest. O(rules x length).
  [[nodiscard]] std::string WhyRefused(const ExecLine& line) const;

 private:
  struct VariablePattern {
    std::string name;
    std::string value;
  };

  // A rule, taken apart. Patterns are fnmatch(3)'s.
  struct Rule {
    std::string program;
    std::vector<std::string> arguments;
    bool takes_more_arguments = false;
    std::vector<VariablePattern> variables;
  };

  // What a rule says of a line that begins with its program.
  struct Refusal {
    std::size_t num_passed = 0;  // Arguments and variables before the refused one.
    std::string reason;          // Empty: not refused.
  };

  static Rule TakeApart(const AllowRule& rule);
  static bool IsVariableAllowed(const Rule& rule,
                                const std::string& name,
                                const std::string& value);
  static Refusal RefusalBy(const Rule& rule, const ExecLine& line);

  std::vector<Rule> rules_;
};

}  // namespace clearway::core::procman
