// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <csignal>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <sys/types.h>
#include <vector>

namespace clearway::host {

/// What a child is started with.
struct ChildSettings {
  /// A relative path counts from this process's working folder, whatever the child's is.
  std::filesystem::path program;
  std::vector<std::string> arguments;    ///< Its argv, the name of the program first.
  std::vector<std::string> environment;  ///< The whole of it, "NAME=VALUE" each.
  std::filesystem::path working_folder;  ///< Empty: that of this process.
  /// What it gets when the thread that started it ends; 0: nothing. A child that changes its user
  /// gets nothing.
  int parent_death_signal = SIGKILL;
};

/// A child on a terminal of its own, so that it writes line by line.
struct TerminalChild {
  pid_t pid = -1;
  /// The terminal's other end; non-blocking. The owner closes it, which hangs up (SIGHUP) what
  /// still runs on it.
  int output_fd = -1;
  std::uint64_t start_ticks = 0;  ///< With the pid: who it is, also after its pid is used again.
};

/// Starts a program as leader of a session and process group of its own, on a pseudo terminal that
/// hands its bytes on as they are: no CR before LF, no echo. The child has that terminal as stdin,
/// stdout and stderr and no other descriptor, all signals at their defaults and none blocked.
///
/// Where it cannot be run, the terminal says so in one line, "cannot run PROGRAM: REASON", and the
/// child exits with 255, as procman's do. Throws std::runtime_error when there is no child at all:
/// no pid, terminal or descriptor is left; std::invalid_argument on a NUL or no arguments.
/// Thread safety: may be called beside other threads of the process.
[[nodiscard]] TerminalChild StartOnTerminal(const ChildSettings& settings);

/// What a read from TerminalChild::output_fd gave.
struct OutputPart {
  std::size_t size = 0;  ///< Bytes in the buffer; 0: none for now.
  bool is_over = false;  ///< Nobody holds the terminal any more, nothing will come.
};

/// Reads what has come, without waiting. Other processes may hold the terminal longer than the
/// child does.
[[nodiscard]] OutputPart ReadOutput(int output_fd, std::span<char> buffer);

}  // namespace clearway::host
