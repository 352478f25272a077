// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "common/core/procman/exec_string.hpp"

namespace clearway::core::procman {

/// One rule of what a host's owner lets sheriffs run. XML element: <allow>.
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
  explicit AllowList(std::vector<AllowRule> rules);

  /// Empty: allowed. Else why not, in one sentence that names the command's program or the argument
  /// that no rule lets pass. O(rules x length).
  [[nodiscard]] std::string WhyRefused(const ExecLine& line) const;

 private:
  struct Rule;
  std::vector<AllowRule> rules_;
};

}  // namespace clearway::core::procman
