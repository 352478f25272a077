// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "common/core/procman/deployment.hpp"

namespace clearway::core::procman {

/// What came of the wish to start a command.
struct StartOutcome {
  std::int32_t pid = 0;  ///< 0: it was not started.
  std::string problem;   ///< Why not; empty when it was.
  /// Not started because the host's owner does not allow it: it is not tried again. Else it counts
  /// as a command that ended at once.
  bool is_refused = false;
  /// Where a status of its own is expected: its channel. Empty: it counts as ready at once.
  std::string status_channel;
  /// So long unhealthy, and it is started anew [us]; nothing: it is only reported.
  std::optional<std::int64_t> restart_unhealthy_us;
};

/// The machine, as far as commands need it. The real one starts processes; tests inject faults.
class CommandHost {
 public:
  virtual ~CommandHost() = default;

  /// Starts the command as a process of its own, if the host's owner allows it. Does not throw:
  /// what goes wrong is in the outcome.
  virtual StartOutcome Start(const CommandSpec& spec) = 0;

  /// Sends a signal to the command's process and to everything that came from it.
  virtual void Signal(std::int32_t pid, int signal) = 0;

  /// A remark about a command, for its log and for who follows its output. One line, no line end.
  virtual void Note(const std::string& command_id, const std::string& text) = 0;
};

}  // namespace clearway::core::procman
