// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <stdexcept>
#include <string>
#include <string_view>

namespace clearway::relay {

/// A line that cannot be followed; what() says why.
class CommandError : public std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// A line of the relay's standard input.
struct Command {
  enum class Verb { kLoss, kDuplicate, kDelay, kJitter, kCut, kMend, kStatistics, kQuit };

  Verb verb = Verb::kStatistics;
  double value = 0.0;      ///< Probability in [0, 1], or milliseconds in [0, 60000].
  std::string from = "*";  ///< Name of a port, "*" for all; of kCut and kMend the port itself.
  std::string to = "*";
};

/// `loss P`, `duplicate P`, `delay-ms T`, `jitter-ms T`, each with `FROM:TO` behind it where not
/// all directions are meant; `cut PORT`, `mend PORT`, `stats`, `quit`. Throws CommandError.
[[nodiscard]] Command ParseCommand(std::string_view line);

}  // namespace clearway::relay
